/* SPDX-License-Identifier: MIT */
#include "scene/scene_level.h"

#include <pthread.h>

float hs_level_amplitude_table[HS_LEVEL_MAX - HS_LEVEL_SILENT + 1];

float hs_level_mantissa_table[1024];

static void make_tables(void) {
    for (int i = 0; i <= HS_LEVEL_MAX - HS_LEVEL_SILENT; i++)
        hs_level_amplitude_table[i] =
            i == 0 ? 0.0f : (float)pow(10.0, (double)(i + HS_LEVEL_SILENT) / (20.0 * HS_LEVEL_ONE));
    for (int i = 0; i < 1024; i++)
        hs_level_mantissa_table[i] = (float)(10.0 * HS_LEVEL_ONE * log10(1.0 + ((double)i + 0.5) / 1024.0));
}

static pthread_once_t once = PTHREAD_ONCE_INIT;

void hs_level_tables(void) {
    pthread_once(&once, make_tables);
}
