#!/bin/bash
# SPDX-License-Identifier: MIT
# run_pytest.sh SOURCE BUILD FILE: one file of tests with the installed package, from a folder where its sources are not seen.
set -eu
export SMARTVIS_HOST_SIM=$2/host_sim
export PYTHONUNBUFFERED=1 # what a test that is ended had to say
unset SMARTVIS_PLUGIN
# What Python compiles is kept for all tests, and not beside the sources. Without, most of their time goes into that.
unset PYTHONDONTWRITEBYTECODE
export PYTHONPYCACHEPREFIX=$2/python/pycache
cd "$2/python"
if [ ! -x venv/bin/pytest ]; then # environment.sh says why
    echo "skipped: no index of Python packages (PyPI) can be reached"
    exit 77
fi
marked="not night"
[ -z "${SV_NIGHT:-}" ] || marked=night
exec venv/bin/python -P -m pytest -q -m "$marked" -c "$1/python/pyproject.toml" --rootdir "$1/python" "$3"
