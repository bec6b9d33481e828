/* SPDX-License-Identifier: MIT */
/* The library under test with one instance of its plugin, and the host that it sees. */
#ifndef DRIVE_SUBJECT_H
#define DRIVE_SUBJECT_H

#include "smartvis_plugin.h"
#include "validate/drive/drive_run.h"

#include <pthread.h>

/* The host that a plugin is given. It keeps the last line of the log, and notes what a plugin must not do. */
typedef struct {
    sv_host api;
    v_run *run;
    pthread_mutex_t lock;
    uint32_t lines;
    int32_t severity; /* of the last line */
    char line[512];
    char fault[256]; /* the first rule that a call to the host broke; "" */
} v_host;

typedef struct {
    v_run *run;
    void *library;
    const sv_entry *entry;
    const sv_descriptor *descriptor; /* of the plugin that was asked for */
    const sv_plugin *plugin;
    v_host host; /* must not move */
} v_subject;

/* dlopen and the entry; fails if it cannot be loaded or the entry cannot be used. Names no descriptor. */
void v_load(v_run *run, v_subject *s);

/* The same and an instance, whole enough to be called. `bare`: the host has no log and no extensions. */
void v_open(v_run *run, v_subject *s);
void v_open_bare(v_run *run, v_subject *s);

/* Another instance of the plugin, of the same host. */
const sv_plugin *v_another(v_subject *s);

/* destroy and dlclose. */
void v_close(v_subject *s);

/* The host as `v_open` makes it. */
void v_host_begin(v_host *host, v_run *run);

/* 1 if `text` is UTF-8 of at most `most` bytes without control characters. */
bool v_is_text(const char *text, size_t most);

/* A status with its name, "SV_ERR_STATE (-20)", in one of a few buffers that are used in turn. */
const char *v_status(sv_status status);

#endif
