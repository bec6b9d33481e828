#!/bin/bash
# SPDX-License-Identifier: MIT
# What the console's page tells and offers to who holds the probe (console_sonographer.py). Called with the source and the
# build folder.
exec bash "$1/tests/machine/console/test_console_browser.sh" "$1" "$2" console_sonographer.py
