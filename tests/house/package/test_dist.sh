#!/bin/bash
# SPDX-License-Identifier: MIT
# scripts/dist.sh: the same commit gives the same bytes, whatever the clock and the umask say; the tarball holds every committed
# file and nothing else. Called with the source and the build folder. Skipped where git knows no commit.
set -u
source_dir=$1
# shellcheck source=tests/support/holds.sh
. "$source_dir/tests/support/holds.sh"

version=$(sed -n 's/^project(smartvis VERSION \([0-9.]*\) .*/\1/p' "$source_dir/CMakeLists.txt")
if ! command -v git > /dev/null; then
    echo "skipped: git is missing"
    exit 77
fi
if ! git -C "$source_dir" rev-parse HEAD > /dev/null 2>&1; then
    echo "skipped: no git checkout"
    exit 77
fi

(umask 022 && bash "$source_dir/scripts/dist.sh" "$work/first") > "$work/path" 2> /dev/null
holds test "$(cat "$work/path")" = "$work/first/smartvis-$version.tar.gz"
sleep 1.1 # a time in the tarball would show
(umask 077 && TZ=Asia/Tokyo bash "$source_dir/scripts/dist.sh" "$work/second") > /dev/null 2>&1
holds cmp "$work/first/smartvis-$version.tar.gz" "$work/second/smartvis-$version.tar.gz"

tar -tzf "$work/first/smartvis-$version.tar.gz" | grep -v '/$' | sed "s|^smartvis-$version/||" | sort > "$work/packed"
git -C "$source_dir" ls-tree -r --name-only HEAD | sort > "$work/committed"
holds cmp "$work/packed" "$work/committed"

echo "$checked checked, $failed failed"
[ "$failed" = 0 ]
