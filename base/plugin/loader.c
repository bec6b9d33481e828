/* SPDX-License-Identifier: MIT */
#include "plugin/loader.h"

#include "core/paths.h"
#include "core/system.h"
#include "core/text.h"
#include "smartvis/lookup.h"
#include "smartvis/open.h"

#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The index-th part of a list that is not empty, or NULL and how many there are. */
static const char *list_part(const char *list, unsigned index, size_t *length, unsigned *count) {
    *count = 0;
    for (const char *at = list; at && *at != '\0';) {
        *length = strcspn(at, sys_list_separator);
        if (*length > 0 && (*count)++ == index) return at;
        at += *length + (at[*length] != '\0');
    }
    return NULL;
}

/* Writes the folder of plugins of the installation that the program belongs to, without the "..". */
static bool own_folder(char *out, size_t bytes) {
    char beside[SYS_PATH];
    if (!hs_path_beside_program("../lib/smartvis", beside, sizeof beside)) return false;
    char *resolved = sys_full_path(beside);
    const int length = resolved ? snprintf(out, bytes, "%s", resolved) : -1;
    free(resolved);
    return length >= 0 && (size_t)length < bytes;
}

/* True for a folder that has its turn later. */
static bool comes_later(const char *folder) {
    const char *const *later = sys_plugin_folders;
    while (*later && strcmp(folder, *later) != 0) later++;
    return *later != NULL;
}

/* The folder of that number, 0 first; false behind the last one. Empty parts of the variable are left out. ""
 * stands for a folder that is not there, or that has its turn later. */
static bool hs_plugin_folder(unsigned index, char *out, size_t bytes) {
    size_t length;
    unsigned listed;
    char list[8 * SYS_PATH];
    const bool set = sys_environment("SMARTVIS_PLUGIN_PATH", list, sizeof list);
    const char *part = list_part(set ? list : NULL, index, &length, &listed);
    if (part) {
        (void)snprintf(out, bytes, "%.*s", (int)(length < SYS_PATH ? length : SYS_PATH), part);
        return true;
    }
    index -= listed;
    if (index == 0) {
        if (!own_folder(out, bytes) || comes_later(out)) out[0] = '\0';
        return true;
    }
    for (unsigned i = 0; i < index; i++)
        if (!sys_plugin_folders[i]) return false;
    (void)snprintf(out, bytes, "%s", sys_plugin_folders[index - 1]);
    return true;
}

/* True, with the path in out, if one of the folders has the file. */
static bool find_in_folders(const char *name, const char *ending, char *out, size_t bytes) {
    char folder[SYS_PATH];
    for (unsigned i = 0; hs_plugin_folder(i, folder, sizeof folder); i++) {
        const int length = snprintf(out, bytes, "%s/%s%s", folder, name, ending);
        if (folder[0] != '\0' && length >= 0 && (size_t)length < bytes && sys_is_file(out)) return true;
    }
    return false;
}

void hs_plugin_find(const char *name, char *out, size_t bytes) {
    const bool as_it_is = name[0] == '\0' || strchr(name, '/') || sys_is_file(name);
    if (!as_it_is &&
        (find_in_folders(name, "", out, bytes) || find_in_folders(name, sys_library_ending, out, bytes)))
        return;
    (void)snprintf(out, bytes, "%s", name);
}

void hs_plugin_default_path(char *out, size_t bytes) {
    char name[32];
    (void)snprintf(name, sizeof name, "smartvis%s", sys_library_ending);
    if (hs_path_beside_program(name, out, bytes) && sys_is_file(out)) return;
    if (find_in_folders(name, "", out, bytes)) return;
    if (!hs_path_beside_program(name, out, bytes)) (void)snprintf(out, bytes, "./%s", name);
}

/* Loading a plugin: library, entry symbol, ABI, instance. Nothing found in the library is trusted
 * unchecked. */

const char *hs_status_name(sv_status status) {
    const char *name = sv_lookup_status(status);
    return name ? name : "unknown status";
}

bool hs_status_is_known(sv_status status) {
    return sv_lookup_status(status) != NULL;
}

bool hs_status_is_success(sv_status status) {
    return status >= SV_OK && hs_status_is_known(status);
}

static const char *severity_name(int32_t severity) {
    static const char *const names[] = {
        "debug", "info", "warning", "error", "host misbehaving", "plugin misbehaving"};
    bool known = severity >= SV_LOG_DEBUG && severity <= SV_LOG_PLUGIN_MISBEHAVING;
    return known ? names[severity] : "log";
}

/* Any thread. */
static void note_complaint(hs_plugin *plugin, const char *text) {
    static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
    (void)pthread_mutex_lock(&lock);
    if (!plugin->complaint[0]) (void)hs_text_escape(plugin->complaint, sizeof plugin->complaint, text, 0);
    (void)pthread_mutex_unlock(&lock);
}

