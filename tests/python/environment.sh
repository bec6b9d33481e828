#!/bin/bash
# SPDX-License-Identifier: MIT
# environment.sh SOURCE BUILD PYTHON: a virtual environment in BUILD/python/venv with the versions of
# python/requirements-test.txt, and in it the wheel, built from SOURCE. The environment is made anew when the versions
# change, the wheel every time. Where no index of Python packages can be reached, these tests are skipped.
set -eu
source=$(realpath "$1")
folder=$(realpath -m "$2")/python
venv=$folder/venv
export PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_NO_INPUT=1

missing() {
    echo "python/environment: $1" >&2
    exit 1
}

mkdir -p "$folder"
code=0
"$source/scripts/python_env.sh" "$venv" "$source/python/requirements-test.txt" "$3" || code=$?
if [ $code = 3 ]; then
    echo "skipped: no index of Python packages (PyPI) can be reached"
    exit 77
fi
[ $code = 0 ] || missing "there is no environment"

rm -rf "$folder/wheel"
# Without host_sim: it is built already, and scripts/wheel.sh has one of its own.
"$venv/bin/pip" wheel --quiet --no-build-isolation --no-deps --config-settings build-dir="$folder/plugin" \
    --config-settings cmake.define.SV_HOST_SIM=OFF --wheel-dir "$folder/wheel" "$source/python" ||
    missing "the wheel did not build"
"$venv/bin/pip" install --quiet --force-reinstall --no-deps "$folder"/wheel/smartvis-*.whl || missing "the wheel did not install"
"$venv/bin/pip" check
cd "$folder" && "$venv/bin/python" -c 'import smartvis; print(smartvis.__version__, smartvis.load())'
