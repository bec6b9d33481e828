/* SPDX-License-Identifier: MIT */
#include "method/method.h"

#define SV_METHOD_ENTRY(NAME, value, key) [SV_METHOD_##NAME] = &sv_method_##key,
static const sv_method *const methods[SV_METHOD_END] = {SV_METHODS(SV_METHOD_ENTRY)};
#undef SV_METHOD_ENTRY

const sv_method *sv_method_of(uint32_t method) {
    return method < SV_METHOD_END ? methods[method] : NULL;
}

bool sv_method_uses(const sv_method *method, uint32_t parameter) {
    return method->parameters >> parameter & 1u;
}
