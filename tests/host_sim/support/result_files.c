/* SPDX-License-Identifier: MIT */
#include "support/result_files.h"

#include <math.h>
#include <zlib.h>

/* All of a file, and a 0 behind it. */
static uint8_t *slurp(const char *path, size_t *bytes) {
    FILE *file = fopen(path, "rb");
    if (!file) fail_msg("%s is not there", path);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    *bytes = (size_t)ftell(file);
    rewind(file);
    uint8_t *all = unit_memory(*bytes + 1);
    assert_int_equal(fread(all, 1, *bytes, file), *bytes);
    assert_int_equal(fclose(file), 0);
    return all;
}

/* What stands behind "\nName = ". */
static const char *value_of(const result_file *file, const char *name) {
    const char *const key = unit_text("\n%s = ", name);
    const char *found = strstr(file->text, key);
    if (!found) fail_msg("%s is missing", name);
    return found + strlen(key);
}

static void numbers_of(const result_file *file, const char *name, size_t count, double *out) {
    char *at = (char *)(uintptr_t)value_of(file, name);
    for (size_t i = 0; i < count; i++) {
        char *end;
        out[i] = strtod(at, &end);
        assert_ptr_not_equal(end, at);
        at = end;
    }
    assert_int_equal(*at, '\n');
}

static size_t type_bytes(const char *type) {
    static const struct {
        const char *name;
        size_t bytes;
    } types[] = {{"MET_UCHAR", 1}, {"MET_SHORT", 2}, {"MET_USHORT", 2}, {"MET_FLOAT", 4}, {"MET_DOUBLE", 8}};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (strcmp(types[i].name, type) == 0) return types[i].bytes;
    fail_msg("%s is not expected", type);
    return 0;
}

static void read_geometry(result_file *file) {
    double dims, size[4], offset[4], matrix[16];
    double spacing[4];
    numbers_of(file, "NDims", 1, &dims);
    file->dims = (uint32_t)dims;
    assert_true(file->dims == 3 || file->dims == 4);
    numbers_of(file, "DimSize", file->dims, size);
    numbers_of(file, "ElementSpacing", file->dims, spacing);
    numbers_of(file, "Offset", file->dims, offset);
    numbers_of(file, "TransformMatrix", (size_t)file->dims * file->dims, matrix);
    for (uint32_t i = 0; i < file->dims; i++) file->size[i] = (uint32_t)size[i];
    for (uint32_t i = file->dims; i < 4; i++) file->size[i] = 1;
    for (uint32_t axis = 0; axis < 3; axis++) {
        file->spacing[axis] = spacing[axis];
        file->origin[axis] = offset[axis];
        for (uint32_t k = 0; k < 3; k++) file->direction[k * 3 + axis] = matrix[axis * file->dims + k];
    }
}

void result_open(result_file *file, const char *path) {
    size_t bytes;
    uint8_t *all = slurp(path, &bytes);
    memset(file, 0, sizeof *file);
    static const char last[] = "\nElementDataFile = LOCAL\n";
    const char *end = strstr((const char *)all, last);
    assert_non_null(end);
    const size_t text = (size_t)(end - (const char *)all) + sizeof last - 1;
    assert_true(text < sizeof file->text);
    memcpy(file->text, all, text);
    read_geometry(file);
    (void)snprintf(file->type, sizeof file->type, "%.*s", (int)strcspn(value_of(file, "ElementType"), "\n"),
                   value_of(file, "ElementType"));
    file->voxel_bytes = type_bytes(file->type);
    file->voxels = (size_t)file->size[0] * file->size[1] * file->size[2] * file->size[3];
    const size_t expected = file->voxels * file->voxel_bytes;
    file->data = unit_memory(expected);
    if (strncmp(value_of(file, "CompressedData"), "True", 4) == 0) {
        uLongf made = expected;
        assert_int_equal(uncompress(file->data, &made, all + text, (uLong)(bytes - text)), Z_OK);
        assert_int_equal(made, expected);
    } else {
        assert_int_equal(bytes - text, expected);
        memcpy(file->data, all + text, expected);
    }
}

void result_world(const result_file *file, const double index[3], double world[3]) {
    for (int k = 0; k < 3; k++) {
        world[k] = file->origin[k];
        for (int a = 0; a < 3; a++) world[k] += file->direction[k * 3 + a] * file->spacing[a] * index[a];
    }
}

void result_index(const result_file *file, const double world[3], double index[3]) {
    for (int a = 0; a < 3; a++) {
        index[a] = 0;
        for (int k = 0; k < 3; k++) index[a] += file->direction[k * 3 + a] * (world[k] - file->origin[k]);
        index[a] /= file->spacing[a];
    }
}

double result_map_at(const result_file *map, double x, double y) {
    double weights = 0, sum = 0;
    x = x < 0 ? 0 : x > map->size[0] - 1.0 ? map->size[0] - 1.0 : x;
    y = y < 0 ? 0 : y > map->size[1] - 1.0 ? map->size[1] - 1.0 : y;
    for (uint32_t j = (uint32_t)y; j <= (uint32_t)y + 1 && j < map->size[1]; j++)
        for (uint32_t i = (uint32_t)x; i <= (uint32_t)x + 1 && i < map->size[0]; i++) {
            const double w = fmax(0, 1 - fabs(x - i)) * fmax(0, 1 - fabs(y - j));
            if (w == 0) continue;
            float value;
            memcpy(&value, map->data + ((size_t)j * map->size[0] + i) * sizeof value, sizeof value);
            weights += w;
            sum += w * (double)value;
        }
    assert_true(fabs(weights - 1) < 1e-9);
    return sum;
}

void result_mesh_open(result_mesh *mesh, const char *path) {
    size_t bytes;
    uint8_t *all = slurp(path, &bytes);
    const char *text = (const char *)all;
    const char *vertex = strstr(text, "\nelement vertex "), *face = strstr(text, "\nelement face ");
    const char *end = strstr(text, "\nend_header\n");
    assert_int_equal(strncmp(text, "ply\nformat binary_little_endian 1.0\n", 36), 0);
    assert_true(vertex && face && end);
    assert_non_null(strstr(text, "\ncomment SPACE=LPS")); /* as 3D Slicer looks for it */
    mesh->vertices = (uint32_t)strtoul(vertex + 16, NULL, 10);
    mesh->faces = (uint32_t)strtoul(face + 14, NULL, 10);
    const uint8_t *at = (const uint8_t *)end + strlen("\nend_header\n");
    assert_int_equal((size_t)(all + bytes - at), mesh->vertices * 12u + mesh->faces * 13u);
    mesh->vertex = unit_memory(mesh->vertices * sizeof *mesh->vertex + 1);
    mesh->face = unit_memory(mesh->faces * sizeof *mesh->face + 1);
    memcpy(mesh->vertex, at, mesh->vertices * 12u);
    at += mesh->vertices * 12u;
    for (uint32_t i = 0; i < mesh->faces; i++, at += 13) {
        assert_int_equal(*at, 3);
        memcpy(mesh->face[i], at + 1, 12);
    }
}
