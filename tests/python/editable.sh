#!/bin/bash
# SPDX-License-Identifier: MIT
# editable.sh SOURCE BUILD: `pip install -e ./python` clips: plugin, machine and ABI are found beside sources that have none.
set -eu
folder=$2/python
venv=$folder/venv
. "$1/tests/support/holds.sh"
if [ ! -x "$venv/bin/pip" ]; then # environment.sh says why
    echo "skipped: no index of Python packages (PyPI) can be reached"
    exit 77
fi
"$venv/bin/python" -m venv --without-pip "$work/venv"
site=$("$venv/bin/python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')
# Where environment.sh built the plugin, so that it is not compiled again.
PYTHONPATH=$site "$venv/bin/pip" --python "$work/venv/bin/python" install --quiet --disable-pip-version-check --no-build-isolation \
    --no-deps --config-settings build-dir="$folder/plugin" --config-settings cmake.define.SV_HOST_SIM=OFF -e "$1/python"
cat > "$work/clip.py" << 'END_PYTHON'
import sys
import numpy, smartvis
from smartvis import _places
volume = numpy.full((48, 32, 32), 200, numpy.uint8)
volume[:30], volume[:8] = 10, 100
print(smartvis.__file__, smartvis.load().path, smartvis.clip(volume, (1, 1, 1)).outcome.name, _places.built("host_sim"))
END_PYTHON
echo "$site" > "$(echo "$work"/venv/lib/python*/site-packages)/zz_numpy.pth" # behind its own
cd "$work"
env -u SMARTVIS_PLUGIN -u PYTHONPATH "$work/venv/bin/python" -P clip.py > said
read -r package plugin outcome host < said
holds [ "$package" = "$1/python/smartvis/__init__.py" ]
holds [ "${plugin#"$work"/venv/lib/python*/site-packages/}" = smartvis/plugin/smartvis.so ]
holds [ "$outcome" = OK ]
holds [ "$host" = "$1/build/host_sim" ]
echo "$checked checked, $failed failed"
[ "$failed" = 0 ]
