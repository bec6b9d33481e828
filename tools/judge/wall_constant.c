/* SPDX-License-Identifier: MIT */
#include "judge/wall_constant.h"

#include <string.h>

double *wall_constant(sv_wall_settings *s, const char *key) {
    const struct {
        const char *key;
        double *value;
    } all[] = {{"block_mm", &s->block_mm},
               {"dilation_mm", &s->dilation_mm},
               {"valley", &s->valley},
               {"clear_wall_share", &s->clear_wall_share},
               {"separability", &s->separability},
               {"wall_rank", &s->wall_rank},
               {"low_rank", &s->low_rank},
               {"high_rank", &s->high_rank},
               {"slope", &s->slope},
               {"fetus_level", &s->fetus_level},
               {"first_run_extra", &s->first_run_extra},
               {"fetus_threshold", &s->fetus_threshold},
               {"one_side", &s->one_side},
               {"skin_mm", &s->skin_mm},
               {"tau_mm", &s->tau_mm},
               {"cut_cost", &s->cut_cost},
               {"occluder_cost", &s->occluder_cost},
               {"wrong_fluid_cost", &s->wrong_fluid_cost},
               {"sigma_mm", &s->sigma_mm},
               {"median_mm", &s->median_mm},
               {"smoothing_mm", &s->smoothing_mm},
               {"tissue", &s->tissue},
               {"average_margin", &s->average_margin},
               {"knob_margin", &s->knob_margin},
               {"q", &s->q},
               {"half_confidence_cost", &s->half_confidence_cost},
               {"wall_share", &s->wall_share},
               {"fetus_share", &s->fetus_share},
               {"assumed_wall", &s->assumed_wall},
               {"assumed_spread", &s->assumed_spread}};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if (strcmp(all[i].key, key) == 0) return all[i].value;
    return NULL;
}
