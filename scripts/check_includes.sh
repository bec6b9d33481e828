#!/bin/bash
# SPDX-License-Identifier: MIT
# check_includes.sh [ROOT]: the walls between the folders. Prints every breach; exit code 1 if there is one.
#
# - A file includes only what its floor may include, by the table below.
# - Nothing includes in a circle. A source and its header count as one: x.c and x.h.
# - Every source lies in a folder that the table knows.
set -eu
cd "${1:-$(dirname "$0")/..}"

# One line a floor: folders or files | what its "..." includes may name | which <...> groups it may use.
#   FOLDER  a file directly in it        .         its own folder
#   abi     include/, include/smartvis/  shared    cl/*/*_shared.h
#   any     whatever is found            kernels   the embedded kernels and pages that the build generates
# The first line that fits a file counts; * is any name, or a part of one.
floors() {
    cat <<'TABLE'
include                    |                                                            | fixed
include/smartvis/author*.h include/smartvis/lookup.h include/smartvis/probe.h | abi     | fixed libc
include/smartvis/open.h    | abi                                                        | fixed libc windows
include/smartvis           | abi                                                        | fixed
cl/common                  | .                                                          |
cl/*                       | cl/common .                                                |
src                        | shared .                                                   | libc
src/ref                    | shared src .                                               | libc
src/device                 | abi shared kernels .                                       | libc opencl
src/method                 | abi shared kernels src src/ref src/device .                | libc opencl
src/frame                  | abi shared kernels src src/ref src/device src/method .     | libc opencl
src/abi                    | abi shared src src/device src/method src/frame .           | libc opencl
host_sim/base              | .                                                          | libc json
host_sim/guard             | host_sim/base .                                            | libc
host_sim/volume            | host_sim/base .                                            | libc zlib
host_sim/picture           | host_sim/base .                                            | libc drawing
host_sim/plugin            | abi host_sim/base .                                        | libc
host_sim/scene             | host_sim/base host_sim/volume .                            | libc json
host_sim/render            | host_sim/base host_sim/volume kernels .                    | libc opencl
host_sim/render/cl         | .                                                          |
host_sim/guarded           | abi host_sim/base host_sim/guard host_sim/plugin host_sim/render . | libc opencl
host_sim/loop              | abi MACHINE .                                              | libc opencl
host_sim/result            | abi MACHINE host_sim/loop .                                | libc opencl
tools/machine/show         | abi MACHINE host_sim/picture host_sim/loop .               | libc opencl
tools/machine/commands     | abi HOST tools/machine/show .                              | libc opencl json
lab/page                   | host_sim/base host_sim/picture .                           | libc
lab/eval                   | abi MACHINE host_sim/loop .                                | libc opencl zlib
lab/report                 | abi HOST tools/machine/show tools/machine/commands lab/page lab/eval . | libc opencl json zlib
tools/machine/console      | abi HOST tools/machine/show tools/machine/commands kernels . | libc opencl json web
lab/bench                  | abi HOST .                                                 | libc opencl futex
lab/judge                  | abi HOST shared src src/ref tools/machine/show lab/page lab/eval . | libc opencl json
tools/sdk/layer            | abi tools/sdk/rules tools/sdk/record .                     | libc opencl
tools/sdk/record           | abi tools/sdk/rules .                                      | libc opencl zlib
tools/sdk/replay           | abi HOST tools/machine/show tools/sdk/rules tools/sdk/record . | libc opencl
tools/sdk/validate/spy     | .                                                          | libc opencl elf
tools/sdk/rules            | abi .                                                      | libc
tools/sdk/validate/drive   | abi host_sim/base host_sim/plugin tools/sdk/rules tools/sdk/validate/spy . | libc opencl
tools/sdk/validate/checks  | abi host_sim/base host_sim/plugin tools/sdk/rules tools/sdk/validate/spy tools/sdk/validate/drive . | libc opencl elf
tools/sdk/validate         | abi host_sim/base host_sim/guard tools/sdk/validate/drive tools/sdk/validate/checks . | libc json
tools/machine              | abi HOST tools/machine/commands lab/report tools/machine/console . | libc
examples/*                 | abi kernels .                                              | libc opencl
bindings/rust/src          | abi                                                        |
python/bench               | abi .                                                      | libc
tests/*                    | any kernels                                                | any
tests/*/*                  | any kernels                                                | any
TABLE
}
machine='host_sim/base host_sim/guard host_sim/volume host_sim/plugin host_sim/scene host_sim/render host_sim/guarded' # MACHINE
host="$machine host_sim/picture host_sim/loop host_sim/result" # HOST

