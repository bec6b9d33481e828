#!/bin/bash
# SPDX-License-Identifier: MIT
# test_validate_docs.sh SOURCE_FOLDER BUILD_FOLDER: docs/validator.md has every check of sv_validate --list, in its order and
# with its sentence, why it is there and how to mend it; and no others.
set -eu
page=$1/docs/validator.md
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$2/sv_validate" --list | sed -E 's/^([a-z0-9-]+) +/\1: /' > "$work/program"
sed -nE '/^### /{s/^### //;h;n;H;g;s/\n/: /;p}' "$page" > "$work/page"
diff "$work/program" "$work/page"
checks=$(wc -l < "$work/program")
for part in Why Mend; do
    count=$(grep -cE "^\*\*$part\*\*: [A-Z].{10,}" "$page")
    [ "$count" -eq "$checks" ] || { echo "docs/validator.md: $count times '$part', $checks checks"; exit 1; }
done
