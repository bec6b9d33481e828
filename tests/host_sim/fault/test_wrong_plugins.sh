#!/bin/bash
# SPDX-License-Identifier: MIT
# The family of wrong plugins (tests/sdk/wrong) against host_sim run. Guarded, none of them crashes or hangs the host, and
# there always is a picture; in both modes a frame that failed is rendered unclipped. Unguarded, the plugins run of which
# the host itself notices something: the others take the same way in both modes, and those that only the guard ends would end
# the host. By day one plugin of each check, and those whose end is named below; with SV_NIGHT all.
# Called with the source and the build folder.
# Requirement: R11.
set -u
build=$2
table=$(mktemp)
trap 'rm -f "$table"' EXIT
# The sanitizers' own handlers would turn a crash into an exit.
export ASAN_OPTIONS="${ASAN_OPTIONS:-}:handle_segv=0:handle_abort=0:handle_sigfpe=0:handle_sigbus=0:detect_leaks=0"
list=$1/tests/sdk/wrong/wrong_list.h
named=$(sed -nE 's/^ *ends ([a-z0-9_]+) .*/\1/p' "$0")
mapfile -t tried < <(sed -nE 's/^    WRONG\(([a-z0-9_]+), [a-z]+, ([a-z-]+),.*/\1 \2/p' "$list" |
    awk -v night="${SV_NIGHT:-}" -v named="$named" 'BEGIN { n = split(named, list); while (n) wanted[list[n--]] = 1 }
        night != "" || $1 in wanted || !seen[$2]++ { print $1 }')
"$1/scripts/wrong_table.sh" --tsv guard "$build" "${tried[@]}" > "$table"
mapfile -t noticed < <(grep -vP '\tguard\t0\tclipped\t' "$table" |
    grep -vE 'crashed: SIG|aborted in|left by exit|ran out of time|took more than|misused its channel' | cut -f 1)
"$1/scripts/wrong_table.sh" --tsv no-guard "$build" "${noticed[@]}" >> "$table"
failed=0
complain() {
    echo "FAIL: $*"
    failed=1
}

ids=${#tried[@]}
[ "$(wc -l < "$table")" -eq $((ids + ${#noticed[@]})) ] || complain "$(wc -l < "$table") lines for $ids plugins, ${#noticed[@]} noticed"
least=8
[ -z "${SV_NIGHT:-}" ] || least=20
[ ${#noticed[@]} -ge $least ] || complain "only ${#noticed[@]} plugins are noticed"
[ "$ids" -ge 40 ] || complain "only $ids plugins"

while IFS=$(printf '\t') read -r id mode code picture reason; do
    what="$id $mode: code $code, picture $picture, $reason"
    [ "$picture" != WRONG ] || complain "$what"
    # What fails while the library is unloaded comes behind the pictures.
    [ "$code" != 4 ] || [ "$picture" = unclipped ] || [[ $mode$reason == guard*"in destroy" ]] || complain "$what"
    [ "$mode" = guard ] || continue
    [ "$code" = 0 ] || [ "$code" = 4 ] || complain "$what"
    [ "$picture" != none ] || complain "$what"
    [ "$code" = 0 ] || [ -n "$reason" ] || complain "$what: no reason"
done < "$table"

# ends ID REASON: guarded, the plugin ends in this way.
ends() {
    grep -P "^$1\tguard\t4\t[a-z]*\t.*$2" "$table" > /dev/null || complain "$1 does not end as '$2': $(grep -P "^$1\tguard\t" "$table")"
}
if [ "${SV_SANITIZE:-0}" = 0 ]; then # a sanitizer finds many of them first
    ends crash_in_constructor 'crashed: SIGSEGV in dlopen'
    ends crash_in_create 'crashed: SIGSEGV in create'
    ends crash_in_activate 'crashed: SIGSEGV in activate'
    ends crash_in_slab 'crashed: SIGSEGV in slab 1 of 1'
    ends forgets_ray_bytes 'crashed: SIGSEGV in end'
    ends crash_in_destructor 'crashed: SIGSEGV in destroy'
    ends abort_in_slab 'aborted in slab 1 of 1'
    ends endless_recursion 'crashed: SIGSEGV in end'
    ends divides_by_zero 'crashed: SIGFPE in end'
    ends writes_into_slab 'crashed: SIGSEGV in slab'
fi
ends exit_in_constructor 'left by exit\(0\) in dlopen'
ends exit_in_end 'left by exit\(0\) in end'
ends hang_in_constructor 'ran out of time \(15.0 s\) in dlopen'
ends hang_in_activate 'ran out of time \(15.0 s\) in activate'
ends hang_in_end 'ran out of time \(8.0 s\) in end'
ends memory_grab 'took more than 512 MiB in end'
ends count_endless 'at most 64 plugins are read'
ends closes_descriptors 'closed or misused its channel in begin'
ends surface_overruns 'end: SV_ERR_INTERNAL.*surface wrote beyond its [0-9]+ rays'
ends writes_past_map 'end: SV_ERR_INTERNAL.*end: surface wrote beyond its 121 rays'
ends surface_underruns 'end: SV_ERR_INTERNAL.*surface wrote beyond its [0-9]+ rays'
ends points_overrun 'surface wrote beyond its [0-9]+ rays into what surrounds sva.points'
ends rays_overrun 'surface wrote beyond its [0-9]+ rays into what surrounds sva.rays: is sva_method.ray_bytes right'
ends activate_77 'activate: unknown status \(77\)'
ends begin_77 'begin: unknown status \(77\)'
# What is the plugin's own failure is the same in both modes.
for id in "${noticed[@]}"; do
    [ "$(grep -P "^$id\tguard\t" "$table" | cut -f 3-)" = "$(grep -P "^$id\tno-guard\t" "$table" | cut -f 3-)" ] ||
        complain "$id is told in two ways: $(grep -P "^$id\t" "$table")"
done

# Output without end is cut, and each frame says by how much.
work=$(mktemp -d)
trap 'rm -rf "$table" "$work"' EXIT
small=(--scene E01 --size 32 --frames 2 --setting smartvis --picture 16 --few-pictures --guard)
"$build/host_sim" run "${small[@]}" --plugin "$build/wrong/logs_without_end.so" --out "$work/out" > /dev/null 2> "$work/errors" || complain "logs_without_end: code $?"
cut=$(grep -c 'more bytes of its output were dropped' "$work/errors")
size=$(stat -c %s "$work/errors")
[ "$cut" -ge 2 ] && [ "$size" -lt $((cut * 66000)) ] || complain "logs_without_end: $size bytes, cut $cut times"

# The benchmark's own process ends, too.
for id in crash_in_slab exit_in_end hang_in_activate; do
    said=$("$build/sv_bench" --plugin "$build/wrong/$id.so" --only plugin --size 128 --slab 32 --route place-own --frames 1 \
        --guard-time 15,15 2>&1 > /dev/null)
    code=$?
    [ $code = 4 ] && [[ $said = *"$id.so: "*" while it was timed "* ]] || complain "sv_bench with $id: code $code, $said"
done

# No process outlives the host. What it starts has its environment.
for id in forks forks_session; do
    SV_TEST_RUN=$work "$build/host_sim" run "${small[@]}" --plugin "$build/wrong/$id.so" --out "$work/out" > /dev/null || complain "$id: code $?"
    left=$(grep -lsz "^SV_TEST_RUN=$work" /proc/[0-9]*/environ)
    [ -z "$left" ] || complain "$id leaves processes behind: $left"
done

# Nor does a plugin's process that hangs in a call outlive a host that is killed.
SV_TEST_RUN=$work/killed "$build/host_sim" run "${small[@]}" --plugin "$build/wrong/hang_in_end.so" --guard-time 300,300 --out "$work/out" \
    > /dev/null 2>&1 &
host=$!
left() { grep -lsz "^SV_TEST_RUN=$work/killed" /proc/[0-9]*/environ; }
has_child() { [ "$(left | wc -l)" -ge 2 ]; }
for ((n = 0; n < 300; n++)); do has_child && break || sleep 0.1; done
has_child || complain "hang_in_end: it has no process"
sleep 1 # into the call
kill -9 $host
wait $host 2> /dev/null
for ((n = 0; n < 100; n++)); do [ -n "$(left)" ] && sleep 0.1 || break; done
[ -z "$(left)" ] || complain "hang_in_end outlives its host: $(left)"

[ $failed = 0 ] && echo "$ids plugins: none crashes or hangs the guarded host"
exit $failed
