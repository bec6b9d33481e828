#!/bin/bash
# SPDX-License-Identifier: MIT
# dist.sh FOLDER: the sources of the checked-out commit as FOLDER/smartvis-VERSION.tar.gz. The same commit gives the same
# bytes: git takes all times from the commit, and gzip writes none. What is not committed is left out. Prints the path.
set -eu
folder=$1
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
cd "$(dirname "$0")/.."
version=$(sed -n 's/^project(smartvis VERSION \([0-9.]*\) .*/\1/p' CMakeLists.txt)
[ -n "$version" ] || { echo "dist: CMakeLists.txt names no version" >&2; exit 1; }
name=smartvis-$version
[ -z "$(git status --porcelain)" ] || echo "dist: what is not committed is left out" >&2
git -c tar.umask=0022 archive --format=tar --prefix="$name/" -o "$folder/$name.tar" HEAD
gzip -9nf "$folder/$name.tar"
echo "$folder/$name.tar.gz"
