/* SPDX-License-Identifier: MIT */
/* The library under test with one instance of its plugin, and the host that it sees. */
#include "validate/drive/drive.h"

#include "plugin/loader.h"
#include "validate/spy/library.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *v_status(sv_status status) {
    static _Thread_local char texts[4][64];
    static _Thread_local uint32_t turn;
    char *text = texts[turn++ % 4];
    (void)snprintf(text, sizeof texts[0], "%s (%d)", hs_status_name(status), (int)status);
    return text;
}

/* ---- the host */
static void blame(v_host *h, const char *what) {
    if (!h->fault[0]) (void)snprintf(h->fault, sizeof h->fault, "%s", what);
}

static void keep_line(const sv_host *host, int32_t severity, const char *text) {
    v_host *h = host->host_data;
    (void)pthread_mutex_lock(&h->lock);
    h->lines++;
    h->bytes += text ? strlen(text) : 0;
    h->severity = severity;
    if (host != &h->api) blame(h, "log: host is not the sv_host that create was given");
    if (severity < SV_LOG_DEBUG || severity > SV_LOG_PLUGIN_MISBEHAVING) {
        char what[64];
        (void)snprintf(what, sizeof what, "log: severity is %d, expected 0 to 5", (int)severity);
        blame(h, what);
    }
    if (!text) blame(h, "log: text is NULL");
    (void)snprintf(h->line, sizeof h->line, "%s", text ? text : "");
    (void)snprintf(h->run->report->line, sizeof h->run->report->line, "%.199s", h->line);
    if (h->run->verbose) (void)fprintf(stderr, "    log %d: %s\n", (int)severity, text ? text : "(null)");
    (void)pthread_mutex_unlock(&h->lock);
}

static const void *no_extension(const sv_host *host, const char *id) {
    v_host *h = host->host_data;
    if (!id) blame(h, "get_extension: id is NULL");
    return NULL;
}

/* The host as `v_open` makes it. */
static void v_host_begin(v_host *host, v_run *run) {
    memset(host, 0, sizeof *host);
    host->run = run;
    (void)pthread_mutex_init(&host->lock, NULL);
    host->api = (sv_host){.size = sizeof host->api,
                          .abi_minor = SV_ABI_MINOR,
                          .host_data = host,
                          .name = "sv_validate",
                          .version = "1",
                          .log = keep_line,
                          .get_extension = no_extension};
}

/* ---- the library */
void v_load(v_run *run, v_subject *s) {
    char why[256];
    memset(s, 0, sizeof *s);
    s->run = run;
    v_where(run, "loading");
    s->library = library_load(run->path, why, sizeof why);
    V_EXPECT(run, s->library, "%s", why);
    s->entry = library_find(s->library, SV_ENTRY_SYMBOL);
    V_EXPECT(run, s->entry, "the library exports no symbol " SV_ENTRY_SYMBOL);
    const rule_sink to = v_sink(run);
    rule_entry(&to, s->entry);
    spy_tell_work(s->entry, &run->report->opencl);
}

static void find_descriptor(v_subject *s) {
    v_where(s->run, "descriptor");
    for (uint32_t i = 0; i < s->entry->count && !s->descriptor; i++) {
        const sv_descriptor *d = s->entry->descriptor(i);
        V_EXPECT(s->run, d && d->size >= sizeof *d && d->id, "descriptor %u is not whole", i);
        if (!s->run->id || strcmp(d->id, s->run->id) == 0) s->descriptor = d;
    }
    V_EXPECT(s->run, s->descriptor, "the library has no plugin with the id '%s'",
             s->run->id ? s->run->id : "");
}

const sv_plugin *v_another(v_subject *s) {
    const sv_plugin *p = NULL;
    v_where(s->run, "create");
    const sv_status status = s->entry->create(&s->host.api, s->descriptor->id, &p);
    V_EXPECT(s->run, status == SV_OK, "create: %s: %s", v_status(status), s->host.line);
    V_EXPECT(s->run, p, "create: SV_OK, and *out is NULL");
    const rule_sink to = v_sink(s->run);
    rule_instance(&to, p);
    return p;
}

