/* SPDX-License-Identifier: MIT */
/* The library: settings, the other library, and the life of an instance. */
#include "layer/layer.h"

#include "smartvis/open.h"
#include "sv_version.h"

#include <pthread.h>

/* ---- the other library */
static pthread_once_t once = PTHREAD_ONCE_INIT;
static void *library;
static const sv_entry *inner; /* NULL: there is none, and `trouble` says why */
static char trouble[SYS_PATH + 300];
static enum { OFF, ON, STOP } mode = ON;
static double slow_ms = 1000.0;

static void refuse(const char *format, const char *first, const char *second) {
    inner = NULL;
    (void)snprintf(trouble, sizeof trouble, format, first, second ? second : "");
}

static int32_t trouble_severity = SV_LOG_ERROR;

static void note_trouble(void *context, rule_name name, const char *text) {
    char words[300];
    (void)snprintf(words, sizeof words, "%s. %s %s", text, rules[name].what, rules[name].mend);
    refuse(context, rules[name].id, words);
    trouble_severity = SV_LOG_PLUGIN_MISBEHAVING;
}

static void read_mode(void) {
    char value[2][LY_VALUE];
    const char *said = ly_setting("SMARTVIS_CHECK", value[0]),
               *ms = ly_setting("SMARTVIS_CHECK_MS", value[1]);
    const char *wrong = ly_wrong_line();
    char *end = NULL;
    if (wrong) refuse("check: smartvis_check.conf: '%.100s' is no setting", wrong, NULL);
    if (said && strcmp(said, "off") == 0)
        mode = OFF;
    else if (said && strcmp(said, "stop") == 0)
        mode = STOP;
    else if (said && strcmp(said, "on") != 0)
        refuse("check: SMARTVIS_CHECK is '%.60s', expected off, on or stop", said, NULL);
    if (!ms) return;
    slow_ms = strtod(ms, &end);
    if (end == ms || *end || !(slow_ms > 0.0 && slow_ms < 1e9))
        refuse("check: SMARTVIS_CHECK_MS is '%.60s', expected milliseconds above 0", ms, NULL);
}

/* What the host reads without a check of its own must be there; the rest is told at create. */
static void load(void) {
    static char unusable[] = "check: %s: %s";
    const rule_sink to = {note_trouble, unusable};
    char path[2 * SYS_PATH], why[1000];
    ly_read_settings();
    if (!ly_path("SMARTVIS_CHECK_PLUGIN", path, sizeof path)) {
        (void)snprintf(path, sizeof path, "%ssmartvis%s", ly_folder, sys_library_ending);
        /* An installation has the layer in a folder of its own, so that a host's list of plugins has none. */
        if (!sys_is_file(path))
            (void)snprintf(path, sizeof path, "%s../smartvis%s", ly_folder, sys_library_ending);
    }
    inner = sv_open(path, &library, why, sizeof why);
    if (!inner)
        refuse("check: SMARTVIS_CHECK_PLUGIN: %.1000s", why, NULL);
    else if (inner == &smartvis_plugin_entry) {
        sv_close(library); /* it could not be unloaded while it holds itself */
        library = NULL;
        refuse("check: SMARTVIS_CHECK_PLUGIN: %.1000s is the layer itself", path, NULL);
    } else
        rule_entry(&to, inner);
    const sv_descriptor *d = inner ? inner->descriptor(0) : NULL;
    if (inner && (!d || d->size < sizeof *d || !d->id || !d->extensions))
        note_trouble(unusable, RULE_descriptors, "descriptor 0: size, id or extensions is not there");
    read_mode();
}

__attribute__((destructor)) static void unload(void) {
    sys_close_when_unloaded(library);
}

