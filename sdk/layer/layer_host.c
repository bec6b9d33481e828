/* SPDX-License-Identifier: MIT */
/* What the host does: the shadow of an instance, held to the header by the checks that authors of plugins
 * use. */
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include "layer/layer.h"

#include "smartvis/author_objects.h"

/* What an error means: the host's rule that was broken, and the plugin's rule that makes it an error. */
typedef struct {
    sv_status status;
    rule_name host, plugin;
} meaning;

static meaning mean(const rc_call *c, sv_status due) {
    static const meaning by_status[] = {
        {SV_ERR_STATE, RULE_host_states, RULE_call_states},
        {SV_ERR_SIZE, RULE_host_sizes, RULE_struct_sizes},
        {SV_ERR_PARAM_ID, RULE_host_values, RULE_param_out_of_range},
        {SV_ERR_PARAM_RANGE, RULE_host_values, RULE_param_out_of_range},
        {SV_ERR_PARAM_FIXED, RULE_host_values, RULE_param_fixed},
        {SV_ERR_SLAB_ORDER, RULE_host_slabs, RULE_slab_refusals},
        {SV_ERR_SLAB_MISSING, RULE_host_slabs, RULE_slab_refusals},
        {SV_ERR_SLAB_SHAPE, RULE_host_slabs, RULE_slab_refusals},
    };
    static const meaning by_call[RC_CALLS] = {
        [RC_ACTIVATE] = {0, RULE_host_format, RULE_format_refusals},
        [RC_BEGIN] = {0, RULE_host_frame, RULE_null_arguments},
        [RC_SLAB] = {0, RULE_host_slabs, RULE_null_arguments},
        [RC_END] = {0, RULE_host_result, RULE_null_arguments},
        [RC_ADJUST] = {0, RULE_host_result, RULE_null_arguments},
    };
    for (size_t i = 0; i < sizeof by_status / sizeof *by_status; i++)
        if (by_status[i].status == due) return by_status[i];
    return by_call[c->kind];
}

rule_name ly_rule_of_refusal(const ly_instance *i, const rc_call *c, sv_status due) {
    if (i->owed != RULE_COUNT) return i->owed;
    return mean(c, due).plugin;
}

/* ---- what author.h checks */
static bool is_allowed(const sva *a, rc_kind kind) {
    switch (kind) {
    case RC_ACTIVATE:
    case RC_DESTROY:
        return a->state == SVA_INACTIVE;
    case RC_DEACTIVATE:
    case RC_BEGIN:
        return a->state != SVA_INACTIVE;
    case RC_ADJUST:
        return a->state == SVA_FINISHED;
    default:
        return a->state == SVA_SLABS;
    }
}

static void start_from(sva *a, const double *values) {
    memcpy(a->values, values, a->method->param_count * sizeof *a->values);
}

static sv_status check(ly_instance *i, const rc_call *c) {
    sva *a = &i->shadow;
    const char *call = rc_names[c->kind];
    sv_status due = SV_OK;
    char probe[200];
    if (!is_allowed(a, c->kind)) return sva_wrong_state(a, call);
    switch (c->kind) {
    case RC_ACTIVATE:
        due = sva_check_format(a, c->format, 0);
        for (uint32_t n = 0; n < a->method->param_count; n++)
            a->values[n] = a->method->params[n].default_value;
        return due ? due
                   : sva_take_values(a, call, c->format->values, c->format->value_count, SV_PARAM_REACTIVATE);
    case RC_BEGIN:
        due = sva_check_frame(a, c->frame);
        if (due == SV_ERR_ARGUMENT && c->frame && !sv_probe_holds(c->frame, probe, sizeof probe))
            i->owed = RULE_probe;
        start_from(a, a->fixed);
        return due ? due : sva_take_values(a, call, c->frame->values, c->frame->value_count, 0);
    case RC_SLAB:
        return sva_check_slab(a, c->slab);
    case RC_ADJUST:
        start_from(a, a->framed);
        due = sva_take_values(a, call, c->values, c->value_count, SV_PARAM_ADJUST);
        return due ? due : sva_check_result(a, call, c->result);
    case RC_END:
        return sva_check_end(a, c->result);
    default:
        return SV_OK;
    }
}

