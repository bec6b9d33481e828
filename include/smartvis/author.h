/* SPDX-License-Identifier: MIT */
/*
 * A helper for authors of plugins, header-only and optional: it is everything but the method.
 *
 *   the author writes                      the helper does
 *   -----------------                      ---------------
 *   a descriptor                           create, destroy, the states and their errors
 *   a table of parameters (sva_param)      parameters: their description, texts, checks and values
 *   a few functions (sva_method)           checks of every struct; slab order, shape and completeness
 *   SVA_ENTRY(method);                     where a voxel lies, which were scanned, results, log, last_error
 *
 * A method on the CPU needs one function: `finish` sees the whole volume by sva_voxel and fills a map of
 * depths. A method with kernels adds `slab` and `output`, and author_cl.h. examples/ has one of each.
 *
 *   author_method.h    the types, and what a method may call: the part to read
 *   author_checks.h    what the ABI's header demands of a host
 *   author_any.h       the functions of a plugin for any thread
 *   author_calls.h     the other ones, and how an instance is made
 *   author_cl.h        for kernels; include <CL/cl.h> before it
 *
 * C99 to C23 and C++11 to C++20. Nothing here allocates on the frame path.
 */
#ifndef SMARTVIS_AUTHOR_H
#define SMARTVIS_AUTHOR_H

#include "smartvis/author_calls.h"

/* Exports the plugin: the only symbol of the library. `method` is a const sva_method of the same file.
 * SV_EXPORT stands at the symbol's declaration in smartvis_plugin.h; here g++ would warn of it. */
#define SVA_ENTRY(method)                                                                                    \
    static const sv_descriptor *SV_CALL sva_entry_descriptor(uint32_t index) {                               \
        return index == 0 ? (method).descriptor : NULL;                                                      \
    }                                                                                                        \
    static sv_status SV_CALL sva_entry_create(const sv_host *host, const char *id, const sv_plugin **out) {  \
        return sva_create(&(method), host, id, out);                                                         \
    }                                                                                                        \
    const sv_entry smartvis_plugin_entry = {                                                                 \
        SV_ABI_MAJOR, SV_ABI_MINOR, (uint32_t)sizeof(sv_entry), 1, sva_entry_descriptor, sva_entry_create}

#endif
