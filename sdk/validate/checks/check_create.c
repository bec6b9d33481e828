/* SPDX-License-Identifier: MIT */
/* Checks of instances and of how a plugin treats its host and its process. */
#include "validate/checks/check.h"

#include "core/system.h"
#include "validate/drive/process.h"
#include "validate/spy/cl_spy.h"

#include <fenv.h>
#include <inttypes.h>
#include <locale.h>
#include <sys/stat.h>
#include <unistd.h>

void check_instance_whole(v_run *run) {
    v_subject s;
    v_open(run, &s);
    const sv_plugin *more[4];
    for (int i = 0; i < 4; i++) more[i] = v_another(&s);
    for (int i = 0; i < 4; i++) {
        V_EXPECT(run, more[i] != s.plugin, "create gives the same instance twice");
        v_where(run, "destroy of an instance that was never active");
        more[i]->destroy(more[i]);
    }
    V_EXPECT(run, s.plugin->last_error(s.plugin), "last_error is NULL");
    v_where(run, "destroy of an instance that was never active");
    s.plugin->destroy(s.plugin); /* unloading is a check of its own */
}

/* create with these arguments fails with `expected`, and leaves nothing behind. */
static void refuse(v_subject *s, const char *what, const sv_host *host, const char *id, sv_status expected) {
    const sv_plugin *out = s->plugin;
    v_where(s->run, "create with %s", what);
    const sv_status status = s->entry->create(host, id, &out);
    V_EXPECT(s->run, status == expected, "create with %s: %s, expected %s", what, v_status(status),
             v_status(expected));
    V_EXPECT(s->run, !out, "create with %s fails, and *out is not NULL", what);
}

void check_create_refusals(v_run *run) {
    char longer[300];
    v_subject *s = &v_rig_open(run)->s;
    const char *id = s->descriptor->id;
    (void)snprintf(longer, sizeof longer, "%s.more", id);
    refuse(s, "an unknown id", &s->host.api, "org.smartvis.validator.nobody", SV_ERR_UNKNOWN_ID);
    refuse(s, "an empty id", &s->host.api, "", SV_ERR_UNKNOWN_ID);
    refuse(s, "its id and more", &s->host.api, longer, SV_ERR_UNKNOWN_ID);
    longer[strlen(id) > 1 ? strlen(id) - 1 : 0] = '\0';
    refuse(s, "its id cut short", &s->host.api, longer, SV_ERR_UNKNOWN_ID);
    refuse(s, "a host that is NULL", NULL, id, SV_ERR_ARGUMENT);
    refuse(s, "an id that is NULL", &s->host.api, NULL, SV_ERR_ARGUMENT);
    v_where(run, "create with out NULL");
    const sv_status status = s->entry->create(&s->host.api, id, NULL);
    V_EXPECT(run, status == SV_ERR_ARGUMENT, "create with out NULL: %s, expected SV_ERR_ARGUMENT",
             v_status(status));
    sv_host old = s->host.api;
    old.size = 8;
    refuse(s, "a host of 8 bytes", &old, id, SV_ERR_SIZE);
}

void check_create_without_opencl(v_run *run) {
    v_subject first_of_all, s;
    v_load(run, &first_of_all); /* it stays: the library lies where it lay */
    spy_watch(first_of_all.entry);
    v_open(run, &s);
    uint32_t calls = 0;
    const char *first = "";
    for (int kind = 0; kind < SPY_KINDS; kind++) {
        if (spy_count((spy_kind)kind) > 0) first = spy_first((spy_kind)kind);
        calls += spy_count((spy_kind)kind);
    }
    V_EXPECT(run, calls == 0, "create calls OpenCL: %s", first);
    v_close(&s);
}

/* ---- extensions */
static const void *ask(v_subject *s, const char *id) {
    v_where(s->run, "get_extension(\"%.100s\")", id);
    return s->plugin->get_extension(s->plugin, id);
}

void check_extensions(v_run *run) {
    char id[300];
    v_subject *s = &v_rig_open(run)->s;
    V_EXPECT(run, !ask(s, "smartvis.validator.no-such-thing/1"),
             "get_extension knows an id that nobody made up");
    V_EXPECT(run, !ask(s, ""), "get_extension knows the empty id");
    for (uint32_t i = 0; s->descriptor->extensions[i]; i++) {
        const char *known = s->descriptor->extensions[i];
        const void *table = ask(s, known);
        V_EXPECT(run, table == ask(s, known), "get_extension(\"%s\") gives another table every time", known);
        (void)snprintf(id, sizeof id, "%s0", known);
        V_EXPECT(run, !ask(s, id), "get_extension knows \"%s\", of another revision than it announces", id);
        uint32_t size = 0;
        if (table) memcpy(&size, table, sizeof size);
        V_EXPECT(run, !table || (size >= 8 && size <= 65536), "the table of \"%s\" has the size %u", known,
                 size);
    }
}

