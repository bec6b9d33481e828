/* SPDX-License-Identifier: MIT */
#ifndef SV_METHOD_COST_H
#define SV_METHOD_COST_H

#include "method/method.h"

extern const sv_method sv_method_cost;

#endif