/* sv_host.log: one fprintf a line, so that lines of two threads do not mix. */
static void print_log(const sv_host *host, int32_t severity, const char *text) {
    hs_plugin *plugin = host->host_data;
    char line[2048]; /* one line, whatever the plugin has put into it */
    if (!plugin->instance) (void)hs_text_escape(plugin->line, sizeof plugin->line, text ? text : "", 0);
    if (severity == SV_LOG_PLUGIN_MISBEHAVING) note_complaint(plugin, text ? text : "(null)");
    if (plugin->hears) plugin->hears(plugin->ear, severity, text ? text : "(null)");
    if (severity < plugin->log_level) return;
    (void)fprintf(stderr, "plugin: %s: %s\n", severity_name(severity),
                  hs_text_escape(line, sizeof line, text ? text : "(null)", 0));
}

/* sv_host.get_extension: this host offers none. */
static const void *no_extension(const sv_host *host, const char *id) {
    (void)host;
    (void)id;
    return NULL;
}

/* dlopen of the resolved path: a bare name would be looked up in the system's library folders instead. */
static const sv_entry *open_library(hs_plugin *plugin, const char *name, const hs_call_watch *watch,
                                    hs_error *err) {
    hs_plugin_find(name, plugin->path, sizeof plugin->path);
    const char *path = plugin->path;
    char why[400];
    char *resolved = sys_full_path(path);
    if (!resolved || !sys_is_file(resolved)) {
        const char *trouble = resolved ? "not a file" : strerror(errno);
        (void)hs_fail(err, HS_ERR_PLUGIN, "%s: cannot read the plugin file: %s", path, trouble);
        free(resolved);
        return NULL;
    }
    watch->enter(watch->context, "dlopen");
    const sv_entry *entry = sv_open(resolved, &plugin->library, why, sizeof why);
    free(resolved);
    if (!entry) (void)hs_fail(err, HS_ERR_PLUGIN, "%s: not a library of plugins: %s", path, why);
    return entry;
}

/* abi_major comes first: with another major nothing else in the struct means what this header says. */
static bool check_entry(hs_plugin *plugin, const sv_entry *entry, hs_error *err) {
    if (entry->abi_major != SV_ABI_MAJOR)
        return hs_fail(err, HS_ERR_PLUGIN, "%s: ABI major %u, this host speaks %u", plugin->path,
                       entry->abi_major, SV_ABI_MAJOR);
    if (entry->size < sizeof(sv_entry))
        return hs_fail(err, HS_ERR_PLUGIN, "%s: entry.size is %u, ABI 1.0 has %zu", plugin->path, entry->size,
                       sizeof(sv_entry));
    if (entry->count == 0)
        return hs_fail(err, HS_ERR_PLUGIN, "%s: entry.count is 0: no plugin inside", plugin->path);
    if (entry->count > HS_MAX_PLUGINS)
        return hs_fail(err, HS_ERR_PLUGIN, "%s: entry.count is %u, at most %u plugins are read", plugin->path,
                       entry->count, HS_MAX_PLUGINS);
    if (!entry->descriptor || !entry->create)
        return hs_fail(err, HS_ERR_PLUGIN, "%s: entry.%s is NULL", plugin->path,
                       entry->descriptor ? "create" : "descriptor");
    plugin->abi_major = entry->abi_major;
    plugin->abi_minor = entry->abi_minor;
    return true;
}

static bool read_descriptors(hs_plugin *plugin, const sv_entry *entry, const hs_call_watch *watch,
                             hs_error *err) {
    watch->enter(watch->context, "descriptor");
    for (uint32_t i = 0; i < entry->count; i++) {
        const sv_descriptor *d = entry->descriptor(i);
        if (!d || d->size < sizeof(sv_descriptor) || !d->id || !d->name || !d->vendor || !d->version ||
            !d->summary)
            return hs_fail(err, HS_ERR_PLUGIN, "%s: descriptor %u of %u is missing or incomplete",
                           plugin->path, i, entry->count);
        plugin->descriptor[plugin->count++] = d;
    }
    return true;
}

/* The descriptor of `id`, the first one if id is NULL; a wrong id is answered with the ids there are. */
static const sv_descriptor *find_descriptor(const hs_plugin *plugin, const char *id, hs_error *err) {
    if (!id) return plugin->descriptor[0];
    char known[512] = "";
    size_t used = 0;
    for (uint32_t i = 0; i < plugin->count; i++) {
        const sv_descriptor *d = plugin->descriptor[i];
        if (strcmp(d->id, id) == 0) return d;
        int n = snprintf(known + used, sizeof known - used, "%s%s", i ? ", " : "", d->id);
        if (n < 0 || (size_t)n >= sizeof known - used) break;
        used += (size_t)n;
    }
    (void)hs_fail(err, HS_ERR_PLUGIN, "%s: no plugin with id '%s' (there are: %s)", plugin->path, id, known);
    return NULL;
}