static void open_with(v_run *run, v_subject *s, bool bare) {
    v_load(run, s);
    find_descriptor(s);
    v_host_begin(&s->host, run);
    if (bare) s->host.api.log = NULL;
    if (bare) s->host.api.get_extension = NULL;
    s->plugin = v_another(s);
}

void v_open(v_run *run, v_subject *s) {
    open_with(run, s, false);
}

void v_open_bare(v_run *run, v_subject *s) {
    open_with(run, s, true);
}

void v_close(v_subject *s) {
    v_where(s->run, "destroy");
    if (s->plugin) s->plugin->destroy(s->plugin);
    s->plugin = NULL;
    v_where(s->run, "unloading");
    if (s->library) (void)library_close(s->library);
    s->library = NULL;
}

/* ------------------------------------------------------------------------------------------ parameters -- */

static bool is_usable(const sv_param_info *i) {
    return i->id != 0 && i->key && i->label && i->unit && i->help && i->type <= SV_PARAM_ENUM &&
           isfinite(i->min_value) && isfinite(i->max_value) && isfinite(i->default_value) &&
           i->min_value <= i->default_value && i->default_value <= i->max_value &&
           (i->type == SV_PARAM_FLOAT || i->step > 0.0);
}

void v_params_read(v_subject *s, v_params *params) {
    v_where(s->run, "param_count");
    const uint32_t count = s->plugin->param_count(s->plugin);
    params->count = 0;
    for (uint32_t i = 0; i < count && i < V_MAX_PARAMS; i++) {
        sv_param_info info = {.size = sizeof info};
        v_where(s->run, "param_info(%u)", i);
        if (s->plugin->param_info(s->plugin, i, &info) != SV_OK || !is_usable(&info)) continue;
        params->info[params->count++] = info;
    }
    s->run->params = params;
}

uint32_t v_param_values(const sv_param_info *info) {
    if (info->type == SV_PARAM_FLOAT) return 0;
    const double count = floor((info->max_value - info->min_value) / info->step + 0.5) + 1.0;
    return count >= 1.0 && count <= 1e6 ? (uint32_t)count : 0;
}

bool v_param_has(const v_subject *s, const sv_param_info *info, double value) {
    char text[64];
    return info->type != SV_PARAM_ENUM ||
           s->plugin->param_text(s->plugin, info->id, value, text, sizeof text) != SV_ERR_PARAM_RANGE;
}

uint32_t v_param_choice(const v_subject *s, const sv_param_info *info, double *out, uint32_t most) {
    const uint32_t values = v_param_values(info);
    uint32_t count = 0;
    if (values > 0 && values <= most) {
        for (uint32_t n = 0; n < values; n++)
            if (v_param_has(s, info, info->min_value + n * info->step))
                out[count++] = info->min_value + n * info->step;
        return count;
    }
    const uint32_t half = values / 2;
    out[0] = info->min_value;
    out[1] = values > 0 ? info->min_value + (values - 1) * info->step : info->max_value;
    out[2] = values > 0 ? info->min_value + half * info->step : 0.5 * (info->min_value + info->max_value);
    return 3;
}

double v_param_random(const v_subject *s, const sv_param_info *info) {
    v_run *run = s->run;
    const uint32_t values = v_param_values(info), turn = v_random(run, 8);
    if (turn == 0) return info->min_value;
    if (values > 0) {
        const double value = info->min_value + info->step * v_random(run, values);
        return v_param_has(s, info, value) ? value : info->default_value;
    }
    if (turn == 1) return info->max_value;
    return info->min_value + (info->max_value - info->min_value) * v_random_unit(run);
}

double v_param_other(const sv_param_info *info) {
    const uint32_t values = v_param_values(info);
    const double last = values > 0 ? info->min_value + info->step * (values - 1) : info->max_value;
    return info->default_value == info->min_value ? last : info->min_value;
}
