/* SPDX-License-Identifier: MIT */
/*
 * Pictures of results: drawn on plain pixels with cairo, written as PNG with libpng.
 *
 * Two levels. The lower one is a pixel array with blit, text, line and save. The upper one makes whole
 * pictures from the arrays the simulator has: a side-by-side panel, a depthmap, initial points over the MIP,
 * a signed error, a label map. Those allocate *out (hs_picture_free it); on failure it is zeroed. All
 * functions may be called from any thread, on different pictures at once. Maps are row-major, rows top to
 * bottom, columns left to right, as the camera sees them.
 */
#ifndef HS_PICTURE_H
#define HS_PICTURE_H

#include "base/error.h"

#include <stddef.h>
#include <stdint.h>

#define HS_PICTURE_MAX_AXIS 16384u /* pixels along one side */

/* Colours of all pictures, 0xRRGGBB. */
#define HS_COLOUR_BACKGROUND 0x1b1d20u
#define HS_COLOUR_TEXT       0xe6e6e6u
#define HS_COLOUR_FAINT_TEXT 0xa9adb3u
#define HS_COLOUR_NOTHING_A  0x6a6d72u /* "clips nothing": a hatch of two greys */
#define HS_COLOUR_NOTHING_B  0x4b4e53u
#define HS_COLOUR_EMPTY      0xff4b3eu /* an initial point with an empty interval */
#define HS_COLOUR_NO_VALUE   0x34373cu /* no value here, label "neither" */
#define HS_COLOUR_INVALID    0xff00ffu /* a value that should not be there: NaN, an unknown label */

/* A picture. Pixel (x, y) is pixels[y * width + x], 0x00RRGGBB. */
typedef struct {
    uint32_t width, height;
    uint32_t *pixels; /* owned */
} hs_picture;

/* A picture of one colour. HS_ERR_INPUT if a side is 0 or above HS_PICTURE_MAX_AXIS, or HS_ERR_MEMORY. */
bool hs_picture_init(hs_picture *picture, uint32_t width, uint32_t height, uint32_t colour, hs_error *err);
/* Frees the pixels and zeroes the struct. Safe on a zeroed struct. */
void hs_picture_free(hs_picture *picture);

/* Writes a PNG (8-bit RGB) under a temporary name and renames it. HS_ERR_OUTPUT names the path and the
 * reason. */
bool hs_picture_save(const hs_picture *picture, const char *path, hs_error *err);

/* Reads a PNG of any kind as 8-bit RGB. HS_ERR_INPUT names the path and the reason. */
bool hs_picture_load(hs_picture *out, const char *path, hs_error *err);

/* A JPEG in memory (free it), for renderings: with speckle a sixth of a PNG at quality 88. `quality` 1 ..
 * 100. */
bool hs_picture_jpeg(const hs_picture *picture, int quality, uint8_t **data, size_t *bytes, hs_error *err);

/* An image in memory that is borrowed: 1 (gray) or 4 (RGBA; alpha is not used, the renderer draws on black)
 * bytes a pixel. */
typedef struct {
    const uint8_t *data; /* width * height * channels bytes */
    uint32_t width, height, channels;
} hs_image;

/* How an image is scaled. Nearest keeps pixels as they are. Smooth interpolates linearly between pixel
 * centres, and beyond the outermost centres repeats the edge; where the image becomes smaller, a pixel is the
 * mean of the area it covers. */
typedef enum { HS_SCALE_NEAREST = 0, HS_SCALE_SMOOTH } hs_scale;

/* Draws `image` over the rectangle (x, y, width, height) of the picture; what lies outside is cut off. */
void hs_picture_blit(hs_picture *picture, int32_t x, int32_t y, uint32_t width, uint32_t height,
                     const hs_image *image, hs_scale scale);

/* Where `x` of a text is. */
typedef enum { HS_ALIGN_LEFT = 0, HS_ALIGN_CENTRE, HS_ALIGN_RIGHT } hs_align;

/* One line of UTF-8 in DejaVu Sans, `size` pixels high, standing on y. Wider than max_width (0: no limit) it
 * is set smaller, down to three quarters, then cut with an ellipsis. Bytes that are no UTF-8 (file names may
 * hold any) become '?'. */
