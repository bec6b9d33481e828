/* SPDX-License-Identifier: MIT */
/* What the layer is told, and what it tells: settings, and the log with its rules. */
#include "layer/layer.h"

#include "smartvis/lookup.h"

#include <unistd.h>

/* ---- settings */
char ly_folder[SYS_PATH];
static char settings[4096]; /* the file, a NUL for every end of a line, two at its end */

void ly_read_settings(void) {
    char path[SYS_PATH + 32];
    sys_own_folder(ly_folder, ly_folder, sizeof ly_folder);
    (void)snprintf(path, sizeof path, "%ssmartvis_check.conf", ly_folder);
    const int file = sys_open(path, SYS_READ);
    if (file < 0) return;
    const ssize_t bytes = read(file, settings, sizeof settings - 2);
    (void)close(file);
    for (ssize_t i = 0; i < bytes; i++)
        if (settings[i] == '\n' || settings[i] == '\r') settings[i] = '\0';
}

const char *ly_wrong_line(void) {
    static const char *const known[] = {"SMARTVIS_CHECK=", "SMARTVIS_CHECK_PLUGIN=", "SMARTVIS_CHECK_MS=",
                                        "SMARTVIS_RECORD=", "SMARTVIS_RECORD_OPTIONS="};
    enum { KNOWN = sizeof known / sizeof *known };
    for (const char *line = settings; line < settings + sizeof settings - 2; line += strlen(line) + 1) {
        size_t n = 0;
        while (n < KNOWN && strncmp(line, known[n], strlen(known[n])) != 0) n++;
        if (line[0] && line[0] != '#' && n == KNOWN) return line;
    }
    return NULL;
}

const char *ly_setting(const char *name, char value[LY_VALUE]) {
    const size_t length = strlen(name);
    if (sys_environment(name, value, LY_VALUE)) return value;
    for (const char *line = settings; line < settings + sizeof settings - 2; line += strlen(line) + 1)
        if (strncmp(line, name, length) == 0 && line[length] == '=') return line + length + 1;
    return NULL;
}

bool ly_path(const char *name, char *path, size_t bytes) {
    char of_environment[LY_VALUE];
    const char *value = ly_setting(name, of_environment);
    if (!value) return false;
    const char *from = value == of_environment ? "./" : ly_folder;
    (void)snprintf(path, bytes, "%s%s", sys_is_absolute(value) ? "" : from, value);
    return true;
}

/* ---- the log */
void ly_log(const ly_instance *i, int32_t severity, const char *format, ...) {
    char text[1200];
    va_list args;
    const int used = snprintf(text, sizeof text, "check: ");
    va_start(args, format);
    sva_print(text + used, sizeof text - (size_t)used, format, args);
    va_end(args);
    if (i->record) rec_log(i->record, REC_NOTE, text);
    if (i->silent) return;
    if (i->outer->log)
        i->outer->log(i->outer, severity, text);
    else if (severity >= SV_LOG_WARNING)
        (void)fprintf(stderr, "%s\n", text);
}

static uint32_t hash(const char *text) {
    uint32_t sum = 2166136261u;
    for (; *text; text++) sum = (sum ^ (uint8_t)*text) * 16777619u;
    return sum;
}

/* True once for a mistake; when there is no more room, never. */
static bool is_new(ly_instance *i, const char *why) {
    const uint32_t sum = hash(why);
    for (uint32_t n = 0; n < i->mistake_count; n++)
        if (i->mistakes[n] == sum) return false;
    if (i->mistake_count == LY_MISTAKES) return false;
    i->mistakes[i->mistake_count++] = sum;
    return true;
}

void ly_foretell(ly_instance *i, const char *call, sv_status due, const char *why) {
    if (due != SV_OK && is_new(i, why))
        ly_log(i, SV_LOG_DEBUG, "%s: is passed on as it is, and the plugin owes %s", call,
               sv_lookup_status(due));
}

void ly_doubt(ly_instance *i, rule_name name, const char *call, const char *question) {
    if (is_new(i, question)) ly_log(i, SV_LOG_WARNING, "%s: %s: %s", rules[name].id, call, question);
}

/* ---- broken rules */
/* The first three times, then the 10th, the 100th and so on. */
static bool is_told(uint32_t time) {
    if (time <= 3) return true;
    while (time % 10 == 0) time /= 10;
    return time == 1;
}

void ly_broken_asking(void *instance, rule_name name, const char *text) {
    ly_instance *i = instance;
    const rule *r = &rules[name];
    const int32_t severity = rule_is_hosts(name) ? SV_LOG_HOST_MISBEHAVING : SV_LOG_PLUGIN_MISBEHAVING;
    const uint32_t time = atomic_fetch_add(&i->seen[name], 1) + 1;
    if (i->silent) return;
    if (time == 1)
        ly_log(i, severity, "%s: %s. %s %s", r->id, text, r->what, r->mend);
    else if (is_told(time))
        ly_log(i, severity, "%s: %s (%u times)", r->id, text, time);
}

void ly_broken(void *instance, rule_name name, const char *text) {
    ly_instance *i = instance;
    ly_broken_asking(i, name, text);
    if (i->stops && !i->found) {
        (void)snprintf(i->reason, sizeof i->reason, "%s: %s", rules[name].id, text);
        i->stopped = rule_is_hosts(name) ? SV_ERR_ARGUMENT : SV_ERR_INTERNAL;
    }
    i->found = true;
}
