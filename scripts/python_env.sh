#!/bin/bash
# SPDX-License-Identifier: MIT
# python_env.sh VENV REQUIREMENTS [PYTHON]: a virtual environment with the versions of a requirements file. It is made anew when
# they or the interpreter change. Needs PyPI, but not for an environment that is there. Exit code 3: no index can be reached.
set -eu
venv=$1
wanted=$2
python=${3:-python3}
export PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_NO_INPUT=1

stop() {
    echo "python_env: $1" >&2
    exit 1
}

state=$(cat "$wanted" && "$python" -c 'import sys; print(sys.version)') || stop "'$python' does not run: install python3"
[ "$state" != "$(cat "$venv/made_of.txt" 2> /dev/null)" ] || exit 0
rm -rf "$venv"
"$python" -m venv "$venv" || stop "'$python -m venv' failed: is the Debian package python3-venv there?"
# What pip builds from source builds with these versions, too.
if ! PIP_RETRIES=${PIP_RETRIES:-2} PIP_CONSTRAINT=$wanted "$venv/bin/pip" install --quiet --no-compile -r "$wanted" 2> "$venv/log"; then
    tail -n 20 "$venv/log" >&2
    # pip says so of an index that does not answer at all; what the index lacks, it tells in other words.
    ! grep -qE '^WARNING: Retrying .* (connection broken|timed out)' "$venv/log" || exit 3
    stop "pip could not install $wanted; python3-dev must be installed"
fi
printf '%s\n' "$state" > "$venv/made_of.txt"
