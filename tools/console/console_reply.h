/* SPDX-License-Identifier: MIT */
/* What the console tells a page, as JSON: docs/console.md has the fields. Every function returns a text that
 * the caller frees, or NULL without memory. */
#ifndef HS_CONSOLE_REPLY_H
#define HS_CONSOLE_REPLY_H

#include "console/console_stage.h"
#include "result/result_write.h"

/* What there is to choose from: scenes, files, plugins, stages. */
char *hs_console_reply_hello(const hs_console_offers *offers, const hs_console_files *files);

/* The parameters of a lane's plugin, as it describes them; their values are not among them. */
char *hs_console_reply_plugin(const hs_console_stage *stage, uint32_t lane);

/* A frame, behind its pictures. */
typedef struct {
    uint64_t frame;    /* counted by the console */
    uint32_t pictures; /* that came before */
    double draw_ms, encode_ms, all_ms;
} hs_console_shown;
char *hs_console_reply_frame(const hs_console_stage *stage, const hs_console_shown *shown);

/* A frame that was not drawn: the page need not wait for it. */
char *hs_console_reply_skipped(uint64_t frame);

/* "refused" or "busy" with a text for a person, "written" with the folder. */
char *hs_console_reply_text(const char *type, const char *text);
char *hs_console_reply_written(const char *folder, const hs_result_report *report);

#endif
