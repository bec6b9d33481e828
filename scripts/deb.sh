#!/bin/bash
# SPDX-License-Identifier: MIT
# deb.sh FOLDER: Debian packages of the checked-out commit in FOLDER, source and binary, built from scripts/dist.sh as a packager
# would. lintian reads them; an error of its fails. The tests are not run once more here: `make test` does.
set -eu
folder=$1
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
cd "$(dirname "$0")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
tarball=$(scripts/dist.sh "$work")
tar -xf "$tarball" -C "$work"
cd "${tarball%.tar.gz}"
version=$(basename "$PWD" | sed 's/^smartvis-//')
[ "$(dpkg-parsechangelog -S Version)" = "$version" ] || { echo "deb: debian/changelog is not of version $version" >&2; exit 1; }

# Everything in the package is as old as the changelog says; dpkg sees to that by SOURCE_DATE_EPOCH.
log=$work/build.log
if ! DEB_BUILD_OPTIONS="nocheck parallel=$(nproc)" dpkg-buildpackage -us -uc -F > "$log" 2>&1; then
    tail -n 60 "$log"
    exit 1
fi
cd "$work"
# Of an unofficial package there is no bug report that it closes. The packages are built by whoever may: root, too.
lintian --allow-root --fail-on error --suppress-tags initial-upload-closes-no-bugs --tag-display-limit 0 ./*.changes
rm -f "$folder"/*.deb "$folder"/smartvis_*
cp ./*.deb ./*.dsc ./smartvis_*.tar.* ./*.changes ./*.buildinfo "$folder"
ls -l "$folder"
