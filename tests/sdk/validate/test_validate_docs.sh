#!/bin/bash
# SPDX-License-Identifier: MIT
# test_validate_docs.sh SOURCE_FOLDER BUILD_FOLDER: docs/validator.md has every check of sv_validate --list, in its order, and
# says why it is there; and no others.
set -eu
page=$1/docs/validator.md
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$2/sv_validate" --list | sed -nE 's/^([a-z0-9-]+) +[A-Za-z].*/\1/p' > "$work/program"
# Rows of an id and a reason of ten letters or more.
sed -nE '/^## The library/,$s/^\| `([a-z0-9-]+)` \| [A-Z][^|]{10,} \|$/\1/p' "$page" > "$work/page"
diff "$work/program" "$work/page"
