#!/bin/bash
# SPDX-License-Identifier: MIT
# Old and new hosts and plugins work together: all four pairs of a host and a plugin of this ABI (the header as it is) and of
# a made-up next minor (the same with fields appended to five structs). Under AddressSanitizer, with every struct in an allocation of
# its exact size. A struct shorter than its version 1.0 is refused with SV_ERR_SIZE.
set -eu
source_dir=$1
command -v gcc > /dev/null || { echo "skipped: no gcc"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
mkdir old new
cp "$source_dir/include/smartvis_plugin.h" old/

# append STRUCT FIELDS: into new/smartvis_plugin.h, before the struct's closing brace.
cp old/smartvis_plugin.h new/
append() {
    awk -v head="^(typedef )?struct $1 \\\\{" -v fields="$2" '
        $0 ~ head { inside = 1 }
        inside && /^\}/ { print "    " fields; inside = 0; done = 1 }
        { print }
        END { exit !done }' new/smartvis_plugin.h > header || { echo "no struct $1 in the header"; exit 1; }
    mv header new/smartvis_plugin.h
}
append sv_host 'uint32_t (*added_service)(const sv_host *host);'
append sv_frame 'float added_gain; uint32_t added_reserved;'
append sv_stats 'uint32_t added_count; uint32_t added_reserved;'
append sv_param_info 'const char *added_group;'
append sv_plugin 'uint32_t (*added_call)(const sv_plugin *plugin);'
sed -i 's/^#define SV_ABI_MINOR 1u/#define SV_ABI_MINOR 2u/' new/smartvis_plugin.h
grep -q '^#define SV_ABI_MINOR 2u' new/smartvis_plugin.h

flags=(-std=c11 -Wall -Wextra -Wpedantic -Werror -g -O1 -fsanitize=address,undefined -fno-sanitize-recover=undefined)
for version in old new; do
    [ $version = old ] || flags+=(-DGROWN)
    gcc "${flags[@]}" -I $version -fPIC -shared "$source_dir/tests/sdk/abi/evolution_plugin.c" -o $version.so
    gcc "${flags[@]}" -I $version "$source_dir/tests/sdk/abi/evolution_host.c" -o ${version}_host -ldl
done
gcc "${flags[@]}" -DNAIVE -I new -fPIC -shared "$source_dir/tests/sdk/abi/evolution_plugin.c" -o naive.so

failures=0
expect() { # expect TEXT COMMAND...: the command succeeds and prints exactly this
    local want=$1 got
    shift
    got=$("$@" 2>&1) || got="$got (exit code $?)"
    if [ "$got" != "$want" ]; then
        printf '%s\n  expected: %s\n  printed:  %s\n' "$*" "$want" "$got"
        failures=$((failures + 1))
    fi
}

# The frame's gain reaches the plugin (3) or has its default (2); the plugin asks the host's new service (17) or gets none (0);
# the new host reads what a new plugin wrote (11, group, 13), or zeros that it put there itself.
expect 'status 0 0 0 gain 2 rays 7 id 5 service 0' ./old_host ./old.so
expect 'status 0 0 0 gain 2 rays 7 id 5 service 0' ./old_host ./new.so
expect 'status 0 0 0 gain 2 rays 7 id 5 service 0 count 0 group none call 0' ./new_host ./old.so
expect 'status 0 0 0 gain 3 rays 7 id 5 service 17 count 11 group group call 13' ./new_host ./new.so

# Shorter than 1.0: SV_ERR_SIZE (-11), from the very call that was given the struct.
for host in old_host new_host; do
    for plugin in old.so new.so; do
        expect 'create -11' ./$host ./$plugin sv_host
        expect 'status -11 0 0' ./$host ./$plugin sv_frame
        expect 'status 0 -11 0' ./$host ./$plugin sv_stats
        expect 'status 0 0 -11' ./$host ./$plugin sv_param_info
    done
done

# The test sees the mistake it is there for.
if ./old_host ./naive.so > naive.log 2>&1 || ! grep -q 'heap-buffer-overflow' naive.log; then
    echo "a plugin that reads past an old host's struct is not noticed"
    failures=$((failures + 1))
fi

echo "4 pairs, 16 shortened structs, $failures failures"
[ $failures = 0 ]