/* ---- the host */
enum { MAX_LOGGED = 1 << 18 }; /* bytes: a guard shows less of a single frame */

/* What makes a plugin speak: refused calls, and a frame. */
static void provoke(v_rig *r) {
    const sv_plugin *p = r->s.plugin;
    const stage_way way = v_standard_way(&r->s);
    const sv_param_value unknown = {.id = 0xfffffff0u};
    v_where(r->s.run, "calls in the wrong state");
    (void)p->activate(p, NULL);
    p->deactivate(p);
    v_rig_set(r, &way, V_LAYERS);
    (void)v_begin(p, &r->stage, &unknown, 1);
    (void)v_slab(p, &r->stage, 0);
    (void)v_end(p, &r->stage);
    (void)v_rig_frame(r, NULL, 0);
    (void)v_adjust(p, &r->stage, NULL, 0);
    v_where(r->s.run, "param_text of an unknown id");
    char text[32];
    (void)p->param_text(p, 0xfffffff0u, 0.0, text, sizeof text);
}

void check_bare_host(v_run *run) {
    provoke(v_rig_open_bare(run));
}

void check_host_callbacks(v_run *run) {
    v_rig *r = v_rig_open(run);
    const sv_host before = r->s.host.api;
    provoke(r);
    V_EXPECT(run, !r->s.host.fault[0], "%s", r->s.host.fault);
    V_EXPECT(run, memcmp(&before, &r->s.host.api, sizeof before) == 0, "the plugin writes into sv_host");
    V_EXPECT(run, r->s.host.bytes <= MAX_LOGGED,
             "%u lines and %" PRIu64 " bytes went to the log in few calls", r->s.host.lines, r->s.host.bytes);
    if (r->s.host.lines == 0) v_warn(run, "calls were refused, and no line went to the host's log");
    if (!rule_is_text(r->s.host.line, sizeof r->s.host.line))
        v_warn(run, "a line of the log has control characters or is no UTF-8");
}

/* ---- the process */
typedef struct {
    char locale[512], folder[1024];
    int rounding;
    mode_t mask;
} process_state;

static void read_process_state(process_state *w) {
    memset(w, 0, sizeof *w);
    (void)snprintf(w->locale, sizeof w->locale, "%s", setlocale(LC_ALL, NULL));
    if (!getcwd(w->folder, sizeof w->folder)) w->folder[0] = '\0';
    w->rounding = fegetround();
    w->mask = (mode_t)umask(0);
    (void)umask(w->mask);
}

void check_process_untouched(v_run *run) {
    process_state before, after;
    struct stat said = {0};
    /* Standard output goes to memory meanwhile. */
    (void)fflush(stdout);
    const int output = dup(STDOUT_FILENO), memory = sys_temporary();
    const bool caught = output >= 0 && memory >= 0 && dup2(memory, STDOUT_FILENO) >= 0;
    read_process_state(&before);
    run->watch = v_watch_begin();
    V_EXPECT(run, run->watch, "no memory for a file: the check could not be made");
    v_rig *r = v_rig_open(run);
    provoke(r);
    const char *const handler = v_process_handler(library_range_of(r->s.entry));
    v_rig_close(r);
    v_where(run, "the check itself");
    run->watch = NULL;
    read_process_state(&after);
    (void)fflush(stdout);
    if (caught) (void)(fstat(memory, &said) + dup2(output, STDOUT_FILENO));
    V_EXPECT(run, caught, "no temporary file: the standard output could not be watched");
    V_EXPECT(run, strcmp(before.locale, after.locale) == 0, "the plugin changes the locale to %.100s",
             after.locale);
    V_EXPECT(run, before.rounding == after.rounding, "the plugin leaves another rounding mode behind: %d",
             after.rounding);
    V_EXPECT(run, strcmp(before.folder, after.folder) == 0, "the plugin changes the working folder");
    V_EXPECT(run, before.mask == after.mask, "the plugin changes the umask");
    V_EXPECT(run, !handler, "the plugin handles a signal: %s", handler);
    V_EXPECT(run, said.st_size == 0, "the plugin prints %lld bytes to the standard output",
             (long long)said.st_size);
}