/* ---- the log */
/* What the plugin is given as its host. */
static void SV_CALL pass_log(const sv_host *host, int32_t severity, const char *text) {
    ly_instance *i = host->host_data;
    if (severity < SV_LOG_DEBUG || severity > SV_LOG_PLUGIN_MISBEHAVING)
        rule_tell(&i->asked, RULE_host_callbacks, "log: severity is %d, expected 0 to 5", (int)severity);
    if (!text) rule_tell(&i->asked, RULE_host_callbacks, "log: text is NULL");
    if (atomic_fetch_add(&i->lines, 1) == LY_MANY_LINES)
        rule_tell(&i->asked, RULE_host_callbacks, "log: more than %d lines in one call", LY_MANY_LINES);
    if (i->record && text) rec_log(i->record, severity, text);
    if (i->outer->log) i->outer->log(i->outer, severity, text);
}

static const void *SV_CALL pass_extension(const sv_host *host, const char *id) {
    ly_instance *i = host->host_data;
    if (!id) rule_tell(&i->asked, RULE_host_callbacks, "get_extension: id is NULL");
    return i->outer->get_extension(i->outer, id);
}

/* ---- parameters */
/* Names of an enum's values: NULL for one that it leaves out. */
static const char *const *read_names(const sv_plugin *p, const sv_param_info *info) {
    enum { MAX_NAMES = 64 };
    const double count = info->step > 0.0 ? (info->max_value - info->min_value) / info->step + 1.0 : 0.0;
    char text[64];
    if (info->type != SV_PARAM_ENUM || !(count >= 1.0 && count <= MAX_NAMES)) return NULL;
    const char **names = calloc((size_t)count, sizeof *names);
    for (uint32_t n = 0; names && n < (uint32_t)count; n++)
        if (p->param_text(p, info->id, info->min_value + n * info->step, text, sizeof text) !=
            SV_ERR_PARAM_RANGE)
            names[n] = info->key;
    return names;
}

/* What the shadow logs to: its words are told with their rule. */
static const sv_host silent = {0};

static bool describe(ly_instance *i) {
    const sv_plugin *p = i->inner;
    const uint32_t told = p->param_count(p), count = told < RULE_MAX_PARAMS ? told : RULE_MAX_PARAMS;
    i->described = calloc(1, sizeof *i->described);
    i->params = calloc(count + 1, sizeof *i->params);
    i->values = calloc(3 * (size_t)count + 1, sizeof *i->values);
    if (!i->described || !i->params || !i->values) return false;
    i->described->count = count;
    for (uint32_t n = 0; n < count; n++) {
        sv_param_info *info = &i->described->info[n];
        info->size = sizeof *info;
        (void)p->param_info(p, n, info);
        i->params[n] = (sva_param){.id = info->id,
                                   .type = info->type,
                                   .flags = info->flags,
                                   .key = info->key ? info->key : "",
                                   .min_value = info->min_value,
                                   .max_value = info->max_value,
                                   .default_value = info->default_value,
                                   .step = info->step,
                                   .names = read_names(p, info)};
    }
    rule_param_ids(&i->called, i->described, told);
    rule_param_strings(&i->called, i->described);
    rule_param_ranges(&i->called, i->described);
    rule_param_dependencies(&i->called, i->described);
    rule_param_flags(&i->called, i->described, p->descriptor);
    i->method = (sva_method){.descriptor = p->descriptor, .params = i->params, .param_count = count};
    i->shadow = (sva){.method = &i->method,
                      .host = &silent,
                      .values = i->values,
                      .framed = i->values + count,
                      .fixed = i->values + 2 * (size_t)count};
    return true;
}

/* ---- create, destroy */
static void release(ly_instance *i) {
    rec_close(i->record);
    for (uint32_t n = 0; i->params && n < i->method.param_count; n++)
        free((void *)(uintptr_t)i->params[n].names);
    free(i->described);
    free(i->params);
    free(i->values);
    free(i);
}

