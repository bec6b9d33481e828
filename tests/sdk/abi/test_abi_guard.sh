#!/bin/bash
# SPDX-License-Identifier: MIT
# scripts/check_abi.sh finds nothing in the headers but additions to 1.1, whose dump is in abi/. And it would notice:
# the headers are changed here in one way each, and what it says must name the place: every fourth by day, all with SV_NIGHT.
# Called with the source and the build folder.
# shellcheck disable=SC2016 # what looks like variables is Perl's
# Requirement: R16.
set -u
source_dir=$1
promise='' folder=$source_dir/include
# shellcheck source=tests/support/changes.sh
. "$source_dir/tests/support/changes.sh"
h=smartvis_plugin.h

# --- fields: wider, of another sign, renamed, swapped, gone, inserted
refused 'sv_descriptor' $h 's/uint32_t queues; /uint64_t queues; /'
refused 'sv_format' $h 's/int32_t padding_value;/uint32_t padding_value;/'
refused 'sv_stats' $h 's/uint32_t points;   /uint32_t origins;/'
refused 'sv_stats' $h 's/(    uint32_t rays; .*?\n)(    uint32_t points;.*?\n)/$2$1/'
refused 'sv_stats' $h 's/    uint32_t unfilled;.*?\n//'
refused 'sv_stats: a field before the end' $h 's/    uint32_t points;   /    uint32_t more;\n$&/'
refused 'sv_frame' $h 's/    uint64_t time_ns;/    uint32_t time_ns;\n    uint32_t spare;/'
refused 'sv_scanned: never grows' $h 's/    uint16_t end;/$&\n    uint16_t more;/'
refused 'sv_param_value: never grows' $h 's/(typedef struct sv_param_value .*?    double value;)/$1\n    double more;/s'
# --- functions: another signature, another order, a table of an extension
refused 'sv_plugin' $h 's/(\*slab\)\(const sv_plugin \*plugin, const sv_slab \*slab)/$1, uint32_t more/'
refused 'sv_plugin.param_count' $h 's/\(SV_CALL \*param_count\)/(SV_CALL *params)/'
refused 'sv_entry' $h 's/(uint32_t abi_major;.*?\n)(    uint32_t abi_minor;.*?\n)/$2$1/'
refused 'sv_ext_timing' smartvis/timing.h 's/(typedef struct sv_ext_timing \{\n    uint32_t size;)/$1\n    uint32_t more[2];/'
# --- constants: another value, another name
refused 'SV_ERR_STATE whole -20' $h 's/SV_ERR_STATE = -20/SV_ERR_STATE = -24/'
refused 'SV_PARAM_ADJUST' $h 's/SV_PARAM_ADJUST = 1u << 3/SV_PARAM_ADJUST = 1u << 4/'
refused 'SV_POINT_EMPTY' $h 's/SV_POINT_EMPTY/SV_POINT_NOTHING/'
refused 'SV_ENTRY_SYMBOL text smartvis_plugin_entry' $h 's/"smartvis_plugin_entry"/"smartvis_entry"/'
refused 'SV_ASSUMED_EXTENT_MM' $h 's/120\.0f/121.0f/'
refused 'SV_ABI_MAJOR' $h 's/SV_ABI_MAJOR 1u/SV_ABI_MAJOR 2u/'
# --- what came with 1.1 is frozen, too
refused 'sv_frame.probe_side: gone' $h 's/\bprobe_side\b/probe_way/g'
refused 'sv_needs.host_bytes: gone' smartvis/needs.h 's/\bhost_bytes\b/heap_bytes/g'
refused 'SV_NEEDS_UNIFIED whole 2' smartvis/needs.h 's/SV_NEEDS_UNIFIED = 1u << 1/SV_NEEDS_UNIFIED = 1u << 3/'
refused 'SV_FEATURE_PROBE whole 8: now gone' $h 's/SV_FEATURE_PROBE\b/SV_FEATURE_POSE/g'

# --- what the next minor may bring
allowed $h 's/(    uint32_t unfilled;.*?\n)/$1    uint32_t more;\n/'
allowed $h 's/(    sv_stats \*stats;.*?\n)/$1    void *more;\n    uint64_t bytes;\n/'
allowed $h 's/(    const void \*\(SV_CALL \*get_extension\)\(const sv_plugin.*?;\n)/$1    void(SV_CALL *more)(const sv_plugin *plugin);\n/'
refused 'SV_FEATURE_PADDING whole 2: now gone' $h 's/SV_FEATURE_PADDING = 1u << 1,/SV_FEATURE_PADDED = 1u << 1,/'
allowed $h 's/SV_POINT_EMPTY = 2/$&, SV_POINT_MORE = 3/'
allowed $h 's/SV_ABI_MINOR 1u/SV_ABI_MINOR 2u/'
allowed $h 's/    uint32_t size;\n    uint32_t flags; /\/* moved *\/\n$&/'
cp -r "$source_dir/include" "$work/new"
sed -e 's/sv_ext_points/sv_ext_novel/g; s/sv_points_report/sv_novel_report/g; s/SV_EXT_POINTS/SV_EXT_NOVEL/g; s/POINTS_H/NOVEL_H/g' \
    "$work/new/smartvis/points.h" > "$work/new/smartvis/novel.h"
holds guard "$work/new"

echo "$checked checked, $failed failed"
[ "$failed" = 0 ]
