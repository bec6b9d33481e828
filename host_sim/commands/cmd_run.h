/* SPDX-License-Identifier: MIT */
/* host_sim run: the scan loop on a volume or a scene, with a table of times and pictures. */
#ifndef HS_CMD_RUN_H
#define HS_CMD_RUN_H

/* argv[0] is the command's own name. Returns the exit code (hs_code, base/error.h). */
int hs_cmd_run(int argc, char **argv);

#endif
