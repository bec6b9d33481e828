#!/bin/bash
# SPDX-License-Identifier: MIT
# cmake/stamp.cmake: the version names the commit that is built, of a checkout by git and of an archive by what `git archive` wrote;
# what differs from it is marked; a commit that is no other rebuilds nothing. Called with the source and the build folder.
# Requirement: R17.
set -u
source_dir=$1
# shellcheck source=tests/support/holds.sh
. "$source_dir/tests/support/holds.sh"
if ! command -v git > /dev/null; then
    echo "skipped: git is missing"
    exit 77
fi
export GIT_CONFIG_GLOBAL=/dev/null GIT_AUTHOR_NAME=a GIT_AUTHOR_EMAIL=a@b GIT_COMMITTER_NAME=a GIT_COMMITTER_EMAIL=a@b

says() { # says SOURCES TEXT: of sources, commit.txt and version agree on it
    cmake -DVERSION=1.2.3 "-DSOURCE=$1" "-DHEADER=$work/out/v.h" "-DCOMMIT=$work/out/commit.txt" -P "$source_dir/cmake/stamp.cmake" || return 1
    local version
    version=$(sed -n 's/^#define SV_VERSION "\(.*\)"$/\1/p' "$work/out/v.h")
    [ "$version" = "1.2.3${2:++$2}" ] && [ "$(cat "$work/out/commit.txt")" = "$2" ] && return
    echo "of $1: '$version', commit '$(cat "$work/out/commit.txt")', expected '$2'"
    return 1
}

mkdir -p "$work/of us/cmake"
cp "$source_dir/cmake/commit.txt" "$work/of us/cmake"
cp "$source_dir/.gitattributes" "$work/of us"
if grep -q '^[0-9a-f]*$' "$source_dir/cmake/commit.txt"; then
    # shellcheck disable=SC2016  # git's, not the shell's
    printf '$Format:%%H$\n' > "$work/of us/cmake/commit.txt" # these sources are an archive
fi
holds says "$work/of us" ""
git -C "$work/of us" init -q
holds says "$work/of us" ""
git -C "$work/of us" add .
git -C "$work/of us" commit -q -m one
commit=$(git -C "$work/of us" rev-parse HEAD | head -c 12)
holds says "$work/of us" "$commit"

# Nothing is written that says so already.
touch -d '2001-01-01' "$work/out/v.h" "$work/out/commit.txt"
holds says "$work/of us" "$commit"
holds [ -z "$(find "$work/out" -newermt '2002-01-01' -type f)" ]

# Files that differ, and files that git does not know: sources are found by their places.
echo >> "$work/of us/.gitattributes"
holds says "$work/of us" "$commit.changed"
git -C "$work/of us" checkout -q .
touch "$work/of us/more.c"
holds says "$work/of us" "$commit.changed"
rm "$work/of us/more.c"

# An archive knows it without git, also inside of another repository.
mkdir "$work/other" "$work/other/ours"
git -C "$work/of us" archive HEAD | tar -x -C "$work/other/ours"
holds says "$work/other/ours" "$commit"
cp "$work/of us/cmake/commit.txt" "$work/other/ours/cmake"
git -C "$work/other" init -q
git -C "$work/other" add .
git -C "$work/other" commit -q -m two
holds says "$work/other/ours" ""

echo "$checked checked, $failed failed"
[ "$failed" = 0 ]