# The groups of <...>, and where a "..." may be found from each part of the tree.
groups() {
    cat <<'TABLE'
fixed   stdint.h stddef.h
libc    assert.h ctype.h dirent.h dlfcn.h errno.h fcntl.h fenv.h float.h getopt.h glob.h inttypes.h limits.h locale.h
libc    math.h poll.h pthread.h sched.h setjmp.h signal.h stdalign.h stdarg.h stdatomic.h stdbool.h stddef.h stdint.h stdio.h stdlib.h
libc    string.h strings.h threads.h time.h unistd.h wchar.h sys/*
windows windows.h
opencl  CL/*
elf     elf.h link.h
futex   linux/futex.h
zlib    zlib.h
json    jansson.h
web     civetweb.h arpa/* netdb.h
drawing png.h turbojpeg.h cairo.h fontconfig/*
TABLE
}
roots() {
    cat <<'TABLE'
include  include
cl       cl
src      include src cl
host_sim include host_sim
tools    include tools/sdk tools/machine lab host_sim src cl
lab      include lab tools/machine host_sim src cl
examples include
bindings include
python   include
tests    include tests tools/sdk tools/machine lab host_sim src cl
TABLE
}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
floors | sed "s| HOST | $host |; s| MACHINE | $machine |" > "$work/floors"
groups > "$work/groups"
roots > "$work/roots"
find . \( -path './build*' -o -path ./out -o -path ./.git \) -prune -o \
    -type f \( -name '*.c' -o -name '*.h' -o -name '*.cl' -o -name '*.clh' \) -print | sed 's|^\./||' > "$work/sources"
# "FILE:LINE:TEXT" of every line that includes something.
xargs grep -nHE '^[[:space:]]*(#|%:)[[:space:]]*(include|import|embed)' < "$work/sources" > "$work/lines" || true

awk -v edges="$work/edges" '
function folder_of(path) { return match(path, /\/[^\/]*$/) ? substr(path, 1, RSTART - 1) : "." }
function unit_of(path) { sub(/\.[a-z]+$/, "", path); return path }
function complain(where, what) {
    print "include rule: " where ": " what
    failed = 1
}
# The line of the table for a file, 0 if there is none.
function floor_of(path,    i, folder, pattern) {
    folder = folder_of(path)
    for (i = 1; i <= floor_count; i++) {
        if (floor_name[i] == path || floor_name[i] == folder) return i
        pattern = floor_name[i]
        if (!gsub(/\*/, "[^/]*", pattern)) continue
        if ((pattern ~ /\.h$/ ? path : folder) ~ ("^" pattern "$")) return i
    }
    return 0
}
# Where the file of a "..." lies, "" if nowhere.
function resolve(from, name,    top, n, i, place, path) {
    path = folder_of(from) "/" name
    while (sub(/[^\/]+\/\.\.\//, "", path)) {}
    if (path in known) return path
    top = from
    sub(/\/.*/, "", top)
    n = split(root[top], place, " ")
    for (i = 1; i <= n; i++) if ((place[i] "/" name) in known) return place[i] "/" name
    return ""
}
function may_name(floor, from, name, path,    n, i, word) {
    n = split(floor_may[floor], word, " ")
    for (i = 1; i <= n; i++) {
        if (word[i] == "kernels" && name ~ /^((hs_)?kernels|hs_page)_[a-z_]+\.h$/) return 1
        if (path == "") continue
        if (word[i] == "any") return 1
        if (name ~ /\.\./) return 0
        if (word[i] == "abi" && path ~ /^include\/(smartvis\/)?[^\/]+$/) return 1
        if (word[i] == "shared" && path ~ /^cl\/[a-z_]+\/[a-z_]+_shared\.h$/) return 1
        if (word[i] == "." && folder_of(path) == folder_of(from)) return 1
        if (word[i] == folder_of(path)) return 1
    }
    return 0
}
function may_use(floor, name,    n, i, k, m, word, one) {
    n = split(floor_groups[floor], word, " ")
    for (i = 1; i <= n; i++) {
        if (word[i] == "any") return 1
        m = split(group[word[i]], one, " ")
        for (k = 1; k <= m; k++) {
            if (one[k] == name) return 1
            if (one[k] ~ /\*$/ && index(name, substr(one[k], 1, length(one[k]) - 1)) == 1) return 1
        }
    }
    return 0
}
FILENAME ~ /\/floors$/ {
    split($0, column, "|")
    n = split(column[1], name, " ")
    for (i = 1; i <= n; i++) {
        floor_name[++floor_count] = name[i]
        floor_may[floor_count] = column[2]
        floor_groups[floor_count] = column[3]
    }
    next
}
FILENAME ~ /\/(groups|roots)$/ {
    key = $1
    sub(/^[^ ]+ */, "")
    if (FILENAME ~ /groups$/) group[key] = group[key] " " $0
    else root[key] = $0
    next
}
FILENAME ~ /\/sources$/ { known[$0] = 1; next }
{
    match($0, /^[^:]*:[0-9]+:/)
    where = substr($0, 1, RLENGTH - 1)
    text = substr($0, RLENGTH + 1)
    from = where
    sub(/:[0-9]+$/, "", from)
    floor = floor_of(from)
    if (!floor) next # complained of below
    if (text ~ /^[ \t]*#[ \t]*include[ \t]*<[^>]*>/) {
        sub(/^[^<]*</, "", text)
        sub(/>.*/, "", text)
        if (!may_use(floor, text)) complain(where, "<" text "> is not for " folder_of(from))
    } else if (text ~ /^[ \t]*#[ \t]*include[ \t]*"[^"]*"/) {
        sub(/^[^"]*"/, "", text)
        sub(/".*/, "", text)
        path = resolve(from, text)
        if (!may_name(floor, from, text, path))
            complain(where, "\"" text "\" is not for " folder_of(from))
        if (path != "" && unit_of(path) != unit_of(from))
            print unit_of(from), unit_of(path) > edges
    } else {
        complain(where, "include a file by its name: " text)
    }
}
END {
    for (path in known) {
        if (!floor_of(path)) complain(path ":1", "a source in a folder without a rule")
    }
    exit failed
}' "$work"/{floors,groups,roots,sources,lines} || failed=1

# tsort names the members of every loop on lines of their own, after "tsort: ".
touch "$work/edges"
while read -r unit; do
    echo "include rule: $unit: in a circle of includes"
    failed=1
done < <(tsort "$work/edges" 2>&1 > /dev/null | sed -n 's/^tsort: //p' | grep -v 'contains a loop' || true)

exit "${failed:-0}"