/* ---- OpenCL objects */
/* The error that is due for an object of the host's. */
static sv_status check_object(ly_instance *i, const char *field, cl_mem object, uint64_t offset,
                              uint64_t bytes) {
    return sva_cl_check_object(&i->shadow, field, object, SV_CARRIER_BUFFER, offset, bytes, SV_ERR_ARGUMENT);
}

static bool is_foreign(const ly_instance *i, cl_mem object) {
    cl_context context = i->shadow.format.context;
    (void)clGetMemObjectInfo(object, CL_MEM_CONTEXT, sizeof context, &context, NULL);
    return context != i->shadow.format.context;
}

static sv_status check_objects(ly_instance *i, const rc_call *c) {
    const sv_format *f = &i->shadow.format;
    const uint64_t rays = (uint64_t)f->width * f->height;
    const cl_mem object = c->kind == RC_BEGIN  ? c->frame->scanned_object
                          : c->kind == RC_SLAB ? c->slab->object
                          : c->result          ? c->result->depth_object
                                               : NULL;
    if (!object) return SV_OK;
    if (is_foreign(i, object)) i->owed = RULE_foreign_objects;
    if (c->kind == RC_SLAB) return sva_cl_check_slab(&i->shadow, c->slab);
    if (c->kind == RC_BEGIN)
        return check_object(i, "begin: scanned_object", object, c->frame->scanned_offset,
                            rays * sizeof(sv_scanned));
    return check_object(i, c->kind == RC_END ? "end: depth_object" : "adjust: depth_object", object,
                        c->result->depth_offset, rays * sizeof(float));
}

/* ---- what no plugin has to refuse */
static void check_reserved(const rule_sink *to, const char *call, uint32_t reserved,
                           const sv_param_value *values, uint32_t count) {
    RULE_EXPECT(to, RULE_host_reserved, reserved == 0, "%s: reserved is %u", call, reserved);
    for (uint32_t n = 0; n < count; n++)
        RULE_EXPECT(to, RULE_host_reserved, values[n].reserved == 0, "%s: values[%u].reserved is %u", call, n,
                    values[n].reserved);
}

static void check_slab(ly_instance *i, const sv_slab *slab) {
    const rule_sink *to = &i->called;
    const sv_format *f = &i->shadow.format;
    check_reserved(to, "slab", slab->reserved, NULL, 0);
    RULE_EXPECT(to, RULE_host_slabs, sva_in_host_memory(f, slab),
                "slab: memory lies outside of the format's host_memory, which has %llu bytes",
                (unsigned long long)f->host_memory_bytes);
}

static void check_frame(ly_instance *i, const sv_frame *f) {
    const rule_sink *to = &i->called;
    char probe[200];
    check_reserved(to, "begin", f->reserved, f->values, f->value_count);
    RULE_EXPECT(to, RULE_host_frame, sv_probe_holds(f, probe, sizeof probe), "begin: %s", probe);
    RULE_EXPECT(to, RULE_host_clock,
                f->time_ns == 0 || f->time_ns >= i->last_time_ns || (f->flags & SV_FRAME_DISCONTINUITY),
                "begin: time_ns is %llu, the frame before had %llu", (unsigned long long)f->time_ns,
                (unsigned long long)i->last_time_ns);
}

/* No rule: a volume may be as large as no scan. So it is no breach, and `stop` stops nothing. Once a size. */
static void doubt_lengths(ly_instance *i, const rc_call *c) {
    char doubt[SV_LENGTHS_TEXT_BYTES];
    if (c->kind == RC_ACTIVATE ? sv_lengths_doubt_format(c->format, doubt, sizeof doubt)
                               : sv_lengths_doubt_frame(&i->shadow.format, c->frame, doubt, sizeof doubt))
        ly_doubt(i, RULE_host_format, rc_names[c->kind], doubt);
}

static void check_rest(ly_instance *i, const rc_call *c) {
    const rule_sink *to = &i->called;
    if (c->kind == RC_ACTIVATE || c->kind == RC_BEGIN) doubt_lengths(i, c);
    if (c->kind == RC_ACTIVATE)
        check_reserved(to, "activate", c->format->reserved, c->format->values, c->format->value_count);
    if (c->kind == RC_BEGIN) check_frame(i, c->frame);
    if (c->kind == RC_SLAB) check_slab(i, c->slab);
    if (c->kind == RC_ADJUST) check_reserved(to, "adjust", 0, c->values, c->value_count);
}

