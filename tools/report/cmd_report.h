/* SPDX-License-Identifier: MIT */
/* host_sim report: quality and speed of a plugin over all cases and its parameter space, with a page. */
#ifndef HS_CMD_REPORT_H
#define HS_CMD_REPORT_H

/* argv[0] is the command's own name. Returns the exit code (hs_code, base/error.h). */
int hs_cmd_report(int argc, char **argv);

#endif
