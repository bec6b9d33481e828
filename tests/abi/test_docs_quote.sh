#!/bin/bash
# SPDX-License-Identifier: MIT
# docs/abi.md quotes whole files that are built and tested: a block of C whose line before it reads `<!-- FILE -->` holds that
# file's text, all but its licence line. And the number of functions that it names is that of struct sv_plugin.
set -u
source_dir=$1
page=$source_dir/docs/abi.md
failures=0
quotes=0
while read -r file; do
    quotes=$((quotes + 1))
    quoted=$(awk -v mark="<!-- $file -->" '$0 == mark { found = 1; next } found && /^```/ { if (inside) exit; inside = 1; next } inside' "$page")
    if [ ! -f "$source_dir/$file" ] || ! diff <(tail -n +2 "$source_dir/$file") <(printf '%s\n' "$quoted"); then
        echo "$page: the quote of $file differs from the file"
        failures=$((failures + 1))
    fi
done < <(sed -n 's/^<!-- \(examples\/.*\) -->$/\1/p' "$page")
[ $quotes = 2 ] || { echo "$page: $quotes quotes, expected 2"; failures=$((failures + 1)); }

# The page has no other C of several lines, which nobody would compile.
[ "$(grep -c '^```c$' "$page")" = $quotes ] || { echo "$page: C that is no quote"; failures=$((failures + 1)); }

words=(none one two three four five six seven eight nine ten eleven twelve thirteen fourteen)
functions=$(sed -n '/^struct sv_plugin {/,/^};/p' "$source_dir/include/smartvis_plugin.h" | grep -c '(SV_CALL \*')
grep -q "the ${words[$functions]} functions of \`sv_plugin\`" "$page" ||
    { echo "$page does not say that sv_plugin has ${words[$functions]} functions"; failures=$((failures + 1)); }
[ $failures = 0 ]
