#!/bin/bash
# SPDX-License-Identifier: MIT
# release.sh FOLDER [again]: what a release of the checked-out commit consists of: sources, Debian packages, Python wheel, zip for Windows,
# list of parts (SPDX) and SHA256SUMS of all that. It is built from a clone of its own, so that nothing else goes in, with all times those of
# the commit. The same commit gives the same bytes, wherever it is built, on a machine with the same packages; `again` makes it once more in
# another folder, and ends with 1 if a byte differs.
set -eu -o pipefail
umask 022
mkdir -p "$1"
folder=$(realpath "$1")
cd "$(dirname "$0")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
[ -z "$(git status --porcelain)" ] || echo "release: what is not committed is left out" >&2
SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
export SOURCE_DATE_EPOCH CCACHE_DISABLE=1 LC_ALL=C.UTF-8 TZ=UTC

# Files of the installed tree in the order of their names, all as old as the commit.
pack_windows() { # pack_windows INSTALLED LICENCES NAME: NAME.zip
    local name=${3##*/}
    mkdir "$3"
    cp -r "$1"/. "$2" "$3"
    (cd "$3/.." && find "$name" -type f | sort > files &&
        cmake -E tar c "$name.zip" --format=zip --mtime="$(date -u -d "@$SOURCE_DATE_EPOCH" "+%F %T UTC")" --files-from=files && rm -r files "$name")
}

make_all() { # make_all CLONE OUT: of the commit, in the folder CLONE, which is made
    git clone -q . "$1"
    mkdir -p "$2"
    (
        cd "$1"
        git checkout -q --detach "$commit"
        sources=$(scripts/dist.sh "$2")
        release=${sources%.tar.gz} # smartvis-VERSION
        make deb wheel all
        scripts/spdx.sh build "$release.spdx"
        scripts/windows_build.sh out/windows
        pack_windows out/windows/installed out/windows/root/licences "$release-windows-x86_64"
        cp out/deb/*.deb out/deb/*.dsc out/deb/*.tar.* out/wheel/*.whl "$2"
        cd "$2" && sha256sum -- * > SHA256SUMS
    )
}
commit=$(git rev-parse HEAD)
make_all "$work/first" "$work/out"
if [ "${2:-}" = again ]; then
    make_all "$work/in/another/folder" "$work/again"
    diff "$work/out/SHA256SUMS" "$work/again/SHA256SUMS" || { echo "release: what is made twice differs, see above" >&2; exit 1; }
    echo "release: made twice, $(wc -l < "$work/out/SHA256SUMS") files, the same to the bit"
fi
find "$folder" -maxdepth 1 -type f -name 'smartvis*' -delete
cp "$work/out"/* "$folder"
cat "$folder/SHA256SUMS"
