/* SPDX-License-Identifier: MIT */
/* The command line that reproduces what a stage shows. */
#include "console/console.h"

#include "plugin/loader_param.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A word for a shell: in single quotes unless it is harmless. */
static void put_word(FILE *out, const char *word) {
    static const char harmless[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./=,+-";
    if (word[0] != '\0' && strspn(word, harmless) == strlen(word)) {
        (void)fputs(word, out);
        return;
    }
    (void)fputc('\'', out);
    for (const char *c = word; *c; c++) {
        if (*c == '\'')
            (void)fputs("'\\''", out);
        else
            (void)fputc(*c, out);
    }
    (void)fputc('\'', out);
}

static void put_source(FILE *out, const hs_console_stage *stage) {
    const hs_console_source *s = &stage->state.source;
    if (s->scene[0] != '\0') {
        (void)fprintf(out, " --scene %s --size %u", s->scene, s->size);
        if (s->volumes > 1) (void)fprintf(out, " --moving %u", s->volumes);
    } else {
        (void)fputs(" --volume ", out);
        put_word(out, stage->path[stage->path_used]);
        if (stage->read.has_spacing)
            (void)fprintf(out, " --spacing %.9g,%.9g,%.9g", stage->read.spacing[0], stage->read.spacing[1],
                          stage->read.spacing[2]);
        if (stage->read.has_probe) (void)fprintf(out, " --probe %s", hs_probe_name(stage->read.probe));
    }
    if (s->from != HS_FROM_PROBE) (void)fprintf(out, " --view %s", hs_from_name(s->from));
}

/* Prints a number with the fewest digits that read back to the same one. */
static void number_text(double value, char *out, size_t bytes) {
    for (int digits = 6; digits <= 17; digits++) {
        (void)snprintf(out, bytes, "%.*g", digits, value);
        if (strtod(out, NULL) == value) return;
    }
}

static void float_text(float value, char *out, size_t bytes) {
    for (int digits = 4; digits <= 9; digits++) {
        (void)snprintf(out, bytes, "%.*g", digits, (double)value);
        if ((float)strtod(out, NULL) == value) return;
    }
}

static void put_values(FILE *out, const hs_lane *lane) {
    for (uint32_t i = 0; i < lane->count; i++) {
        const sv_plugin *instance = lane->plugin.instance;
        const uint32_t params = hs_plugin_param_count(&lane->plugin);
        for (uint32_t k = 0; k < params; k++) {
            char value[HS_ENUM_NAME], word[2 * HS_CONSOLE_KEY + 8];
            sv_param_info info = {.size = sizeof info};
            if (instance->param_info(instance, k, &info) != SV_OK || info.id != lane->values[i].id) continue;
            if (lane->values[i].value == info.default_value) break;
            if (info.type == SV_PARAM_ENUM)
                hs_plugin_value_text(&lane->plugin, &info, lane->values[i].value, value, sizeof value);
            else
                number_text(lane->values[i].value, value, sizeof value);
            (void)snprintf(word, sizeof word, "%.63s=%.64s", info.key, value);
            (void)fputs(" --set ", out);
            put_word(out, word);
            break;
        }
    }
}

static void put_plugin(FILE *out, const hs_console_stage *stage, const hs_lane *lane) {
    static const char *const guards[] = {"", " --guard", " --no-guard"};
    if (lane->offer->library) {
        (void)fputs(" --plugin ", out);
        put_word(out, lane->offer->library);
    }
    if (!lane->offer->first && lane->offer->id[0] != '\0') {
        (void)fputs(" --id ", out);
        put_word(out, lane->offer->id);
    }
    (void)fputs(guards[stage->offers->guard.choice], out);
    if (lane->has_plugin) put_values(out, lane);
}

static void put_renderer(FILE *out, const hs_console_state *s) {
    hs_dvr_settings usual;
    hs_loop_options pictures;
    hs_dvr_defaults(&usual);
    pictures.dvr = usual;
    hs_loop_for_pictures(&pictures, s->dvr.look);
    const struct {
        const char *option;
        float value, usual;
    } floats[] = {{"t-low", s->dvr.threshold_low, usual.threshold_low},
                  {"t-high", s->dvr.threshold_high, usual.threshold_high},
                  {"ghost-offset", s->dvr.ghost_offset, usual.ghost_offset},
                  {"ghost-width", s->dvr.ghost_width, usual.ghost_width},
                  {"ghost-doubt", s->dvr.ghost_doubt, usual.ghost_doubt},
                  {"exposure", s->dvr.exposure, pictures.dvr.exposure}};
    char text[32], other[32];
    if (s->dvr.look != HS_LOOK_LIT) (void)fprintf(out, " --look %s", hs_look_key(s->dvr.look));
    if (s->dvr.light[0] != usual.light[0] || s->dvr.light[1] != usual.light[1]) {
        float_text(s->dvr.light[0], text, sizeof text);
        float_text(s->dvr.light[1], other, sizeof other);
        (void)fprintf(out, " --light %s,%s", text, other);
    }
    for (size_t i = 0; i < sizeof floats / sizeof *floats; i++) {
        if (floats[i].value == floats[i].usual) continue;
        float_text(floats[i].value, text, sizeof text);
        (void)fprintf(out, " --%s %s", floats[i].option, text);
    }
}

static void put_camera(FILE *out, const hs_console_stage *stage) {
    const hs_console_state *s = &stage->state;
    const double values[4] = {s->yaw, s->pitch, s->roll, s->zoom};
    static const char *const names[4] = {"yaw", "pitch", "roll", "zoom"};
    (void)fputs(" --turnable", out);
    if (stage->lowres) (void)fprintf(out, " --lowres %u", stage->lowres);
    for (int i = 0; i < 4; i++) {
        char text[32];
        if (values[i] == (i == 3 ? 1.0 : 0.0)) continue;
        number_text(values[i], text, sizeof text);
        (void)fprintf(out, " --%s %s", names[i], text);
    }
}

/* Numbers with commas between them. */
static void put_numbers(FILE *out, const char *option, const double *values, int count) {
    for (int k = 0; k < count; k++) {
        char text[32];
        number_text(values[k], text, sizeof text);
        (void)fprintf(out, "%s%s", k > 0 ? "," : option, text);
    }
}

static void put_box(FILE *out, const hs_crop *crop) {
    if (!crop->used) return;
    put_numbers(out, " --box ", crop->low, 3);
    put_numbers(out, ",", crop->high, 3);
}

static void put_marks(FILE *out, const hs_console_state *s) {
    for (uint32_t i = 0; i < s->mark_count; i++) {
        const hs_mark *m = &s->marks[i];
        const double values[4] = {m->place[0], m->place[1], m->place[2], m->radius};
        put_numbers(out, m->keep ? " --keep " : " --remove ", values, 4);
    }
}

/* A run's pictures are of its middle frame. */
static void put_frames(FILE *out, const hs_console_stage *stage) {
    const uint32_t index = stage->index % stage->source.count;
    (void)fprintf(out, " --picture %u --setting smartvis --frames %u", stage->state.picture, 2 * index + 1);
}

char *hs_console_line(const hs_console_stage *stage, uint32_t lane) {
    char *text = NULL;
    size_t bytes = 0;
    FILE *out = open_memstream(&text, &bytes);
    if (!out) return NULL;
    (void)fputs("host_sim run", out);
    put_source(out, stage);
    put_plugin(out, stage, &stage->lane[lane]);
    put_camera(out, stage);
    put_renderer(out, &stage->state);
    put_box(out, &stage->state.crop);
    put_marks(out, &stage->state);
    put_frames(out, stage);
    if (fclose(out) == 0) return text;
    free(text);
    return NULL;
}