static void SV_CALL ly_destroy(const sv_plugin *plugin) {
    ly_instance *i = (ly_instance *)(uintptr_t)plugin;
    char text[400];
    size_t used = 0;
    int32_t severity = SV_LOG_PLUGIN_MISBEHAVING;
    if (!i) return;
    if (atomic_flag_test_and_set(&i->busy)) { /* the other call needs it */
        rule_tell(&i->asked, RULE_host_threads,
                  "destroy: comes while another call of this instance is under way");
        return;
    }
    (void)ly_due_host(i, &(rc_call){.kind = RC_DESTROY});
    ly_watch_close(i->watch);
    if (i->record)
        rec_before(i->record, &(rc_call){.kind = RC_DESTROY, .plugin = i->inner, .start_ns = ly_now()});
    i->inner->destroy(i->inner);
    for (int n = 0; n < RULE_COUNT && used < sizeof text - 60; n++) {
        const uint32_t times = atomic_load(&i->seen[n]);
        if (times == 0) continue;
        used += (size_t)snprintf(text + used, sizeof text - used, "%s%s %u", used ? ", " : "", rules[n].id,
                                 times);
        if (rule_is_hosts((rule_name)n)) severity = SV_LOG_HOST_MISBEHAVING;
    }
    if (used) ly_log(i, severity, "rules that were broken, and how often: %s", text);
    release(i);
}

static void check_host(const rule_sink *to, const sv_host *h) {
    RULE_EXPECT(to, RULE_host_create, h->name && h->version, "create: host.%s is NULL",
                h->name ? "version" : "name");
    RULE_EXPECT(to, RULE_host_create,
                rule_is_text(h->name, RULE_MAX_TEXT) && rule_is_text(h->version, RULE_MAX_TEXT),
                "create: host.name or host.version is not UTF-8 text");
}

/* The recording that is asked for: of the first instance FILE, of the others FILE.2 and so on. */
static rec *open_record(const sv_host *host) {
    static atomic_uint instances;
    char path[2 * SYS_PATH], options[LY_VALUE], error[2 * SYS_PATH + 200];
    if (!ly_path("SMARTVIS_RECORD", path, sizeof path - 16)) return NULL;
    const uint32_t number = atomic_fetch_add(&instances, 1) + 1;
    if (number > 1) (void)snprintf(path + strlen(path), 16, ".%u", number);
    rec *record = rec_open(path, ly_setting("SMARTVIS_RECORD_OPTIONS", options), error, sizeof error);
    if (!record && host->log) host->log(host, SV_LOG_WARNING, error);
    return record;
}

/* An instance with nothing behind it yet. */
static ly_instance *prepare(const sv_host *host) {
    ly_instance *i = calloc(1, sizeof *i);
    if (!i) return NULL;
    i->outer = host;
    i->silent = mode == OFF;
    i->stops = mode == STOP;
    i->record = open_record(host);
    i->slow_ns = (uint64_t)(slow_ms * 1e6);
    i->called = (rule_sink){ly_broken, i};
    i->asked = (rule_sink){ly_broken_asking, i};
    atomic_flag_clear(&i->busy);
    i->host = (sv_host){sizeof i->host,
                        host->abi_minor,
                        i,
                        host->name,
                        host->version,
                        host->log || i->record ? pass_log : NULL,
                        host->get_extension ? pass_extension : NULL};
    return i;
}

/* Keeps what the library tells of the plugin with this id. False if there is none. */
static bool keep_descriptor(ly_instance *i, const char *id) {
    for (uint32_t n = 0; n < inner->count && n < RULE_MAX_PLUGINS; n++) {
        const sv_descriptor *d = inner->descriptor(n);
        if (!d || !d->id || strcmp(d->id, id) != 0) continue;
        i->told = *d;
        return true;
    }
    rule_tell(&i->called, RULE_host_create, "create: id is \"%.60s\", and no descriptor has it", id);
    return false;
}

/* The plugin's instance, or NULL; it may be of no use yet. */
static const sv_plugin *call_create(ly_instance *i, const char *id, rc_call *c) {
    const rule_sink *to = &i->called;
    const sv_plugin *const untouched = &i->api; /* neither an instance nor NULL */
    const sv_plugin *p = untouched;
    if (i->record) rec_before(i->record, c);
    c->status = inner->create(&i->host, id, &p);
    c->took_ns = ly_now() - c->start_ns;
    if (c->status != SV_OK && p)
        rule_tell(to, RULE_create_refusals, "create: returns %d, and *out is not NULL", (int)c->status);
    if (c->status != SV_OK) return NULL;
    if (!p || p == untouched) {
        rule_tell(to, RULE_instance_whole, "create: returns SV_OK, and *out is %s", p ? "as it was" : "NULL");
        return NULL;
    }
    return p;
}