sv_status ly_due_host(ly_instance *i, const rc_call *c) {
    sva *a = &i->shadow;
    a->reason[0] = '\0';
    i->owed = RULE_COUNT;
    sv_status due = check(i, c);
    if (due != SV_OK) {
        rule_tell(&i->called, mean(c, due).host, "%s", a->reason);
        return due;
    }
    due = check_objects(i, c);
    if (due != SV_OK)
        rule_tell(&i->called, RULE_host_objects, "%s", a->reason);
    else
        check_rest(i, c);
    return due;
}

/* ---- smartvis.needs/1 */
sv_status ly_due_needs(ly_instance *i, const sv_format *format, const sv_param_value *values, uint32_t count,
                       const sv_needs_device *device, const sv_needs *out) {
    sva *a = &i->shadow;
    const uint32_t known = SV_NEEDS_CPU | SV_NEEDS_UNIFIED | SV_NEEDS_DOUBLES;
    if (!device || !out)
        return sva_blame(a, SV_ERR_ARGUMENT, "needs of: %s is NULL", device ? "out" : "device");
    if (device->size < sizeof *device || out->size < sizeof *out)
        return sva_blame(a, SV_ERR_SIZE, "needs of: the size of device is %u, that of out %u",
                         (unsigned)device->size, (unsigned)out->size);
    if ((device->flags & ~known) || device->compute_units == 0)
        return sva_blame(a, SV_ERR_ARGUMENT, "needs of: device.flags is 0x%x, compute_units is %u",
                         (unsigned)device->flags, (unsigned)device->compute_units);
    const sv_status due = sva_check_format(a, format, 1);
    if (due != SV_OK || count == 0) return due;
    if (!values)
        return sva_blame(a, SV_ERR_ARGUMENT, "needs of: values is NULL, value_count is %u", (unsigned)count);
    for (uint32_t n = 0; n < count; n++) {
        const sva_param *p = sva_find(a, values[n].id);
        if (!p)
            return sva_blame(a, SV_ERR_PARAM_ID, "needs of: no parameter has id %u", (unsigned)values[n].id);
        if (!sva_value_fits(p, values[n].value))
            return sva_blame(a, SV_ERR_PARAM_RANGE, "needs of: %s is %g", p->key, values[n].value);
    }
    return SV_OK;
}

/* ---- the shadow */
static void keep_format(ly_instance *i, const rc_call *c) {
    sva *a = &i->shadow;
    if (!c->sound) { /* taken all the same, whatever it means */
        atomic_fetch_add(&i->came, 1);
        return;
    }
    a->state = SVA_IDLE;
    a->format = *c->format;
    a->format.values = NULL;
    a->format.value_count = 0;
    memcpy(a->fixed, a->values, a->method->param_count * sizeof *a->values);
    i->last_time_ns = 0;
}

void ly_follow(ly_instance *i, const rc_call *c) {
    sva *a = &i->shadow;
    const bool well = c->status >= SV_OK;
    if (c->kind == RC_DEACTIVATE) {
        a->state = SVA_INACTIVE;
        i->has_frame = false;
        i->mistake_count = 0;
    }
    if (c->kind == RC_ACTIVATE && well) keep_format(i, c);
    if (c->status == SV_ERR_STATE || a->state == SVA_INACTIVE) return; /* such a call changes nothing */
    if (c->kind == RC_BEGIN || c->kind == RC_SLAB) a->state = well ? SVA_SLABS : SVA_IDLE;
    if (c->kind == RC_END) a->state = well ? SVA_FINISHED : SVA_IDLE;
    i->has_frame |= c->kind == RC_END && well;
    if (c->kind == RC_BEGIN) a->next_slice = 0;
    if (c->kind == RC_SLAB && well && c->slab) a->next_slice = c->slab->first_slice + c->slab->slice_count;
    if (c->kind != RC_BEGIN || !c->sound) return;
    memcpy(a->framed, a->values, a->method->param_count * sizeof *a->values);
    i->frame_index = c->frame->index;
    if (c->frame->time_ns) i->last_time_ns = c->frame->time_ns;
}
