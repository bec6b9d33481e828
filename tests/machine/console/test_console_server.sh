#!/bin/bash
# SPDX-License-Identifier: MIT
# The console's server on bare sockets (console_server.py, or another script of this folder). Called with the source and the
# build folder, and the script's name.
set -u
command -v python3 > /dev/null || {
    echo "skipped: no Python"
    exit 77
}
exec python3 -B "$1/tests/machine/console/${3:-console_server.py}" "$2"
