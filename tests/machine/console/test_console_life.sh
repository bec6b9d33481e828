#!/bin/bash
# SPDX-License-Identifier: MIT
# How the console starts and ends (console_life.py), with SV_NIGHT more often. Called with the source and the build folder.
exec bash "$1/tests/machine/console/test_console_server.sh" "$1" "$2" console_life.py
