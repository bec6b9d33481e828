#!/bin/bash
# SPDX-License-Identifier: MIT
# The console as the author of a plugin uses it (console_author.py). Called with the source and the
# build folder.
exec bash "$1/tests/machine/console/test_console_browser.sh" "$1" "$2" console_author.py
