#!/bin/bash
# SPDX-License-Identifier: MIT
# environment.sh SOURCE BUILD PYTHON: a virtual environment in BUILD/python/venv with the versions of
# python/requirements-test.txt, and in it the wheel, built from SOURCE. The environment is made anew when the versions
# change, the wheel every time. Needs PyPI, but not for an environment that is there.
set -eu
source=$1
folder=$2/python
python=$3
wanted=$source/python/requirements-test.txt
venv=$folder/venv
export PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_NO_INPUT=1

missing() {
    echo "python/environment: $1" >&2
    exit 1
}

mkdir -p "$folder"
if ! cmp -s "$wanted" "$venv/wanted.txt"; then
    rm -rf "$venv"
    "$python" -m venv "$venv" || missing "'$python -m venv' failed: is the Debian package python3-venv there?"
    # What pip builds from source builds with these versions, too.
    PIP_CONSTRAINT=$wanted "$venv/bin/pip" install --quiet --no-compile -r "$wanted" ||
        missing "pip could not install python/requirements-test.txt: PyPI must be reachable, and python3-dev installed"
    cp "$wanted" "$venv/wanted.txt"
fi

rm -rf "$folder/wheel"
"$venv/bin/pip" wheel --quiet --no-build-isolation --no-deps --wheel-dir "$folder/wheel" "$source/python" ||
    missing "the wheel did not build"
"$venv/bin/pip" install --quiet --force-reinstall --no-deps "$folder"/wheel/smartvis-*.whl || missing "the wheel did not install"
"$venv/bin/pip" check
cd "$folder" && "$venv/bin/python" -c 'import smartvis; print(smartvis.__version__, smartvis.load())'
