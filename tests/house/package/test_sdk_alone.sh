#!/bin/bash
# SPDX-License-Identifier: MIT
# Plugin and SDK without the machine: a tree that has neither host_sim nor what stands on it configures, builds, and passes the tests
# that are quick there; at night it builds and passes all of its tests. Called with the source and the build folder.
set -eu
source_dir=$1 build=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
said() { "$@" > "$work/log" 2>&1 || { tail -n 60 "$work/log"; echo "FAILED: $*"; exit 1; }; }

# Nothing of plugin or SDK reads a header of the machine, what is not built below neither. Ninja knows what each object has read.
if [ -e "$build/.ninja_deps" ]; then
    ninja -C "$build" -t deps | awk -v root="$source_dir/" '
        /^[^ ]/ { of = $1 ~ /^obj\/(base|sdk|src|examples)\/|\.dir\/(base|sdk|support|programs)\// ? $1 : ""; objects += of != "" }
        of && index($1, root) == 1 && ("/" substr($1, length(root))) ~ /\/(host_sim|lab|python)\// { print of " reads " $1; bad = 1 }
        END { exit bad || objects < 100 }' || { echo "FAILED: plugin and SDK do not stand alone"; exit 1; }
fi

mkdir "$work/tree"
(cd "$source_dir" && tar -c --exclude=./build* --exclude=./out --exclude=./.git --exclude=./host_sim --exclude=./lab --exclude=./python \
    --exclude=./tests/host_sim --exclude=./tests/lab --exclude=./tests/python --exclude=./tests/fuzz .) | tar -x -C "$work/tree"
cache=$(sed -n 's/^SV_TEST_CACHE:[A-Z]*=//p' "$build/CMakeCache.txt")
# Without optimization it builds in half the time, and equal bits do not depend on it.
said cmake -S "$work/tree" -B "$work/build" -G Ninja -D SV_WERROR=ON -D CMAKE_BUILD_TYPE=Debug -D CMAKE_C_FLAGS_DEBUG=-O0 -D "SV_TEST_CACHE=$cache"
programs=(test_layer test_layout test_profile test_child test_text) # one and more of every folder that they link
targets=(--target smartvis_static sv_replay sv_validate template wrong_plugins "${programs[@]}")
some=(-R "/($(IFS='|' && echo "${programs[*]}")|test_exports|test_validate_cli)\$")
[ -z "${SV_NIGHT:-}" ] || targets=() some=()
said cmake --build "$work/build" -j "$(nproc)" "${targets[@]}"
said ctest --test-dir "$work/build" --output-on-failure --no-tests=error -j "$(nproc)" "${some[@]}"
tail -n 5 "$work/log"