/* The same, judged. What cannot be used is gone then. */
static const sv_plugin *create_inner(ly_instance *i, const char *id, sv_status *status) {
    rc_call c = {.kind = RC_CREATE, .start_ns = ly_now()};
    rule_descriptors(&i->called, inner);
    const bool known = keep_descriptor(i, id);
    const sv_plugin *p = call_create(i, id, &c);
    *status = c.status;
    if (c.status != SV_OK) return NULL;
    if (p) rule_instance(&i->called, p);
    if (!p || atomic_load(&i->seen[RULE_instance_whole]) > 0) {
        if (p && p->size >= sizeof *p && p->destroy) p->destroy(p);
        *status = SV_ERR_INTERNAL;
        return NULL;
    }
    c.plugin = p;
    if (i->record) rec_after(i->record, &c);
    if (known) return p;
    i->told = *p->descriptor;
    rule_tell(&i->called, RULE_create_refusals,
              "create: returns SV_OK for the id \"%.60s\", which no descriptor has", id);
    return p;
}

static sv_status create_checked(const sv_host *host, const char *id, const sv_plugin **out) {
    sv_status status = SV_ERR_NO_MEMORY;
    ly_instance *i = prepare(host);
    if (!i) return status;
    ly_log(i, SV_LOG_INFO, "SmartVis checking layer %s", SV_VERSION);
    check_host(&i->called, host);
    i->inner = create_inner(i, id, &status);
    if (i->inner && !describe(i)) status = SV_ERR_NO_MEMORY;
    if (i->inner && status == SV_OK && i->stopped != SV_OK) status = i->stopped;
    if (!i->inner || status != SV_OK) {
        if (i->inner) i->inner->destroy(i->inner);
        release(i);
        return status;
    }
    i->api = *i->inner;
    i->api.size = sizeof i->api;
    i->api.plugin_data = i;
    i->api.destroy = ly_destroy;
    ly_fill_calls(i);
    ly_fill_extensions(i);
    *out = &i->api;
    return SV_OK;
}

/* ---- the entry */
static const char *const no_extensions[] = {NULL};
static const sv_descriptor nobody = {sizeof(sv_descriptor),
                                     SV_BIT(SV_CARRIER_HOST),
                                     "org.smartvis.check",
                                     "SmartVis checking layer",
                                     "SmartVis",
                                     SV_VERSION,
                                     trouble,
                                     SV_BIT(SV_VOXEL_U8),
                                     SV_QUEUE_OWN,
                                     0,
                                     0,
                                     no_extensions};

static const sv_descriptor *SV_CALL ly_descriptor(uint32_t index) {
    (void)pthread_once(&once, load);
    if (index != 0) return NULL;
    return inner ? inner->descriptor(0) : &nobody;
}

static sv_status SV_CALL ly_create(const sv_host *host, const char *id, const sv_plugin **out) {
    char value[LY_VALUE];
    (void)pthread_once(&once, load);
    if (out) *out = NULL;
    if (inner && mode == OFF && !ly_setting("SMARTVIS_RECORD", value)) return inner->create(host, id, out);
    if (!host || !id || !out) return SV_ERR_ARGUMENT;
    if (host->size < sizeof *host) return SV_ERR_SIZE;
    if (inner) return create_checked(host, id, out);
    if (strcmp(id, nobody.id) != 0) return SV_ERR_UNKNOWN_ID;
    if (host->log) host->log(host, trouble_severity, trouble);
    return SV_ERR_INTERNAL;
}

const sv_entry smartvis_plugin_entry = {SV_ABI_MAJOR,  SV_ABI_MINOR, sizeof(sv_entry), 1,
                                        ly_descriptor, ly_create};
