/* SPDX-License-Identifier: MIT */
/* A recording as a page of its frames; nothing is played. */
#include "core/output_file.h"
#include "core/paths.h"
#include "core/system.h"
#include "core/text.h"
#include "plugin/loader.h"
#include "replay/replay.h"
#include "show/picture_map.h"

#include <inttypes.h>
#include <stdio.h>

enum { MAX_PICTURES = 500 };

typedef struct {
    const char *folder;
    FILE *out;
    rec_item item;
    sv_format format;
    uint32_t frames, pictures, left_out;
} page;

static void put(FILE *out, const char *text) {
    char clean[4096];
    for (const char *c = hs_text_escape(clean, sizeof clean, text, 0); *c; c++)
        if (*c == '<' || *c == '&')
            (void)fprintf(out, "&#%d;", *c);
        else
            (void)fputc(*c, out);
}

static void put_in(FILE *out, const char *element, const char *text) {
    (void)fprintf(out, "<%s>", element);
    put(out, text);
    (void)fprintf(out, "</%s>\n", element);
}

/* The recorded depthmap. A host that tells no spacing gets depths in slices. */
static bool put_picture(page *p, hs_error *err) {
    const sv_format *f = &p->format;
    const size_t rays = (size_t)f->width * f->height;
    const bool mm = f->spacing_mm[2] > 0.0f;
    char name[32], path[SYS_PATH];
    hs_picture picture = {0};
    if (p->pictures == MAX_PICTURES) return ++p->left_out;
    (void)snprintf(name, sizeof name, "depthmap_%04u.png", p->pictures++);
    float *depth = (float *)(void *)p->item.data; /* the reader's, until its next item */
    for (size_t i = 0; mm && i < rays; i++) depth[i] *= f->spacing_mm[2];
    const hs_caption caption = {.footer = mm ? NULL : "The host told no spacing: depths are in slices."};
    const bool ok = hs_path_join(p->folder, name, path, sizeof path, err) &&
                    hs_picture_depthmap(&picture, depth, f->width, f->height, &caption, err) &&
                    hs_picture_save(&picture, path, err);
    hs_picture_free(&picture);
    (void)fprintf(p->out, "<a href=%s><img src=%s alt=\"the depthmap\"></a>\n", name, name);
    return ok;
}

static void put_call(page *p) {
    const rec_item *it = &p->item;
    const sv_format *f = &it->format;
    if (!it->sound) {
        (void)fprintf(p->out, "<p class=bad>%s broke a rule</p>\n", rc_names[it->kind]);
    } else if (it->kind == RC_ACTIVATE) {
        p->format = *f;
        (void)fprintf(p->out, "<h2>activate: %u x %u x %u voxels, slabs of %u</h2>\n", f->width, f->height,
                      f->slices, f->max_slab_slices);
    } else if (it->kind == RC_BEGIN) {
        (void)fprintf(p->out, "<h2>Frame %u <small>(the host's %" PRIu64 ")</small></h2>\n", p->frames++,
                      it->frame.index);
    }
}

static bool put_return(page *p, hs_error *err) {
    const rec_item *it = &p->item;
    const bool delivers = it->kind == RC_END || it->kind == RC_ADJUST, failed = it->returned < SV_OK;
    if (!delivers && !failed) return true;
    (void)fprintf(p->out, "<p%s>%s: %s", failed ? " class=bad" : "", rc_names[it->kind],
                  hs_status_name(it->stats ? it->found.outcome : it->returned));
    if (it->stats)
        (void)fprintf(p->out, ", %u rays, %u points, %u without a surface", it->found.rays, it->found.points,
                      it->found.unfilled);
    (void)fprintf(p->out, ", %.3f ms ", (double)it->ns * 1e-6);
    put(p->out, it->reason);
    (void)fputs("</p>\n", p->out);
    return it->maps == 0 || !it->data || put_picture(p, err);
}

static bool put_item(page *p, hs_error *err) {
    const rec_item *it = &p->item;
    if (it->type == REC_CALL) put_call(p);
    if (it->type == REC_RETURN) return put_return(p, err);
    if (it->type == REC_PLUGIN) put_in(p->out, "h1", it->name);
    if (it->type == REC_PLUGIN) put_in(p->out, "p", it->version);
    if (it->type == REC_LOG) put_in(p->out, "pre", it->text);
    return true;
}

bool rp_show(const char *file, const char *folder, hs_error *err) {
    static page p;
    char wrong[1500], path[SYS_PATH];
    int there = -1;
    hs_output_file out = {0};
    rec_reader *reader = rec_reader_open(file, wrong, sizeof wrong);
    if (!reader) return hs_fail(err, HS_ERR_INPUT, "%s", wrong);
    p = (page){.folder = folder};
    bool ok = hs_path_make_folder(folder, err) &&
              hs_path_join(folder, "index.html", path, sizeof path, err) && hs_output_open(&out, path, err);
    p.out = out.file;
    if (ok)
        (void)fputs(
            "<!doctype html>\n<meta charset=\"utf-8\">\n<meta name=viewport content=\"width=device-width\">\n"
            "<title>Recording</title>\n<style>:root { color-scheme: light dark; } body { font: 15px/1.4 "
            "sans-serif; max-width: 70rem; margin: 1rem auto; padding: 0 1rem; } "
            "img { max-width: 24rem; width: 100%; } "
            "pre { white-space: pre-wrap; overflow-wrap: anywhere; margin: .2rem 0; } "
            ".bad { border-left: .3rem solid #c33; padding-left: .5rem; }</style>\n",
            p.out);
    while (ok && (there = rec_reader_next(reader, &p.item, wrong, sizeof wrong)) == 1) ok = put_item(&p, err);
    rec_reader_close(reader);
    hs_picture_finish();
    if (ok && there < 0) {
        (void)fputs("<p class=bad>", p.out);
        put(p.out, wrong);
        (void)fputs("</p>\n", p.out);
    }
    if (ok && p.left_out) (void)fprintf(p.out, "<p>%u more depthmaps are not drawn.</p>\n", p.left_out);
    if (!ok) hs_output_discard(&out);
    ok = ok && hs_output_commit(&out, err);
    return ok && (there == 0 || hs_fail(err, HS_ERR_INPUT, "%s", wrong));
}
