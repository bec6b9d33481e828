#!/bin/bash
# SPDX-License-Identifier: MIT
# Guess: what PyPI gives for intel-opencl-rt is an OpenCL platform once its .icd file is named.
# Found: its library needs libimf, libsvml, libirng and libintlc, which no dependency brings. The loader leaves the platform out and
# tells nobody: no platform is found. With the package intel-cmplr-lib-rt beside it there is one.
work=$(mktemp -d)
# shellcheck source=findings/common.bash
. "$(dirname "$0")/common.bash"
packages pyopencl==2026.1.4 intel-opencl-rt==2026.2.0 numpy==2.4.6
mkdir vendors
echo "$work/venv/lib/libintelocl.so" > vendors/intel.icd
export OCL_ICD_VENDORS=$work/vendors LD_LIBRARY_PATH=$work/venv/lib
cat > ask.py << 'PYTHON'
import pyopencl
try:
    print("platforms:", *(platform.name for platform in pyopencl.get_platforms()))
except pyopencl.Error as error:
    print("platforms: none,", str(error).split(": ")[-1])
PYTHON
echo "needed and not there: $(ldd venv/lib/libintelocl.so | awk '/not found/ { print $1 }' | sort -u | xargs)"
seen 'platforms: none, PLATFORM_NOT_FOUND_KHR' < ask.py
packages intel-cmplr-lib-rt==2026.2.0
seen 'platforms: Intel(R) OpenCL' < ask.py
