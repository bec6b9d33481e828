#!/bin/bash
# SPDX-License-Identifier: MIT
# `make` without its packages names them and stops there; CMake has no word. Called with the source and the build folder.
set -u
source_dir=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
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
echo "$checked checks, $failed failed"
[ "$failed" -eq 0 ]
