#!/bin/bash
# SPDX-License-Identifier: MIT
# test_no_images.sh SOURCE_FOLDER BUILD_FOLDER: where the device has no images of one channel, images are refused with a reason, and no
# plugin is blamed.
set -u
build=$2
host_sim=$build/host_sim
. "$1/tests/support/holds.sh"
export LD_PRELOAD=$build/tests/no_grey_images.so
frame=(run --scene E01 --size 32 --frames 1 --plugin "$build/smartvis.so")
for guard in "" --guard; do
    # shellcheck disable=SC2086
    expect 5 "no images of one channel of 8 bits" "${frame[@]}" --out "$work/out" $guard --carrier image
    # shellcheck disable=SC2086
    expect 0 "" "${frame[@]}" --out "$work/out" $guard --carrier buffer
done
ends 0 "$build/sv_validate" --only carriers,inputs-unchanged "$build/smartvis.so"
holds grep -q "the device has none of one channel" "$work/stdout"
ends 0 "$build/tests/every_method" "$build/smartvis.so" small
holds test "$(grep -c ' image ' "$work/stdout")" = 0
echo "$checked checked, $failed failed"
[ "$failed" = 0 ]
