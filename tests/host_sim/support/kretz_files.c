/* SPDX-License-Identifier: MIT */
#include "support/kretz_files.h"

#include "support/host_fixture.h"

static const char magic[] = "KRETZFILE 1.0   ";

kretz_plan kretz_good(void) {
    kretz_plan plan = {.item = {{0x0110, 0x0002, KRETZ_BYTES, 12, {0}, (const uint8_t *)"MUSTERFRAU^A"},
                                {0x0001, 0x0100, KRETZ_U32, 1, {0x10}, NULL},
                                {0xC000, 0x0001, KRETZ_U16, 1, {KRETZ_SAMPLES}, NULL},
                                {0xC000, 0x0002, KRETZ_U16, 1, {KRETZ_LINES}, NULL},
                                {0xC000, 0x0003, KRETZ_U16, 1, {KRETZ_PLANES}, NULL},
                                {0xC100, 0x0001, KRETZ_F64, 1, {0.0005}, NULL},
                                {0xC200, 0x0001, KRETZ_F64, 1, {20}, NULL},
                                {0xC200, 0x0002, KRETZ_F64, 1, {10}, NULL},
                                {0xC300, 0x0001, KRETZ_F64, KRETZ_PLANES, {1.3, 1.8}, NULL},
                                {0xC300, 0x0002, KRETZ_F64, KRETZ_LINES, {1.2, 1.55, 1.9}, NULL},
                                {0xD000, 0x0001, KRETZ_BYTES, KRETZ_VOXELS, {1}, NULL}},
                       .count = 11};
    return plan;
}

kretz_item *kretz_find(kretz_plan *plan, uint16_t group, uint16_t element) {
    for (uint32_t i = 0; i < plan->count; i++)
        if (plan->item[i].group == group && plan->item[i].element == element) return &plan->item[i];
    fail_msg("no item (%04X,%04X)", group, element);
    return NULL;
}

void kretz_drop(kretz_plan *plan, uint16_t group, uint16_t element) {
    kretz_item *at = kretz_find(plan, group, element);
    const kretz_item *end = plan->item + plan->count--;
    for (; at + 1 < end; at++) at[0] = at[1];
}

void kretz_add(kretz_plan *plan, kretz_item item) {
    assert_true(plan->count < KRETZ_ITEMS);
    plan->item[plan->count++] = item;
}

static void put(uint8_t **at, uint64_t value, unsigned bytes) {
    for (unsigned i = 0; i < bytes; i++) *(*at)++ = (uint8_t)(value >> 8 * i);
}

static uint32_t payload_bytes(const kretz_item *item) {
    static const uint32_t each[] = {2, 4, 8, 1};
    return item->count * each[item->type];
}

static void put_payload(uint8_t **at, const kretz_item *item) {
    for (uint32_t i = 0; i < item->count; i++) {
        uint64_t bits = 0;
        if (item->type == KRETZ_F64)
            memcpy(&bits, &item->value[i], sizeof bits);
        else if (item->type != KRETZ_BYTES)
            bits = (uint64_t)item->value[i];
        else
            bits = item->bytes ? item->bytes[i] : (uint64_t)item->value[0] + i;
        put(at, bits, payload_bytes(item) / item->count);
    }
}

uint8_t *kretz_bytes_of(const kretz_plan *plan, size_t *bytes) {
    *bytes = sizeof magic - 1 + (plan->no_end ? 0 : 8);
    for (uint32_t i = 0; i < plan->count; i++) *bytes += 8 + payload_bytes(&plan->item[i]);
    uint8_t *file = unit_memory(*bytes), *at = file;
    memcpy(at, magic, sizeof magic - 1);
    at += sizeof magic - 1;
    for (uint32_t i = 0; i < plan->count; i++) {
        const kretz_item *item = &plan->item[i];
        put(&at, item->group | (uint64_t)item->element << 16 | (uint64_t)payload_bytes(item) << 32, 8);
        put_payload(&at, item);
    }
    if (!plan->no_end) put(&at, 0xFFFFFFFF, 8);
    assert_ptr_equal(at, file + *bytes);
    return file;
}

void kretz_file(const char *name, const kretz_plan *plan) {
    size_t bytes;
    uint8_t *file = kretz_bytes_of(plan, &bytes);
    files_write(name, NULL, file, bytes);
}

hs_volume kretz_volume(const char *name, const hs_kretz_options *options) {
    hs_error err = {0};
    hs_volume volume = {0};
    hs_kretz *kretz = hs_kretz_open(files_path(name), options, &err);
    if (!kretz || !hs_kretz_read(kretz, 0, &volume, &err)) fail_msg("%s: %s", name, err.text);
    hs_kretz_close(kretz);
    keep_volume(&volume);
    return volume;
}

void kretz_refused(const char *name, const char *told) {
    hs_error err = {0};
    hs_kretz *kretz = hs_kretz_open(files_path(name), NULL, &err);
    if (kretz) fail_msg("%s was read, expected '%s'", name, told);
    unit_told(err, HS_ERR_INPUT, files_path(name));
    if (!strstr(err.text, told)) fail_msg("'%s' does not tell '%s'", err.text, told);
    if (strstr(err.text, "MUSTER")) fail_msg("'%s' names a patient", err.text);
}
