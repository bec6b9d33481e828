/* SPDX-License-Identifier: MIT */
#ifndef SV_METHOD_MEMBRANE_H
#define SV_METHOD_MEMBRANE_H

#include "method/method.h"

extern const sv_method sv_method_membrane;

#endif
