/* SPDX-License-Identifier: MIT */
/* host_sim info: what a MetaImage volume is, as the simulator sees it. */
#ifndef HS_CMD_INFO_H
#define HS_CMD_INFO_H

/* argv[0] is the command's own name. Returns the exit code (hs_code, base/error.h). */
int hs_cmd_info(int argc, char **argv);

#endif
