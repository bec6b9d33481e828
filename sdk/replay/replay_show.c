/* SPDX-License-Identifier: MIT */
/* A recording as a page of its frames; nothing is played. */
#include "core/output_file.h"
#include "core/paths.h"
#include "core/progress.h"
#include "core/system.h"
#include "core/text.h"
#include "plugin/loader.h"
#include "replay/replay.h"

#include <inttypes.h>
#include <math.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>

enum { MAX_PICTURES = 500 };

typedef struct {
    const rp_options *o;
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

/* The least and the largest depth of the rays that are clipped; false if none is. */
static bool find_range(const float *depth, size_t rays, float *least, float *most) {
    bool any = false;
    for (size_t i = 0; i < rays; i++) {
        if (!isfinite(depth[i]) || depth[i] <= 0.0f) continue;
        *least = any ? fminf(*least, depth[i]) : depth[i];
        *most = any ? fmaxf(*most, depth[i]) : depth[i];
        any = true;
    }
    return any;
}

/* Near is bright, as in the machine's pictures; what is not clipped is black. */
static void shade(const float *depth, size_t rays, float least, float most, uint8_t *grey) {
    const float scale = most > least ? 200.0f / (most - least) : 0.0f;
    for (size_t i = 0; i < rays; i++)
        grey[i] = isfinite(depth[i]) && depth[i] > 0.0f ? (uint8_t)(255.0f - scale * (depth[i] - least)) : 0;
}

static bool save_picture(const page *p, const char *name, const uint8_t *grey, hs_error *err) {
    char path[SYS_PATH];
    hs_output_file file = {0};
    png_image image = {.version = PNG_IMAGE_VERSION, .format = PNG_FORMAT_GRAY, .flags = PNG_IMAGE_FLAG_FAST};
    image.width = p->format.width;
    image.height = p->format.height;
    if (!hs_path_join(p->o->show, name, path, sizeof path, err) || !hs_output_open(&file, path, err))
        return false;
    if (png_image_write_to_stdio(&image, file.file, 0, grey, 0, NULL)) return hs_output_commit(&file, err);
    hs_output_discard(&file);
    return hs_fail(err, HS_ERR_OUTPUT, "%s: %s", path, image.message);
}

/* The recorded depthmap. A host that tells no spacing gets depths in slices. */
static bool put_picture(page *p, hs_error *err) {
    const sv_format *f = &p->format;
    const size_t rays = (size_t)f->width * f->height;
    const float *depth = (const float *)(const void *)p->item.data;
    const bool mm = f->spacing_mm[2] > 0.0f;
    const float unit = mm ? f->spacing_mm[2] : 1.0f;
    char name[32];
    float least = 0.0f, most = 0.0f;
    if (p->pictures == MAX_PICTURES) return ++p->left_out;
    uint8_t *grey = malloc(rays);
    if (!grey) return hs_fail(err, HS_ERR_MEMORY, "a depthmap: no memory for %zu rays", rays);
    (void)snprintf(name, sizeof name, "depthmap_%04u.png", p->pictures++);
    const bool any = find_range(depth, rays, &least, &most);
    shade(depth, rays, least, most, grey);
    const bool ok = save_picture(p, name, grey, err);
    free(grey);
    (void)fprintf(p->out, "<figure><a href=%s><img src=%s alt=\"the depthmap\"></a><figcaption>", name, name);
    if (any)
        (void)fprintf(p->out, "%.1f (bright) to %.1f %s, black: not clipped", (double)(least * unit),
                      (double)(most * unit), mm ? "mm" : "slices, for the host told no spacing");
    else
        (void)fputs("nothing is clipped", p->out);
    (void)fputs("</figcaption></figure>\n", p->out);
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

bool rp_show(const rp_options *o, hs_error *err) {
    static page p;
    char wrong[1500], path[SYS_PATH];
    int there = -1;
    hs_output_file out = {0};
    rec_reader *reader = rec_reader_open(o->file, wrong, sizeof wrong);
    if (!reader) return hs_fail(err, HS_ERR_INPUT, "%s", wrong);
    const double began = hs_now();
    p = (page){.o = o};
    bool ok = hs_path_make_folder(o->show, err) &&
              hs_path_join(o->show, "index.html", path, sizeof path, err) && hs_output_open(&out, path, err);
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
    while (ok && (there = rec_reader_next(reader, &p.item, wrong, sizeof wrong)) == 1) {
        ok = put_item(&p, err);
        if (hs_now() - began <= o->seconds) continue;
        /* A file of few bytes may hold maps of many rays. */
        (void)snprintf(wrong, sizeof wrong, "%s: has been shown for %.1f s: --seconds allows more", o->file,
                       o->seconds);
        there = -1;
        break;
    }
    rec_reader_close(reader);
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
