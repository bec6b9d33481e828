/* SPDX-License-Identifier: MIT */
/* host_sim scenes: lists, generates, exports and shows the synthetic scenes. */
#ifndef HS_CMD_SCENE_H
#define HS_CMD_SCENE_H

/* argv[0] is the command's own name. Returns the exit code (hs_code, base/error.h). */
int hs_cmd_scene(int argc, char **argv);

#endif
