/* SPDX-License-Identifier: MIT */
/*
 * Method spline: thin-plate spline (cl/spline/spline.clh has the mathematics). How many points there are is
 * known to the device only, so the commands are those of the most that can come; a kernel with nothing to do
 * returns at once. More points than the solver takes are merged.
 */
#include "method/method.h"

#include "device/queue.h"
#include "kernels_spline.h"
#include "spline/spline_shared.h"

enum {
    K_CELLS,
    K_LIST,
    K_FRAME,
    K_KVT,
    K_MIDDLE,
    K_MATRIX,
    K_DIAGONAL,
    K_BELOW,
    K_TRAILING,
    K_BACK,
    K_REST,
    K_PLANE,
    K_NODES,
    K_BETWEEN
};
static const char *const kernels[] = {
    "spline_cells",  "spline_list",     "spline_frame", "spline_kvt",      "spline_middle",
    "spline_matrix", "spline_diagonal", "spline_below", "spline_trailing", "spline_back",
    "spline_rest",   "spline_plane",    "spline_nodes", "spline_between",  NULL};

enum { CELLS, VECTORS, FRAME, INFO, MATRIX, PANEL, NODES };
/* Points that float32 can solve for, and the grid that leaves no more. */
enum { FLOAT_POINTS = 64, FLOAT_GRID = 8 };

static sv_source source(void) {
    return (sv_source){sv_kernels_spline, sv_kernels_spline_size};
}

