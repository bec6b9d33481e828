#!/bin/bash
# SPDX-License-Identifier: MIT
# The evaluation's page and the demo's in headless Chromium, where there is one: no console error, a picture on the first screen,
# nothing that scrolls sideways when all is opened, dark colours where they are asked for, labels that a screen shows; and the
# evaluation's slider shows another picture. At night of all nine cases.
# Called with the source and the build folder.
set -u
build=$2
browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome) || {
    echo "skipped: no Chromium"
    exit 77
}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
few=(--case E04 --case D01)
[ -z "${SV_NIGHT:-}" ] || few=()
"$build/host_sim" report --quick --size 48 --frames 1 "${few[@]}" --out "$work/report" > /dev/null 2>&1 || exit 1
"$build/host_sim" demo --quick --picture 64 --out "$work/demo" > /dev/null 2>&1 || exit 1

# shows PAGE WIDTH SCHEME WANTED: what the page's last script tells, and an empty console. The page stands in a frame of that width,
# since a window is 500 pixels wide at least.
shows() {
    printf '<title>none</title><script>onmessage = function (e) { document.title = e.data; };</script><iframe src="file://%s" width="%s" height="900"></iframe>' \
        "$1" "$2" > "$work/frame.html"
    timeout 600 "$browser" --headless --no-sandbox --disable-gpu --user-data-dir="$work/profile" --enable-logging=stderr \
        --blink-settings=preferredColorScheme="$3" --window-size=1400,1000 --dump-dom "file://$work/frame.html" > "$work/dom" 2> "$work/log" || {
        echo "FAIL: the browser ended with $?"
        tail -n 5 "$work/log"
        exit 1
    }
    title=$(grep -o '<title>seen[^<]*' "$work/dom" | head -n 1)
    if [ "$title" != "<title>seen $4" ]; then
        echo "FAIL: $1 at $2 pixels gave '$title', expected '$4'"
        exit 1
    fi
    if grep CONSOLE "$work/log"; then
        echo "FAIL: the console is not empty"
        exit 1
    fi
}

# fits: no element scrolls sideways. legible: what a screen
# wider than a phone's shows of the smallest letters, 17 pixels in a map, 19 in the slices, 18 in a strip of views; a plot's may
# be turned.
cat > "$work/look.js" << 'SCRIPT'
document.querySelectorAll('details').forEach(function (fold) { fold.open = true; });
function fits() {
    return Array.from(document.querySelectorAll('html, body *')).every(function (e) { return e.scrollWidth <= e.clientWidth || e.clientWidth === 0 || e.closest('svg'); })
        && document.documentElement.scrollWidth <= window.innerWidth;
}
function legible() {
    var phone = window.innerWidth < 500;
    return Array.from(document.querySelectorAll('.row.wide img')).every(function (i) {
        return phone || 17 * i.getBoundingClientRect().width / i.naturalWidth >= 8;
    }) && Array.from(document.querySelectorAll('svg.plot text')).every(function (text) {
        var box = text.getBoundingClientRect();
        return Math.min(box.width, box.height) >= (phone ? 8 : 11) || box.width === 0 || text.textContent.length < 2;
    });
}
SCRIPT

# The page, and a script that turns its slider as a user would, then writes what it sees into the title.
cat "$work/report/index.html" <(printf '<script>\nvar height = document.documentElement.scrollHeight; /* as a reader first sees it */\n') \
    "$work/look.js" - > "$work/turned.html" << 'SCRIPT'
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
parent.postMessage(['seen', first !== null, last !== null, first && last && first.src !== last.src,
    last && last.naturalWidth > 0, input.getAttribute('aria-valuetext'), document.activeElement === input,
    document.querySelector('img').getBoundingClientRect().bottom + window.scrollY <= 844, height <= 15000, fits(), legible()].join(' '), '*');
</script>
SCRIPT
for width in 390 1280; do shows "$work/turned.html" $width 1 'true true true true q = 1.5 true true true true true'; done

# The demo, in the colours that were asked for.
cat "$work/demo/index.html" <(echo '<script>') "$work/look.js" - > "$work/seen.html" << 'SCRIPT'
parent.postMessage(['seen', document.querySelectorAll('.row.wide img').length > 0 && legible(), fits(), getComputedStyle(document.body).backgroundColor].join(' '), '*');
</script>
SCRIPT
for width in 390 1280; do
    shows "$work/seen.html" $width 1 'true true rgb(255, 255, 255)'
    shows "$work/seen.html" $width 0 'true true rgb(22, 24, 27)'
done

# Contrast, dark, print and the tab key, by the browser's own driver.
command -v chromedriver > /dev/null || exit 0
python3 -B "$1/tests/machine/console/page_looks.py" "$work/report/index.html" "$work/demo/index.html"
