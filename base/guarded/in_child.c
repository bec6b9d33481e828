/* SPDX-License-Identifier: MIT */
#include "guarded/in_child.h"

#include "core/progress.h"
#include "guard/child.h"
#include "plugin/loader.h"

#include <stdio.h>

#define TELL_EVERY_S 0.5

typedef struct {
    bool done;
    char label[60]; /* of what is under way */
} news;

/* A step of what has this label was taken. */
static void tell(const char *label) {
    static double last;
    static news n;
    const double now = hs_now();
    if (!hs_child_is_one() || now - last < TELL_EVERY_S) return;
    last = now;
    if (label) (void)snprintf(n.label, sizeof n.label, "%s", label);
    (void)hs_child_send(hs_child_passed(0), &n, sizeof n);
}

void hs_child_goes_on(void) {
    tell(NULL);
}

static _Noreturn void perform(int (*work)(void *context), void *context) {
    const news end = {.done = true};
    hs_progress_tell(tell);
    const int code = work(context);
    (void)fflush(NULL);
    (void)hs_child_send(hs_child_passed(0), &end, sizeof end);
    hs_child_leave(code);
}

int hs_work_in_child(const hs_guard_options *guard, const char *plugin, const char *doing,
                     int (*work)(void *context), void *context, hs_error *err) {
    const hs_child_limits limits = {.memory_bytes = guard->memory_bytes, .output = HS_CHILD_INHERITED};
    char found[1024], how[128];
    news last = {0}, heard;
    hs_child child;
    hs_child_news what = HS_CHILD_MESSAGE;
    if (hs_child_is_one()) perform(work, context);
    hs_plugin_find(plugin, found, sizeof found);
    if (!hs_guard_wanted(guard, found)) return work(context);
    (void)fflush(NULL);
    if (!hs_child_again(&child, &limits, NULL, 0, err)) return (int)err->code;
    while ((what = hs_child_wait(&child, guard->setup_s)) == HS_CHILD_MESSAGE) {
        if (!hs_child_receive(child.channel, &heard, sizeof heard)) hs_child_kill(&child, HS_CHILD_SILENT, 0);
        last = heard;
    }
    if (what == HS_CHILD_NOTHING) hs_child_kill(&child, HS_CHILD_LATE, guard->setup_s);
    const hs_child_end end = child.end;
    hs_child_close(&child);
    if (end.fate == HS_CHILD_LEFT && last.done) return end.number;
    hs_child_tell(&end, how, sizeof how);
    last.label[sizeof last.label - 1] = '\0';
    (void)hs_fail(err, HS_ERR_PLUGIN, "%s: %s while %s (%s)", found, how, doing,
                  last.label[0] ? last.label : "its first frames");
    return HS_ERR_PLUGIN;
}
