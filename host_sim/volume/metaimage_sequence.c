/* SPDX-License-Identifier: MIT */
#include "volume/metaimage_parts.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

static const char pictures[] =
    "this is a sequence of pictures, whose third axis is time. Reconstruct a volume from it first, with PLUS "
    "(VolumeReconstructor) or 3D Slicer (Volume Reconstruction)";

/* The next word of a value; its length is 0 at the end. */
static const char *next_word(const char **value, size_t *length) {
    while (isspace((unsigned char)**value)) ++*value;
    const char *start = *value;
    while (**value && !isspace((unsigned char)**value)) ++*value;
    *length = (size_t)(*value - start);
    return start;
}

static bool is_one_of(const char *word, size_t length, const char *a, const char *b) {
    return (length == strlen(a) && memcmp(word, a, length) == 0) ||
           (length == strlen(b) && memcmp(word, b, length) == 0);
}

static bool is_of_one_frame(const hs_met_text *text) {
    static const char first[] = "Seq_Frame0000_";
    for (size_t i = 0; i < text->frame_count; i++)
        if (strncmp(text->frames[i].name, first, sizeof first - 1) != 0) return false;
    return true;
}

bool hs_met_is_cut(const hs_met_text *text, uint64_t dims) {
    const char *value = hs_met_has(text, HS_MET_F_KINDS) ? text->fields[HS_MET_F_KINDS].value : "";
    uint64_t spatial = 0;
    size_t length;
    const char *word = next_word(&value, &length);
    for (; is_one_of(word, length, "domain", "space"); word = next_word(&value, &length)) spatial++;
    const bool timed = is_one_of(word, length, "list", "time");
    (void)next_word(&value, &length);
    return dims == 3 && spatial == 3 && timed && length == 0;
}

bool hs_met_kinds(const hs_met_text *text, uint64_t dims, bool placed) {
    /* Older programs write no Kinds, but only sequences have fields of their frames. A volume that PLUS
     * reconstructed has Kinds, and fields of one frame: itself. */
    if (hs_met_is_cut(text, dims)) return true;
    const bool has_kinds = hs_met_has(text, HS_MET_F_KINDS);
    const char *value = has_kinds ? text->fields[HS_MET_F_KINDS].value : "";
    const bool framed = dims == 3 && text->frame_count > 0;
    if (framed && (!has_kinds || !is_of_one_frame(text)))
        return hs_met_wrong(text, &text->frames[0], pictures);
    if (!has_kinds) return true;
    uint64_t spatial = 0;
    size_t length;
    const char *word = next_word(&value, &length);
    for (; is_one_of(word, length, "domain", "space"); word = next_word(&value, &length)) spatial++;
    const bool timed = is_one_of(word, length, "list", "time");
    if (timed) (void)next_word(&value, &length);
    if (length == 0 && !timed && dims == 3 && spatial == 3) return true;
    if (length == 0 && timed && dims == 4 && spatial == 3) return true;
    if (length == 0 && timed && dims == 3 && spatial == 2 && framed)
        return hs_met_wrong(text, &text->frames[0], pictures);
    if (length == 0 && timed && dims == 3 && spatial == 2)
        return placed || hs_met_wrong(text, &text->fields[HS_MET_F_KINDS], pictures);
    return hs_met_bad_value(text, HS_MET_F_KINDS,
                            dims == 3 ? "domain domain domain" : "domain domain domain list");
}

/* ------------------------------------------------------------------------------------------ one field -- */

/* Splits "Seq_Frame0012_What" into 12 and "What". */
static bool split_name(const char *name, uint64_t *index, const char **what) {
    const char *digits = name + strlen("Seq_Frame");
    char *end;
    if (!isdigit((unsigned char)*digits) || strlen(digits) > 80) return false;
    *index = strtoull(digits, &end, 10);
    *what = end + 1;
    return *end == '_' && end[1] != '\0';
}