/* "The function pointers are never NULL": checked once here, so that a call is safe everywhere else. */
static bool check_instance(const hs_plugin *plugin, hs_error *err) {
    const sv_plugin *p = plugin->instance;
    if (p->size < sizeof(sv_plugin))
        return hs_fail(err, HS_ERR_PLUGIN, "%s: instance.size is %u, ABI 1.0 has %zu", plugin->path, p->size,
                       sizeof(sv_plugin));
    const char *missing = !p->destroy         ? "destroy"
                          : !p->activate      ? "activate"
                          : !p->deactivate    ? "deactivate"
                          : !p->begin         ? "begin"
                          : !p->slab          ? "slab"
                          : !p->end           ? "end"
                          : !p->adjust        ? "adjust"
                          : !p->param_count   ? "param_count"
                          : !p->param_info    ? "param_info"
                          : !p->param_text    ? "param_text"
                          : !p->last_error    ? "last_error"
                          : !p->get_extension ? "get_extension"
                          : !p->descriptor    ? "descriptor"
                                              : NULL;
    if (missing) return hs_fail(err, HS_ERR_PLUGIN, "%s: instance.%s is NULL", plugin->path, missing);
    return true;
}

static bool create_instance(hs_plugin *plugin, const sv_entry *entry, const char *id,
                            const hs_call_watch *watch, hs_error *err) {
    const sv_descriptor *descriptor = find_descriptor(plugin, id, err);
    if (!descriptor) return false;
    watch->enter(watch->context, "create");
    plugin->host = (sv_host){.size = sizeof(sv_host),
                             .abi_minor = SV_ABI_MINOR,
                             .host_data = plugin,
                             .name = "host_sim",
                             .version = HS_VERSION,
                             .log = print_log,
                             .get_extension = no_extension};
    sv_status status = entry->create(&plugin->host, descriptor->id, &plugin->instance);
    if (status != SV_OK) {
        plugin->instance = NULL; /* by the header it is; a defect there must not become a call through it */
        return hs_fail(err, HS_ERR_PLUGIN, "%s: create '%s': %s (%d)%s%s", plugin->path, descriptor->id,
                       hs_status_name(status), status, plugin->line[0] ? ": " : "", plugin->line);
    }
    if (!plugin->instance)
        return hs_fail(err, HS_ERR_PLUGIN, "%s: create '%s': SV_OK, but no instance", plugin->path,
                       descriptor->id);
    if (check_instance(plugin, err)) return true;
    const sv_plugin *broken = plugin->instance;
    plugin->instance = NULL;
    if (broken->size >= sizeof(sv_plugin) && broken->destroy) broken->destroy(broken);
    return false;
}

bool hs_plugin_open_watched(hs_plugin *plugin, const char *path, const char *id, int32_t log_level,
                            const hs_call_watch *watch, hs_error *err) {
    *plugin = (hs_plugin){.log_level = log_level};
    const sv_entry *entry = open_library(plugin, path, watch, err);
    if (entry && check_entry(plugin, entry, err) && read_descriptors(plugin, entry, watch, err) &&
        create_instance(plugin, entry, id, watch, err))
        return true;
    hs_plugin_close(plugin);
    return false;
}

static void nobody_watches(void *context, const char *call) {
    (void)context;
    (void)call;
}

bool hs_plugin_open(hs_plugin *plugin, const char *path, const char *id, int32_t log_level, hs_error *err) {
    const hs_call_watch nobody = {.enter = nobody_watches};
    return hs_plugin_open_watched(plugin, path, id, log_level, &nobody, err);
}

void hs_plugin_close(hs_plugin *plugin) {
    if (plugin->instance) plugin->instance->destroy(plugin->instance);
    if (plugin->library) sv_close(plugin->library);
    char complaint[sizeof plugin->complaint];
    memcpy(complaint, plugin->complaint, sizeof complaint);
    *plugin = (hs_plugin){0};
    memcpy(plugin->complaint, complaint, sizeof complaint);
}

bool hs_plugin_check(const hs_plugin *plugin, sv_status status, const char *call, hs_error *err) {
    if (hs_status_is_success(status)) return true;
    const char *reason = plugin->instance ? plugin->instance->last_error(plugin->instance) : NULL;
    char line[1024]; /* one line, whatever the plugin has put into it */
    return hs_fail(
        err, HS_ERR_PLUGIN, "%s: %s: %s (%d): %s", plugin->path, call, hs_status_name(status), status,
        hs_text_escape(line, sizeof line, reason && reason[0] ? reason : "the plugin gave no reason", 0));
}
