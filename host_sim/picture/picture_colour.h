/* SPDX-License-Identifier: MIT */
/* The colours of all pictures, 0xRRGGBB, and colour maps. */
#ifndef HS_PICTURE_COLOUR_H
#define HS_PICTURE_COLOUR_H

#include <stdint.h>

#define HS_COLOUR_BACKGROUND 0x1b1d20u
#define HS_COLOUR_TEXT       0xe6e6e6u
#define HS_COLOUR_FAINT_TEXT 0xa9adb3u
#define HS_COLOUR_NO_VALUE   0x34373cu /* no value here */
#define HS_COLOUR_INVALID    0xff00ffu /* a value that should not be there, such as NaN */

/* Viridis, for t in 0 .. 1 (clamped): perceptually uniform, lightness grows with t. */
uint32_t hs_colour_viridis(double t);
/* Blue - white - red, for t in -1 .. 1 (clamped); 0 is white. */
uint32_t hs_colour_diverging(double t);

#endif
