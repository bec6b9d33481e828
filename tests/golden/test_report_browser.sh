#!/bin/bash
# SPDX-License-Identifier: MIT
# The evaluation's page in headless Chromium, where there is one: no console error, and the slider shows
# another picture. Called with the source and the build folder.
set -u
build=$2
browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome) || {
    echo "skipped: no Chromium"
    exit 77
}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$build/host_sim" report --quick --size 72 --case D01 --frames 0 --out "$work/report" > /dev/null 2>&1 || exit 1

# The page, and a script that turns its slider as a user would, then writes what it sees into the title.
cat "$work/report/index.html" - > "$work/turned.html" << 'SCRIPT'
<script>
var slider = document.querySelector('.slider'), input = slider.querySelector('input');
function seen() {
    var all = Array.from(slider.querySelectorAll('figure')).filter(function (f) { return f.offsetHeight > 0; });
    return all.length === 1 ? all[0].querySelector('img') : null;
}
input.value = 0; input.dispatchEvent(new Event('input'));
var first = seen();
input.value = input.max; input.dispatchEvent(new Event('input'));
var last = seen();
input.focus();
document.title = [first !== null, last !== null, first && last && first.src !== last.src,
    last && last.naturalWidth > 0, input.getAttribute('aria-valuetext'), document.activeElement === input,
    document.documentElement.scrollWidth <= window.innerWidth].join(' ');
</script>
SCRIPT
for width in 390 1280; do
    timeout 600 "$browser" --headless --no-sandbox --disable-gpu --user-data-dir="$work/profile" --enable-logging=stderr \
        --window-size=$width,900 --dump-dom "file://$work/turned.html" > "$work/dom" 2> "$work/log" || {
        echo "FAIL: the browser ended with $?"
        tail -n 5 "$work/log"
        exit 1
    }
    title=$(grep -o '<title>[a-z][^<]*' "$work/dom" | head -n 1)
    if [ "$title" != "<title>true true true true q = 1.5 true true" ]; then
        echo "FAIL: at $width pixels the slider gave '$title'"
        exit 1
    fi
    if grep CONSOLE "$work/log"; then
        echo "FAIL: the console is not empty"
        exit 1
    fi
done
