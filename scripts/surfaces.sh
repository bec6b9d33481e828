#!/bin/bash
# SPDX-License-Identifier: MIT
# surfaces.sh COMMAND [OPTIONS]: the judges of surfaces (lab/surfaces; --help tells) with the plugin and the machine of build/.
# `make sites` builds what they need.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
mkdir -p "$root/build/python"
"$root/scripts/python_env.sh" "$root/build/python/bench" "$root/python/requirements-test.txt"
export PYTHONPATH=$root/python SMARTVIS_PLUGIN=$root/build/smartvis.so SMARTVIS_HOST_SIM=$root/build/host_sim
exec "$root/build/python/bench/bin/python" -B "$root/lab/surfaces" "$@"
