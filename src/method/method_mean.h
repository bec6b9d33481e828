/* SPDX-License-Identifier: MIT */
#ifndef SV_METHOD_MEAN_H
#define SV_METHOD_MEAN_H

#include "method/method.h"

extern const sv_method sv_method_mean;

#endif
