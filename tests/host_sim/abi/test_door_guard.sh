#!/bin/bash
# SPDX-License-Identifier: MIT
# scripts/check_abi.sh --door finds nothing in smartvis_host.h but additions to what was released, whose dump is in abi/door/. And it would
# notice: the header is changed here in one way each, every fourth by day. The library's name on disk says which promise it keeps.
# Called with the source and the build folder.
# shellcheck disable=SC2016 # what looks like variables is Perl's
# Requirement: R16.
set -u
source_dir=$1 build_dir=$2
promise=--door folder=$source_dir/host_sim/door
# shellcheck source=tests/support/changes.sh
. "$source_dir/tests/support/changes.sh"
h=smartvis_host.h

# --- functions: another signature, another name
refused 'svh_needs: was function' $h 's/uint64_t \*bytes/uint32_t *bytes/'
refused 'svh_reset: was function' $h 's/void svh_reset\(/int32_t svh_reset(/'
refused 'svh_mesh_free: gone' $h 's/\bsvh_mesh_free\b/svh_free_mesh/g'
refused 'svh_convert: was function' $h 's/(svh_convert\()svh_volume \*volume, const svh_view \*view/$1const svh_view *view, svh_volume *volume/'
# --- fields: wider, renamed, swapped, inserted; what lies in arrays never grows
refused 'svh_error.reason: was at' $h 's/char call\[16\]/char call[32]/'
refused 'svh_result.try_id: gone' $h 's/\btry_id\b/advice/g'
refused 'svh_voxels.direction: was at' $h 's/(    double direction\[9\];.*?\n.*?\n)(    double origin\[3\];.*?\n)/$2$1/'
refused 'svh_about: a field before the end' $h 's/    uint32_t has_beams;/    uint32_t more;\n$&/'
refused 'svh_mark: never grows' $h 's/    uint32_t reserved;/$&\n    double more;/'
refused 'svh_view.turned: gone' $h 's/    uint32_t turned;/    uint32_t spare;/'
# --- constants: another value, another name
refused 'SVH_PLUGIN whole 4' $h 's/SVH_PLUGIN = 4/SVH_PLUGIN = 6/'
refused 'SVH_TIMED whole 4: now gone' $h 's/\bSVH_TIMED\b/SVH_CLOCKED/g'

# --- what the next minor may bring
allowed $h 's/    const char \*why;.*?\n/$&    uint32_t more;\n/'
allowed $h 's/SVH_EXPORT void svh_mesh_free/SVH_EXPORT void svh_more(svh_mesh *mesh);\n$&/'
allowed $h 's/SVH_TIMED = 4u/$&, SVH_MORE = 8u/'

# --- programs are linked with the name of this promise
major=$(sed -n 's/^project(smartvis VERSION \([0-9]*\)\..*/\1/p' "$source_dir/CMakeLists.txt")
holds test "$(readelf -dW "$build_dir/libsmartvis_host.so" | sed -n 's/.*(SONAME).*\[\(.*\)\]/\1/p')" = "libsmartvis_host.so.$major"

echo "$checked checked, $failed failed"
[ "$failed" = 0 ]
