/* SPDX-License-Identifier: MIT */
/* host_sim console: the scan loop on a web page, live. */
#ifndef HS_CMD_CONSOLE_H
#define HS_CMD_CONSOLE_H

/* argv[0] is the command's own name. Returns the exit code (hs_code, base/error.h). */
int hs_cmd_console(int argc, char **argv);

#endif
