/* SPDX-License-Identifier: MIT */
#include "judge/wall_constant.h"

#include <string.h>

double *wall_constant(sv_wall_settings *s, const char *key) {
    const struct {
        const char *key;
        double *value;
    } all[] = {{"block_mm", &s->block_mm},
               {"beside_mm", &s->beside_mm},
               {"valley", &s->valley},
               {"walled", &s->walled},
               {"parted", &s->parted},
               {"wall_rank", &s->wall_rank},
               {"low_rank", &s->low_rank},
               {"high_rank", &s->high_rank},
               {"sure", &s->sure},
               {"level", &s->level},
               {"first", &s->first},
               {"flank", &s->flank},
               {"one_side", &s->one_side},
               {"skin_mm", &s->skin_mm},
               {"tau_mm", &s->tau_mm},
               {"cut", &s->cut},
               {"left", &s->left},
               {"other", &s->other},
               {"sigma_mm", &s->sigma_mm},
               {"aside_mm", &s->aside_mm},
               {"around_mm", &s->around_mm},
               {"tissue", &s->tissue},
               {"slack", &s->slack},
               {"reach", &s->reach},
               {"q", &s->q},
               {"doubt", &s->doubt},
               {"wall_share", &s->wall_share},
               {"fetus_share", &s->fetus_share},
               {"assumed_wall", &s->assumed_wall},
               {"assumed_spread", &s->assumed_spread}};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if (strcmp(all[i].key, key) == 0) return all[i].value;
    return NULL;
}
