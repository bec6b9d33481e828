/* SPDX-License-Identifier: MIT */
/* host_sim list: what a plugin library holds and which parameters its plugins have, from the ABI alone. */
#ifndef HS_CMD_LIST_H
#define HS_CMD_LIST_H

/* argv[0] is the command's own name. Returns the exit code (hs_code, base/error.h). */
int hs_cmd_list(int argc, char **argv);

#endif
