#!/bin/bash
# SPDX-License-Identifier: MIT
# git diff --name-only COMMIT | concerned.sh: the parts whose tests these files concern, a line each, the house's always; "all" where the
# public header, or what all parts share, is at stake.
set -eu
awk "$(cat "$(dirname "$0")/part_of.awk")"'
    /^include\// || part_of($0) == "rest" { all = 1 }
    { n = split(concerned(part_of($0)), parts, " "); for (i = 1; i <= n; i++) changed[parts[i]] }
    END { if (all) print "all"; else { print "house"; for (part in changed) print part } }'