bool hs_picture_text(hs_picture *picture, double x, double y, double size, uint32_t colour, hs_align align,
                     double max_width, const char *text, hs_error *err);

/* A straight line between two points; pixel centres are at halves. */
bool hs_picture_line(hs_picture *picture, double x0, double y0, double x1, double y1, double width,
                     uint32_t colour, hs_error *err);

/* Frees what cairo and fontconfig keep for the whole process (fonts), so that a leak checker finds nothing.
 * Once, at the end of the program, when no other thread draws. */
void hs_picture_finish(void);

/* Viridis, for t in 0 .. 1 (clamped): perceptually uniform, lightness grows with t. */
uint32_t hs_colour_viridis(double t);
/* Blue - white - red, for t in -1 .. 1 (clamped); 0 is white. */
uint32_t hs_colour_diverging(double t);
/* Colour of a label of the label map (0 neither, 1 sac only, 2 fetus); HS_COLOUR_INVALID for any other. */
uint32_t hs_colour_label(uint8_t label);

/* One picture of a panel. */
typedef struct {
    const char *caption; /* above it; NULL for none */
    hs_image image;
} hs_panel_item;

/* Title and facts around a picture. NULL for none. */
typedef struct {
    const char *title;  /* one line above */
    const char *footer; /* below; '\n' parts lines */
} hs_caption;

/* `count` (1 .. 8) images of equal size next to each other, each `cell` pixels wide (0: 512, so that three
 * make 1600) and scaled smoothly with its aspect kept. HS_ERR_INPUT if sizes differ. */
bool hs_picture_panel(hs_picture *out, const hs_panel_item *items, uint32_t count, uint32_t cell,
                      const hs_caption *caption, hs_error *err);

/* What the ends of a depth colour bar are, in slices; low >= high: the smallest and largest of the drawn
 * depths. */
typedef struct {
    float low, high;
} hs_range;

/* A depthmap (width * height float32, slices) in viridis with a colour bar. A depth <= 0 clips nothing: grey
 * hatch, its share in the legend. NaN and infinities are drawn in HS_COLOUR_INVALID and counted. */
bool hs_picture_depthmap(hs_picture *out, const float *depth, uint32_t width, uint32_t height, hs_range range,
                         const hs_caption *caption, hs_error *err);

/* Initial points over the MIP. `mip` is scaled to the map; `status` (SV_POINT_*) and `depth` (slices) are
 * width * height: a point in an interval has the colour of its depth, one with an empty interval
 * HS_COLOUR_EMPTY. The legend counts both. A depth <= 0 of an interval point has the colour of `low`. */
bool hs_picture_points(hs_picture *out, const hs_image *mip, const uint8_t *status, const float *depth,
                       uint32_t width, uint32_t height, hs_range range, const hs_caption *caption,
                       hs_error *err);

/* Words of a signed map's legend. */
typedef struct {
    const char *quantity; /* "error" */
    const char *unit;     /* "steps" */
    const char *positive; /* what red means: "occluder left" */
    const char *negative; /* what blue means: "fetus cut" */
} hs_signed_words;

/* A signed map, blue - white - red over -limit .. limit (limit <= 0: its largest absolute value). NaN: no
 * value, drawn in HS_COLOUR_NO_VALUE. */
bool hs_picture_signed(hs_picture *out, const float *value, uint32_t width, uint32_t height, float limit,
                       const hs_signed_words *words, const hs_caption *caption, hs_error *err);

/* Words of a share's legend. */
typedef struct {
    const char *quantity;   /* "confidence" */
    const char *high, *low; /* what 1 and 0 mean: "sure", "unsure" */
} hs_share_words;

/* A map of shares, 0 .. 1 in viridis. What is not in 0 .. 1 is drawn in HS_COLOUR_INVALID and counted. The
 * mean stands in the legend. */
bool hs_picture_share(hs_picture *out, const float *value, uint32_t width, uint32_t height,
                      const hs_share_words *words, const hs_caption *caption, hs_error *err);

/* A label map (0 neither, 1 sac only, 2 fetus) with the share of each label. */
bool hs_picture_labels(hs_picture *out, const uint8_t *label, uint32_t width, uint32_t height,
                       const hs_caption *caption, hs_error *err);

#endif
