#!/bin/bash
# SPDX-License-Identifier: MIT
# The console's brush, and undo and redo (console_brush.py). Called with the source and the build folder.
exec bash "$1/tests/machine/console/test_console_browser.sh" "$1" "$2" console_brush.py
