/* SPDX-License-Identifier: MIT */
/* The commands of the simulator, for main. argv[0] is a command's own name. Each returns the exit code
 * (hs_code, base/error.h). */
#pragma once

int hs_cmd_run(int argc, char **argv);
int hs_cmd_scene(int argc, char **argv);
int hs_cmd_list(int argc, char **argv);
int hs_cmd_prepare(int argc, char **argv);
int hs_cmd_info(int argc, char **argv);
