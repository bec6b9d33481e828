# SPDX-License-Identifier: MIT
# Read by every script here, which names its own folder `work`: that becomes the place, and is gone at the end. Packages of pinned
# versions, and what was seen against what is seen now.
set -eu
trap 'rm -rf "$work"' EXIT
PYTHONPATH=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd) # ultrasound_picture.py
export PYTHONPATH PYTHONDONTWRITEBYTECODE=1
cd "${work:?}"

# packages NAME==VERSION...: from PyPI, into a virtual environment that goes with the folder. What they need comes as it is now.
packages() {
    [ -d venv ] || python3 -m venv venv
    echo "packages: $*"
    venv/bin/pip install --quiet --disable-pip-version-check "$@"
}

# seen LINES: what Python prints on the program that stands on the input must be these lines.
seen() {
    PYTHONWARNINGS=ignore venv/bin/python - > now.txt 2> errors.txt || { cat now.txt errors.txt; echo "CHANGED: it ended with an error"; exit 1; }
    printf '%s\n' "$1" > then.txt
    cat now.txt
    diff -u then.txt now.txt > difference.txt || { cat difference.txt; echo "CHANGED: not what was seen"; exit 1; }
    echo "as it was seen"
}
