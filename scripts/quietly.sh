#!/bin/bash
# SPDX-License-Identifier: MIT
# quietly.sh NAME LOG COMMAND...: one line for a step. What COMMAND prints goes to LOG; on a terminal its latest line is shown while
# one waits, elsewhere a line a minute. A command that fails shows the end of LOG. Exit code: that of COMMAND.
set -u
name=$1 log=$2
shift 2
mkdir -p "$(dirname "$log")"
: > "$log"

latest() { tail -c 400 "$log" | tr '\r' '\n' | grep -v '^ *$' | tail -n 1 | cut -c 1-90; }
watch_log() {
    while sleep 1; do
        if [ -t 2 ]; then
            printf '\r\033[K%s: %d s  %s' "$name" $SECONDS "$(latest)" >&2
        elif [ $((SECONDS % 60)) = 0 ]; then
            echo "$name: $SECONDS s so far  $(latest)" >&2
        fi
    done
}
SECONDS=0
watch_log &
watcher=$!
# The command itself is in the foreground: Ctrl-C reaches it.
"$@" > "$log" 2>&1
code=$?
kill $watcher 2> /dev/null
wait $watcher 2> /dev/null
[ ! -t 2 ] || printf '\r\033[K' >&2
if [ $code != 0 ]; then
    tail -n 40 "$log" >&2
    echo "$name: FAILED after $SECONDS s, exit code $code; above is the end of $log" >&2
    exit $code
fi
[ $SECONDS -lt 2 ] || echo "$name: done in $SECONDS s, log $log"
