/* SPDX-License-Identifier: MIT */
/* host_sim demo: the scan loop on a few scenes and real volumes, and one page that shows what came of it. */
#ifndef HS_CMD_DEMO_H
#define HS_CMD_DEMO_H

/* argv[0] is the command's own name. Returns the exit code (hs_code, base/error.h). */
int hs_cmd_demo(int argc, char **argv);

#endif