/* The transform of that name, a new one if there is none; NULL if there is no room. */
static hs_frame_transform *find_transform(hs_frame_fields *f, const char *name, size_t length) {
    for (uint32_t i = 0; i < f->transform_count; i++)
        if (strncmp(f->transforms[i].name, name, length) == 0 && f->transforms[i].name[length] == '\0')
            return &f->transforms[i];
    if (f->transform_count == HS_FRAME_TRANSFORMS) return NULL;
    hs_frame_transform *t = &f->transforms[f->transform_count++];
    *t = (hs_frame_transform){.matrix = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
    memcpy(t->name, name, length);
    return t;
}

static bool read_matrix(const hs_met_text *text, const hs_met_value *v, double matrix[16]) {
    const char *value = v->value;
    bool ok = true;
    for (int i = 0; ok && i < 16; i++) ok = hs_met_number(&value, &matrix[i]);
    if (!ok || !hs_met_at_end(value)) return hs_met_bad(text, v, "16 numbers");
    return (matrix[12] == 0 && matrix[13] == 0 && matrix[14] == 0 && matrix[15] == 1) ||
           hs_met_bad(text, v, "a matrix whose last row is 0 0 0 1");
}

static bool read_status(const hs_met_text *text, const hs_met_value *v, char *status, size_t bytes) {
    const size_t length = strlen(v->value);
    if (length == 0 || length >= bytes || strspn(v->value, "ABCDEFGHIJKLMNOPQRSTUVWXYZ_") != length)
        return hs_met_bad(text, v, "OK, INVALID or another word in capitals");
    memcpy(status, v->value, length + 1);
    return true;
}

static bool ends_with(const char *text, const char *ending, size_t *before) {
    const size_t n = strlen(text), m = strlen(ending);
    *before = n - m;
    return n > m && strcmp(text + n - m, ending) == 0;
}

static bool read_transform(const hs_met_text *text, const hs_met_value *v, const char *what, size_t length,
                           bool is_status, hs_frame_fields *f) {
    if (length >= sizeof f->transforms[0].name ||
        strspn(what, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
                     "0123456789_") < length)
        return hs_met_wrong(text, v,
                            "expected a name of letters, digits and _, at most 47 before 'Transform'");
    hs_frame_transform *t = find_transform(f, what, length);
    if (!t) return hs_met_wrong(text, v, "more than 8 transforms of one volume");
    return is_status ? read_status(text, v, t->status, sizeof t->status) : read_matrix(text, v, t->matrix);
}

/* One field of volume `f`; whatever is not used is skipped. */
static bool read_field(const hs_met_text *text, const hs_met_value *v, const char *what, hs_frame_fields *f) {
    size_t length;
    if (ends_with(what, "TransformStatus", &length)) return read_transform(text, v, what, length, true, f);
    if (ends_with(what, "Transform", &length)) return read_transform(text, v, what, length, false, f);
    if (strcmp(what, "Timestamp") == 0) {
        const char *value = v->value;
        f->has_time = hs_met_number(&value, &f->time) && hs_met_at_end(value);
        return f->has_time || hs_met_bad(text, v, "a number of seconds");
    }
    if (strcmp(what, "ImageStatus") == 0) {
        f->invalid = strcmp(v->value, "INVALID") == 0;
        return f->invalid || strcmp(v->value, "OK") == 0 || hs_met_bad(text, v, "OK or INVALID");
    }
    return true;
}

static int by_name(const void *a, const void *b) {
    const hs_met_value *const *left = a, *const *right = b;
    const int order = strcmp((*left)->name, (*right)->name);
    return order ? order : ((*left)->line > (*right)->line) - ((*left)->line < (*right)->line);
}

static bool no_field_twice(const hs_met_text *text) {
    const hs_met_value **sorted = hs_memory(text->frame_count, sizeof *sorted, text->path, text->err);
    if (!sorted) return false;
    for (size_t i = 0; i < text->frame_count; i++) sorted[i] = &text->frames[i];
    qsort(sorted, text->frame_count, sizeof *sorted, by_name);
    const hs_met_value *second = NULL, *first = NULL;
    for (size_t i = 1; i < text->frame_count && !second; i++)
        if (strcmp(sorted[i - 1]->name, sorted[i]->name) == 0) {
            first = sorted[i - 1];
            second = sorted[i];
        }
    char name[HS_MET_SHOWN_BYTES];
    if (second) hs_met_shown(second->name, name);
    free(sorted);
    return !second || hs_fail(text->err, HS_ERR_INPUT, "%s:%u: %s is given a second time, first in line %u",
                              text->path, second->line, name, first->line);
}

bool hs_met_frames(const hs_met_text *text, uint32_t count, hs_frame_fields **fields) {
    *fields = NULL;
    if (text->frame_count == 0) return true;
    if (!no_field_twice(text)) return false;
    *fields = calloc(count, sizeof **fields);
    if (!*fields) return hs_fail(text->err, HS_ERR_MEMORY, "%s: no memory for %u volumes", text->path, count);
    bool ok = true;
    for (size_t i = 0; ok && i < text->frame_count; i++) {
        const hs_met_value *v = &text->frames[i];
        const char *what;
        uint64_t index;
        if (!split_name(v->name, &index, &what))
            ok = hs_met_wrong(text, v, "expected a name Seq_Frame<number>_<what>");
        else if (index >= count)
            ok = hs_met_wrong(text, v, "is about a volume behind the last one that DimSize has");
        else
            ok = read_field(text, v, what, &(*fields)[index]);
    }
    if (ok) return true;
    free(*fields);
    *fields = NULL;
    return false;
}
