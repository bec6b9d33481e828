#!/bin/bash
# SPDX-License-Identifier: MIT
# slicer.sh BUILD: what 3D Slicer makes of the command-line module (docs/slicer.md). Its own parser, logic and storage nodes, from
# PyPI's slicer-core, take the module from a folder, write a scan for it, run it, and read its results. Needs PyPI, and BUILD/python of
# tests/python/environment.sh. Exit code 3: no index of Python packages can be reached.
set -eu
build=$(realpath "$1")
source=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$source/scripts/python_env.sh" "$build/slicer" "$source/python/requirements-slicer.txt"
export SMARTVIS_HOST_SIM=$build/host_sim
"$build/python/venv/bin/smartvis-slicer" --install "$work/modules"
cd "$work"
"$build/slicer/bin/python" -P "$source/scripts/slicer_nodes.py" "$work/modules" "$build/python/venv/bin/smartvis" > said 2>&1 || {
    cat said
    exit 1
}
tail -n 1 said