static uint32_t smaller(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

/* Cells per side of the merging grid: the one that was asked for, or the finest that always fits. */
static uint32_t merge_cells(const sv_map *m) {
    const uint32_t maximum = m->doubles ? SV_SPLINE_MAX_GRID : FLOAT_GRID;
    return m->config->merge_grid ? smaller(m->config->merge_grid, maximum) : maximum;
}

static uint32_t max_points(const sv_map *m) {
    const uint32_t cells = merge_cells(m) * merge_cells(m);
    const uint32_t maximum = m->doubles ? SV_SPLINE_MAX_POINTS : FLOAT_POINTS;
    const uint64_t pixels = (uint64_t)m->width * m->height;
    const uint32_t wanted = m->config->merge_grid ? cells : maximum;
    return pixels < wanted ? (uint32_t)pixels : wanted;
}

/* From one point's value to the next plane of a vector, and from one row of the matrix to the next. */
static uint32_t stride_of(const sv_method_state *s) {
    return (s->capacity + 2 + SV_SPLINE_TILE + 7) / 8 * 8 + 8;
}

/* True if the coarse grid has fewer nodes than the map has pixels. */
static bool coarse(const sv_map *m) {
    const uint64_t side = (uint64_t)m->config->spline_grid + 1;
    return side > 1 && side * side < (uint64_t)m->width * m->height;
}

static sv_status make_buffers(const sv_map *m, sv_method_state *s) {
    s->capacity = max_points(m);
    const size_t real = m->doubles ? sizeof(cl_double) : sizeof(cl_float);
    const size_t stride = stride_of(s), cells = merge_cells(m);
    const size_t nodes = coarse(m) ? (size_t)m->config->spline_grid + 1 : 0;
    const size_t bytes[] = {[CELLS] = 5 * cells * cells * real,
                            [VECTORS] = SV_SPLINE_VECTORS * stride * real,
                            [FRAME] = SV_SPLINE_FRAME_WORDS * real,
                            [INFO] = SV_SPLINE_INFO_WORDS * sizeof(cl_uint),
                            [MATRIX] = stride * stride * real,
                            [PANEL] = SV_SPLINE_PANEL * stride * real,
                            [NODES] = 2 * nodes * nodes * sizeof(cl_float)};
    return sv_buffers_make(m->queue, bytes, sizeof bytes / sizeof *bytes, s->buffer);
}

static sv_launch begin(const sv_map *m, const sv_method_state *s, int kernel) {
    return sv_launch_begin(m->queue, s->kernels.kernel[kernel], kernels[kernel]);
}

static void buffers(sv_launch *l, const sv_method_state *s, const int *which) {
    for (; *which >= 0; which++) sv_launch_buffer(l, s->buffer[*which]);
}
#define BUFFERS(l, s, ...) buffers(l, s, (const int[]){__VA_ARGS__, -1})

/* The list of points, and the reflections that span the null space. */
static sv_status list_points(const sv_map *m, sv_method_state *s) {
    const uint32_t cells = merge_cells(m);
    sv_launch l = begin(m, s, K_CELLS);
    const uint32_t map[] = {m->width, m->padded_width, m->height, cells};
    for (size_t i = 0; i < 4; i++) sv_launch_uint(&l, map[i]);
    sv_launch_buffer(&l, m->points);
    BUFFERS(&l, s, CELLS);
    sv_launch_buffer(&l, m->record);
    sv_status status = sv_launch_items(&l, (size_t)cells * cells, SV_STAGE_RECONSTRUCT);
    if (status != SV_OK) return status;
    l = begin(m, s, K_LIST);
    const uint32_t list[] = {m->width, m->padded_width, m->height,   m->config->merge_grid,
                             cells,    s->capacity,     stride_of(s)};
    for (size_t i = 0; i < 7; i++) sv_launch_uint(&l, list[i]);
    sv_launch_buffer(&l, m->points);
    BUFFERS(&l, s, CELLS, VECTORS, INFO);
    sv_launch_buffer(&l, m->record);
    status = sv_launch_items(&l, 1, SV_STAGE_RECONSTRUCT);
    if (status != SV_OK) return status;
    l = begin(m, s, K_FRAME);
    sv_launch_uint(&l, stride_of(s));
    BUFFERS(&l, s, VECTORS, FRAME, INFO);
    return sv_launch_items(&l, 1, SV_STAGE_RECONSTRUCT);
}

/* A kernel with the arguments stride, lambda (if it has it) and buffers. */
static sv_status step(const sv_map *m, sv_method_state *s, int kernel, bool lambda, const int *which,
                      size_t items) {
    const float value = (float)m->values.of[SV_PARAM_LAMBDA];
    sv_launch l = begin(m, s, kernel);
    sv_launch_uint(&l, stride_of(s));
    if (lambda) sv_launch_arg(&l, sizeof value, &value);
    buffers(&l, s, which);
    return sv_launch_items(&l, items, SV_STAGE_RECONSTRUCT);
}
#define STEP(kernel, lambda, items, ...) step(m, s, kernel, lambda, (const int[]){__VA_ARGS__, -1}, items)

/* One panel of the factorisation. */
static sv_status factor_panel(const sv_map *m, sv_method_state *s, uint32_t number) {
    const uint32_t first = number * SV_SPLINE_PANEL;
    const size_t below = s->capacity + 2 - (first < s->capacity ? first : s->capacity);
    sv_launch l = begin(m, s, K_DIAGONAL);
    sv_launch_uint(&l, stride_of(s));
    sv_launch_uint(&l, number);
    BUFFERS(&l, s, MATRIX, FRAME, INFO);
    sv_status status = sv_launch_items(&l, 1, SV_STAGE_RECONSTRUCT);
    if (status != SV_OK) return status;
    l = begin(m, s, K_BELOW);
    sv_launch_uint(&l, stride_of(s));
    sv_launch_uint(&l, number);
    BUFFERS(&l, s, MATRIX, PANEL, INFO);
    status = sv_launch_items(&l, below, SV_STAGE_RECONSTRUCT);
    if (status != SV_OK) return status;
    l = begin(m, s, K_TRAILING);
    sv_launch_uint(&l, stride_of(s));
    sv_launch_uint(&l, number);
    BUFFERS(&l, s, MATRIX, PANEL, INFO);
    return sv_launch_grid(&l, (below + SV_SPLINE_SPAN - 1) / SV_SPLINE_SPAN,
                          (below + SV_SPLINE_TILE - 1) / SV_SPLINE_TILE, SV_STAGE_RECONSTRUCT);
}

static sv_status solve(const sv_map *m, sv_method_state *s) {
    sv_status status = STEP(K_KVT, true, s->capacity, VECTORS, FRAME, INFO);
    if (status == SV_OK) status = STEP(K_MIDDLE, false, 1, VECTORS, FRAME, INFO);
    if (status == SV_OK) status = STEP(K_MATRIX, true, s->capacity + 2, VECTORS, FRAME, MATRIX, INFO);
    for (uint32_t n = 0; status == SV_OK && n * SV_SPLINE_PANEL < s->capacity; n++)
        status = factor_panel(m, s, n);
    if (status == SV_OK) status = STEP(K_BACK, false, 2, MATRIX, VECTORS, FRAME, INFO);
    if (status == SV_OK) status = STEP(K_REST, true, s->capacity, VECTORS, FRAME, INFO);
    return status == SV_OK ? STEP(K_PLANE, false, 1, VECTORS, FRAME, INFO) : status;
}

/* Values at the nodes, `out` being the surfaces themselves if every pixel is one. */
static sv_status evaluate(const sv_map *m, sv_method_state *s, uint32_t planes) {
    const bool grid = coarse(m);
    const uint32_t nodes_x = grid ? m->config->spline_grid + 1 : m->width;
    const uint32_t nodes_y = grid ? m->config->spline_grid + 1 : m->height;
    const uint32_t pitch = grid ? nodes_x : m->padded_width;
    const cl_ulong plane = (cl_ulong)pitch * nodes_y;
    const float step_x = grid ? (float)(m->width - 1) / (float)m->config->spline_grid : 1.0f;
    const float step_y = grid ? (float)(m->height - 1) / (float)m->config->spline_grid : 1.0f;
    sv_launch l = begin(m, s, K_NODES);
    sv_launch_uint(&l, stride_of(s));
    sv_launch_uint(&l, nodes_x);
    sv_launch_uint(&l, pitch);
    sv_launch_arg(&l, sizeof plane, &plane);
    sv_launch_arg(&l, sizeof step_x, &step_x);
    sv_launch_arg(&l, sizeof step_y, &step_y);
    BUFFERS(&l, s, VECTORS, FRAME, INFO);
    sv_launch_uint(&l, planes);
    sv_launch_buffer(&l, grid ? s->buffer[NODES] : m->surfaces);
    const sv_status status = sv_launch_pixels(&l, nodes_x, nodes_y, SV_STAGE_RECONSTRUCT);
    if (status != SV_OK || !grid) return status;
    l = begin(m, s, K_BETWEEN);
    const uint32_t sizes[] = {m->width, m->padded_width, m->height, m->config->spline_grid, planes};
    for (size_t i = 0; i < 5; i++) sv_launch_uint(&l, sizes[i]);
    BUFFERS(&l, s, NODES);
    sv_launch_buffer(&l, m->surfaces);
    sv_launch_buffer(&l, m->record);
    return sv_launch_pixels(&l, m->width, m->height, SV_STAGE_RECONSTRUCT);
}

static sv_status run(const sv_map *m, sv_method_state *s, uint32_t planes) {
    sv_status status = list_points(m, s);
    if (status == SV_OK) status = solve(m, s);
    return status == SV_OK ? evaluate(m, s, planes) : status;
}

static uint32_t passes(const sv_map *m) {
    (void)m;
    return 1;
}

const sv_method sv_method_spline = {.definition = &sv_ref_method_spline,
                                    .parameters = SV_USES_POINTS | SV_USES(LAMBDA) | SV_USES(MERGE_GRID) |
                                                  SV_USES(SPLINE_GRID) | SV_USES(PRECISION),
                                    .linear = true,
                                    .kernels = kernels,
                                    .source = source,
                                    .buffers = make_buffers,
                                    .run = run,
                                    .passes = passes};
