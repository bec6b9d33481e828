#!/bin/bash
# SPDX-License-Identifier: MIT
# `make` without its packages names them and stops there; CMake has no word. A step is one line, its output in a log. Called with the source and the build folder.
set -u
source_dir=$1
# shellcheck source=tests/support/holds.sh
. "$source_dir/tests/support/holds.sh"
command -v dpkg-query > /dev/null || {
    echo "skipped: no Debian"
    exit 77
}

mkdir "$work/scripts"
cp "$source_dir/Makefile" "$work"
cp "$source_dir/scripts/setup.sh" "$work/scripts"
printf '# needed\nbash\nno-such-package-a  # why\nno-such-package-b\n' > "$work/scripts/packages.txt"
ends 2 make -C "$work"
holds grep -qx 'setup: missing Debian packages: no-such-package-a no-such-package-b' "$work/stderr"
holds grep -q 'apt-get install .* no-such-package-a no-such-package-b$' "$work/stderr"
holds [ "$(grep -ci 'cmake error' "$work/stdout" "$work/stderr" | cut -d : -f 2 | paste -sd +)" = 0+0 ]
holds [ "$(wc -l < "$work/stderr")" -le 6 ]

# With all of them there is nothing to say.
printf 'bash\n' > "$work/scripts/packages.txt"
ends 0 "$work/scripts/setup.sh" --check "$work/scripts/packages.txt"
holds [ ! -s "$work/stderr" ]

# A step that fails shows the end of its log and hands on its code; one that passes at once says nothing.
quietly=$source_dir/scripts/quietly.sh
ends 3 "$quietly" name "$work/log/a" sh -c 'seq 100; exit 3'
holds [ "$(head -n 1 "$work/stderr") $(wc -l < "$work/stderr") $(wc -l < "$work/log/a")" = "61 41 100" ]
holds grep -qx "name: FAILED after [0-9]* s, exit code 3; above is the end of $work/log/a" "$work/stderr"
ends 0 "$quietly" name "$work/log/a" sh -c 'echo noise; echo more >&2'
holds [ "$(cat "$work/stdout" "$work/stderr")" = "" ]
holds [ "$(paste -sd ' ' "$work/log/a")" = "noise more" ]
ends 0 "$quietly" name "$work/log/a" sleep 2
holds grep -qx "name: done in [0-9]* s, log $work/log/a" "$work/stdout"

# The example scan is taken if it is the file that it should be, and not before. A stand-in fetches.
mkdir "$work/bin"
printf '#!/bin/sh\nprintf "NRRD0004\\ntype: unsigned char\\n\\nvoxels" > "$6"\n' > "$work/bin/curl"
chmod +x "$work/bin/curl"
PATH=$work/bin:$PATH ends 1 "$source_dir/scripts/example_scan.sh" "$work/example"
holds grep -q 'ultrasound.nrrd is another file: its SHA-256 is [0-9a-f]*, not 2173f351' "$work/stderr"
holds [ ! -e "$work/example/real/fetus_12w.mha" ]

echo "$checked checks, $failed failed"
[ "$failed" -eq 0 ]
