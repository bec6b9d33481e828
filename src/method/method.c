/* SPDX-License-Identifier: MIT */
#include "method/method.h"

#include <assert.h>

#define SV_METHOD_TABLE(NAME, value, key) extern const sv_method sv_method_##key;
SV_METHODS(SV_METHOD_TABLE)
#undef SV_METHOD_TABLE

#define SV_METHOD_ENTRY(NAME, value, key) [SV_METHOD_##NAME] = &sv_method_##key,
static const sv_method *const methods[SV_METHOD_COUNT] = {SV_METHODS(SV_METHOD_ENTRY)};
#undef SV_METHOD_ENTRY

const sv_method *sv_method_of(uint32_t method) {
    assert(method < SV_METHOD_COUNT);
    return methods[method];
}

bool sv_method_uses(const sv_method *method, uint32_t parameter) {
    return method->parameters >> parameter & 1u;
}

sv_levels sv_levels_make(uint32_t width, uint32_t height) {
    sv_levels l = {.count = 0};
    for (;;) {
        l.width[l.count] = width;
        l.height[l.count] = height;
        l.offset[l.count] = l.pixels;
        l.pixels += width * height;
        l.count++;
        if ((width == 1 && height == 1) || l.count == SV_MAX_LEVELS) return l;
        width = (width + 1) / 2;
        height = (height + 1) / 2;
    }
}
