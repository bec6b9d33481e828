/* SPDX-License-Identifier: MIT */
/* A message of a console's page of any bytes: what is accepted is within its limits, what is not is
 * explained. */
#include "console/console.h"
#include "fuzz/fuzz_target.h"

#include <math.h>
#include <string.h>

static void check_lane(const hs_console_lane *lane) {
    FUZZ_HOLDS(lane->count <= HS_CONSOLE_VALUES && lane->plugin <= 255);
    for (uint32_t i = 0; i < lane->count; i++) {
        const size_t length = strnlen(lane->values[i].key, HS_CONSOLE_KEY);
        FUZZ_HOLDS(length > 0 && length < HS_CONSOLE_KEY);
        FUZZ_HOLDS(isfinite(lane->values[i].value));
    }
}

static void check_state(const hs_console_state *s) {
    hs_error err = {0};
    const bool scene = s->source.scene[0] != '\0';
    FUZZ_HOLDS(strnlen(s->source.scene, sizeof s->source.scene) < sizeof s->source.scene);
    FUZZ_HOLDS(strnlen(s->source.path, sizeof s->source.path) < sizeof s->source.path);
    FUZZ_HOLDS(scene != (s->source.path[0] != '\0'));
    FUZZ_HOLDS(!scene || (s->source.size >= 32 && s->source.size <= 256 && s->source.volumes <= 16));
    FUZZ_HOLDS(s->source.from >= HS_FROM_PROBE && s->source.from < HS_FROM_COUNT);
    FUZZ_HOLDS(isfinite(s->yaw) && fabs(s->pitch) <= 90 && s->zoom > 0);
    FUZZ_HOLDS(s->views < 1u << HS_CONSOLE_VIEWS);
    FUZZ_HOLDS(s->picture >= 16 && s->picture <= HS_CONSOLE_PICTURE && s->draft >= 16 &&
               s->draft <= HS_CONSOLE_PICTURE);
    FUZZ_HOLDS(s->speed > 0);
    for (int k = 0; k < 3; k++) FUZZ_HOLDS(s->cross[k] >= 0 && s->cross[k] <= 1);
    FUZZ_HOLDS(hs_dvr_check_settings(&s->dvr, &err));
    FUZZ_HOLDS(s->lane[0].used);
    for (int i = 0; i < HS_CONSOLE_LANES; i++) check_lane(&s->lane[i]);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    hs_console_message message;
    hs_error err = {0};
    if (!hs_console_message_read((const char *)data, size, &message, &err)) {
        FUZZ_HOLDS(err.code != HS_OK && err.text[0]);
        return 0;
    }
    FUZZ_HOLDS(size <= HS_CONSOLE_MAX_MESSAGE);
    if (message.says == HS_CONSOLE_SAYS_STATE) check_state(&message.state);
    FUZZ_HOLDS(message.view >= HS_CONSOLE_RESULT && message.view < HS_CONSOLE_VIEWS);
    return 0;
}
