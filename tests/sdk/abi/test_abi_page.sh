#!/bin/bash
# SPDX-License-Identifier: MIT
# docs/abi.md links to the examples' sources and quotes none, so no C stands there that nobody compiles. And the number of
# functions that it names is that of struct sv_plugin.
set -u
source_dir=$1
page=$source_dir/docs/abi.md
failures=0
for file in first_edge/first_edge.c small_host/small_host.c; do
    grep -q "(../examples/$file)" "$page" || { echo "$page does not lead to $file"; failures=$((failures + 1)); }
done
grep -q '^```c$' "$page" && { echo "$page: C that nobody compiles"; failures=$((failures + 1)); }

words=(none one two three four five six seven eight nine ten eleven twelve thirteen fourteen)
functions=$(sed -n '/^struct sv_plugin {/,/^};/p' "$source_dir/include/smartvis_plugin.h" | grep -c '(SV_CALL \*')
grep -q "the ${words[$functions]} functions of \`sv_plugin\`" "$page" ||
    { echo "$page does not say that sv_plugin has ${words[$functions]} functions"; failures=$((failures + 1)); }
[ $failures = 0 ]
