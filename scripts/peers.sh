#!/bin/bash
# SPDX-License-Identifier: MIT
# peers.sh BUILD_FOLDER OUT [--write]: what programs and libraries around a volume read of our results, and we of what they write, as a
# table in Markdown. It must be the one in docs/peers.md; --write puts it there. They come from PyPI, in the versions of
# scripts/peers/, into environments in OUT; our side is the tests' environment of BUILD_FOLDER. Exit code 3: PyPI cannot be reached.
set -eu
checkout=$(cd "$(dirname "$0")/.." && pwd)
build=$(cd "$1" && pwd)
mkdir -p "$2"
out=$(cd "$2" && pwd)
scripts=$checkout/scripts
"$scripts/python_env.sh" "$out/peers" "$scripts/peers/requirements.txt"
"$scripts/python_env.sh" "$out/slicer" "$checkout/python/requirements-slicer.txt"
export OURS=$build/python/venv/bin/python PEERS=$out/peers/bin/python SLICER=$out/slicer/bin/python
export SMARTVIS_HOST_SIM=$build/host_sim PYTHONDONTWRITEBYTECODE=1 POCL_CACHE_DIR=$build/pocl_cache

rm -rf "$out/files"
mkdir "$out/files"
"$OURS" "$scripts/peers/ours.py" make "$out/files" > "$out/made.log"
python3 "$scripts/peers/table.py" "$out/files" "$checkout/docs/peers.md" "${@:3}" 2> "$out/said.log" ||
    { grep '^peers: ' "$out/said.log" || tail -n 20 "$out/said.log"; exit 1; }
