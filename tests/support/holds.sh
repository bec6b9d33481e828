# SPDX-License-Identifier: MIT
# Sourced by test scripts: a folder to work in, which is gone when they end, and counts of what they check and of what failed.
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
checked=0
failed=0

# Fails unless the command given succeeds.
holds() {
    checked=$((checked + 1))
    if ! "$@"; then
        echo "FAIL: $*"
        failed=$((failed + 1))
    fi
}

# ends CODE COMMAND...: fails unless the command ends with that exit code; its output is in $work/stdout and $work/stderr.
ends() {
    local wanted=$1 found=0
    shift
    "$@" > "$work/stdout" 2> "$work/stderr" || found=$?
    [ $found -eq "$wanted" ] && return
    echo "FAIL: $*: exit code $found, expected $wanted"
    cat "$work/stderr"
    failed=$((failed + 1))
}

# expect CODE WORDS ARGUMENTS...: fails unless $host_sim ends with CODE in time, and stderr holds WORDS; output as of ends.
expect() {
    local code=$1 words=$2
    shift 2
    checked=$((checked + 1))
    ends "$code" timeout 600 "$host_sim" "$@"
    [ -z "$words" ] || holds grep -qF -- "$words" "$work/stderr"
}
