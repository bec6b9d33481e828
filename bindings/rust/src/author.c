/* SPDX-License-Identifier: MIT */
/* The helper for authors as one function that Rust can call. */
#include "smartvis/author.h"

sv_status smartvis_author_create(const sva_method *method, const sv_host *host, const char *id,
                                 const sv_plugin **out);

sv_status smartvis_author_create(const sva_method *method, const sv_host *host, const char *id,
                                 const sv_plugin **out) {
    return sva_create(method, host, id, out);
}
