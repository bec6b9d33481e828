/* SPDX-License-Identifier: MIT */
/* host_sim measure: the quality of depthmaps that were made elsewhere. */
#ifndef HS_CMD_MEASURE_H
#define HS_CMD_MEASURE_H

int hs_cmd_measure(int argc, char **argv);

#endif
