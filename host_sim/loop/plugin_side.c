/* SPDX-License-Identifier: MIT */
#include "loop/plugin_side.h"

#include "guarded/guarded.h"

void hs_side_fit(hs_side_way *way, const hs_plugin *plugin) {
    way->fan = HS_FAN_RANGES;
    if (!plugin) return;
    const sv_descriptor *d = plugin->instance->descriptor;
    (void)hs_plugin_choose_handover(d, plugin->path, way->handover, way->fixed, &way->handover,
                                    &way->refused);
    way->fan = hs_plugin_fan(d);
}

bool hs_side_create(const hs_cl *cl, const hs_plugin *plugin, const hs_side_way *way,
                    const hs_slab_layout *layout, bool gaps, const hs_clipper_options *asked,
                    hs_slabs **slabs, hs_clipper **clipper, hs_error *err) {
    const hs_handover how = way->handover;
    /* A guarded plugin is given memory of its guard's, on what it calls its own queue. */
    const bool guarded = hs_is_guarded(plugin);
    hs_clipper_options options = *asked;
    void *memory = NULL;
    options.own_queue = how.own_queue || guarded;
    options.refused = &way->refused;
    /* Asked here for a guarded plugin, too, whose images are its guard's: they fail in no call of the plugin.
     */
    if (how.carrier == SV_CARRIER_IMAGE && !hs_cl_check_images(cl, err)) return false;
    hs_guarded_route(plugin, how);
    if (guarded && !(memory = hs_guarded_memory(plugin, hs_slabs_bytes(layout), err))) return false;
    return (*slabs = hs_slabs_create(cl, layout, guarded ? SV_CARRIER_HOST : how.carrier, way->fan, gaps,
                                     memory, err)) &&
           (*clipper = hs_clipper_create(cl, *slabs, plugin, &options, err));
}
