#!/bin/bash
# SPDX-License-Identifier: MIT
# Plugin and SDK without the machine: a tree that has neither host_sim nor what stands on it configures, builds, and passes the tests
# that are quick there; at night all of its tests. Called with the source and the build folder.
set -eu
source_dir=$1 build=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
said() { "$@" > "$work/log" 2>&1 || { tail -n 60 "$work/log"; echo "FAILED: $*"; exit 1; }; }

mkdir "$work/tree"
(cd "$source_dir" && tar -c --exclude=./build* --exclude=./out --exclude=./.git --exclude=./host_sim --exclude=./lab --exclude=./python \
    --exclude=./tests/host_sim --exclude=./tests/lab --exclude=./tests/python --exclude=./tests/fuzz .) | tar -x -C "$work/tree"
cache=$(sed -n 's/^SV_TEST_CACHE:[A-Z]*=//p' "$build/CMakeCache.txt")
# Without optimization it builds in half the time, and equal bits do not depend on it.
said cmake -S "$work/tree" -B "$work/build" -G Ninja -D SV_WERROR=ON -D CMAKE_BUILD_TYPE=Debug -D CMAKE_C_FLAGS_DEBUG=-O0 -D "SV_TEST_CACHE=$cache"
said cmake --build "$work/build" -j "$(nproc)"
some=(-R 'test_(layer|layout|header|exports|rules|validate_cli|profile|child|text)')
[ -z "${SV_NIGHT:-}" ] || some=()
said ctest --test-dir "$work/build" --output-on-failure --no-tests=error -j "$(nproc)" "${some[@]}"
tail -n 5 "$work/log"
