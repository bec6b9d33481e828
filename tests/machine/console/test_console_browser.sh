#!/bin/bash
# SPDX-License-Identifier: MIT
# The console's page in headless Chromium, by its own driver (console_browser.py, or another script of this folder), where
# there is one. Called with the source and the build folder, and the script's name.
set -u
for program in python3 chromedriver; do
    command -v "$program" > /dev/null || {
        echo "skipped: no $program"
        exit 77
    }
done
command -v chromium > /dev/null || command -v chromium-browser > /dev/null || command -v google-chrome > /dev/null || {
    echo "skipped: no Chromium"
    exit 77
}
exec python3 -B "$1/tests/machine/console/${3:-console_browser.py}" "$2"
