#!/bin/bash
# SPDX-License-Identifier: MIT
# man_page.sh PROGRAM OUT: the manual page of a program of ours, made from its --help, its --version and the --help of each
# of its commands. The house form of a help text is what is read: "Usage:" lines, one sentence, then blocks whose items
# begin in the third column and have their text two blanks or more behind.
set -eu
program=$1
out=$2
name=$(basename "$program")
export LC_ALL=C

# Troff's own characters, and a minus that can be searched for and copied.
escape() { sed -e 's/\\/\\e/g' -e 's/-/\\-/g' -e "s/^\\([.']\\)/\\\\\\&\\1/"; }

# One help text, from its first line to its last: the usage as it stands, items as tagged paragraphs.
body() {
    escape | awk '
    function gap(text,    rest, at) { # where the text of an item begins, 0 if nowhere
        rest = substr(text, 3)
        if (match(rest, /  +/)) { at = RSTART + RLENGTH + 2 } else { at = column }
        if (at > 1 && substr(text, at, 1) != "" && substr(text, at - 1, 1) == " ") return at
        return 0
    }
    # A line that begins so would be a request to troff.
    function shown(text) { return (text ~ /^[.\047]/ ? "\\&" : "") text }
    /^Usage: / { print ".B " substr($0, 8); print ".br"; used = 1; next }
    used && /^       / { print ".B " substr($0, 8); print ".br"; next }
    { used = 0 }
    /^$/ { print ".PP"; next }
    /^[^ ].*:$/ { print ".SS " substr($0, 1, length($0) - 1); next }
    /^  [^ ]/ {
        at = gap($0)
        print ".TP"
        if (at) {
            column = at
            tag = substr($0, 3, at - 3)
            sub(/ +$/, "", tag)
            print ".B " tag
            print shown(substr($0, at))
        } else {
            print ".B " substr($0, 3)
        }
        next
    }
    { sub(/^ +/, ""); print shown($0) }'
}

help=$("$program" --help)
version=$("$program" --version | head -n 1 | escape)
summary=$(grep -vE -m 1 '^(Usage: |       |$)' <<< "$help" | sed 's/\.\( .*\)*$//' | escape)
[ -n "$summary" ] || { echo "man_page: $program --help has no sentence behind its usage" >&2; exit 1; }
commands=()
if grep -q "^Usage: $name COMMAND" <<< "$help"; then
    mapfile -t commands < <(awk '/^$/ && found { exit } /^  [a-z]+  / { print $1; found = 1 }' <<< "$help")
fi

mkdir -p "$(dirname "$out")"
{
    printf '.\\" Made by scripts/man_page.sh from what the program says of itself.\n'
    printf '.TH %s 1 "" "%s" "SmartVis"\n' "${name^^}" "$version"
    printf '.SH NAME\n%s \\- %s\n.SH SYNOPSIS\n' "$name" "$summary"
    body <<< "$(grep -E '^Usage: ' <<< "$help")"
    printf '.SH DESCRIPTION\n'
    body <<< "$(grep -vE '^Usage: ' <<< "$help")"
    for command in "${commands[@]}"; do
        printf '.SH COMMAND %s\n' "${command^^}"
        # The exit codes are those above.
        body <<< "$("$program" "$command" --help | sed '/^Exit codes:$/,$d')"
    done
} | awk '$0 == ".PP" { held = 1; next } { if (held && !/^\.(S[HS]|TP)/) print ".PP"; held = 0; print }' > "$out.part"
mv "$out.part" "$out"
