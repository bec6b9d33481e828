#!/bin/bash
# SPDX-License-Identifier: MIT
# check_calls.sh BUILD_FOLDER: who calls whom, as the linker sees it. Prints every circle; exit code 1 if there is one.
#
# Includes do not tell all: a header may declare what another file of a higher floor defines. So this takes the symbols of the
# objects of src/, host_sim/, tools/ and lab/. An arrow leads from a source to each source whose function or object it uses. Neither
# sources nor their folders may form a circle; check_includes.sh says which folder is the lower one.
set -eu
build=$(realpath "$1")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# "PATH_OF_OBJECT KIND SYMBOL" of all external symbols; the path of a source is behind "CMakeFiles/TARGET.dir/".
find "$build/obj" -name '*.c.o' -not -path '*/obj/tests/*' -not -path '*/obj/examples/*' -print0 |
    xargs -0 nm -A -g -P > "$work/symbols"

awk -v folders="$work/folders" -v sources="$work/sources" '
function source_of(object) {
    sub(/^.*\/obj\//, "", object)
    sub(/CMakeFiles\/[^\/]*\.dir\//, "", object)
    sub(/\.c\.o.*$/, ".c", object)
    return object
}
function folder_of(path) { sub(/\/[^\/]*$/, "", path); return path }
{
    from = source_of($1)
    if ($3 == "U") { using[++count] = from; used[count] = $2 }
    else if ($3 != "w") owner[$2] = (from ~ /\/spy\//) ? owner[$2] : from # spies define the names of libc and OpenCL
}
END {
    for (i = 1; i <= count; i++) {
        to = owner[used[i]]
        if (to == "" || to == using[i]) continue
        print using[i], to > sources
        if (folder_of(to) != folder_of(using[i])) print folder_of(using[i]), folder_of(to) > folders
    }
}' "$work/symbols"

# tsort names the members of every loop on lines of their own, after "tsort: ".
failed=0
for graph in sources folders; do
    while read -r member; do
        echo "calls: $member: in a circle of $graph"
        failed=1
    done < <(sort -u "$work/$graph" | tsort 2>&1 > /dev/null | sed -n 's/^tsort: //p' | grep -v 'contains a loop' || true)
done
echo "calls: $(sort -u "$work/sources" | wc -l) arrows between sources, $(sort -u "$work/folders" | wc -l) between folders"
exit $failed
