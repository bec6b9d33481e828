#!/bin/bash
# SPDX-License-Identifier: MIT
# spdx.sh BUILD_FOLDER FILE: what the project is built with and runs with, each with its version on this machine, as SPDX 2.3.
# What plugin and programs load is read from the built files; what they are built and tested with stands in scripts/packages*.txt
# and python/requirements*.txt. A package that is not installed here has no version.
set -eu
build=$(realpath "$1")
mkdir -p "$(dirname "$2")"
out=$(realpath "$2")
cd "$(dirname "$0")/.."
command -v dpkg-query > /dev/null || { echo "spdx: this is no Debian: dpkg-query is missing" >&2; exit 1; }
version=$(sed -n 's/^project(smartvis VERSION \([0-9.]*\) .*/\1/p' CMakeLists.txt)
# What tells one list from another: the commit, or where there is no git the plugin itself.
commit=$(git rev-parse --short HEAD 2> /dev/null || sha256sum < "$build/smartvis.so" | head -c 12)
created=$(git log -1 --format=%ct 2> /dev/null || date +%s)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
touch "$work/packages" "$work/relations"

id_of() { echo "SPDXRef-${1//[^A-Za-z0-9.-]/-}"; }
package() { # package NAME VERSION URL: adds it, if it is not there yet; URL is its purl, or nothing: it is our own
    local id supplier='Organization: The SmartVis authors'
    case ${3:-} in
        pkg:deb/*) supplier='Organization: Debian' ;;
        pkg:*) supplier='Organization: PyPI' ;;
    esac
    id=$(id_of "$1")
    grep -qx "SPDXID: $id" "$work/packages" && return
    printf '\nPackageName: %s\nSPDXID: %s\n%sPackageSupplier: %s\n' \
        "$1" "$id" "${2:+PackageVersion: $2$'\n'}" "$supplier" >> "$work/packages"
    printf 'PackageDownloadLocation: NOASSERTION\nFilesAnalyzed: false\n' >> "$work/packages"
    [ -n "${3:-}" ] || [ ! -f "$build/$1" ] || printf 'PackageChecksum: SHA256: %s\n' "$(sha256sum < "$build/$1" | head -c 64)" >> "$work/packages"
    printf 'PackageLicenseConcluded: NOASSERTION\nPackageLicenseDeclared: %s\nPackageCopyrightText: NOASSERTION\n' \
        "$([ "${3:-}" ] && echo NOASSERTION || echo MIT)" >> "$work/packages"
    [ -z "${3:-}" ] || printf 'ExternalRef: PACKAGE-MANAGER purl %s\n' "$3" >> "$work/packages"
}
relation() { printf 'Relationship: %s %s %s\n' "$(id_of "$1")" "$2" "$(id_of "$3")" >> "$work/relations"; }
debian() { # debian NAME
    local found
    found=$(dpkg-query -W -f '${db:Status-Status} ${Version}' "$1" 2> /dev/null | sed -n 's/^installed //p')
    package "$1" "$found" "pkg:deb/debian/$1${found:+@${found//+/%2B}}"
}
# The package that a file of this machine came with; /lib and /usr/lib may be one folder.
owner() {
    local path=$1
    { dpkg-query -S "$path" 2> /dev/null || dpkg-query -S "${path#/usr}" 2> /dev/null || dpkg-query -S "/usr$path"; } | sed 's/:.*//;q'
}

declare -A owners # dpkg takes long to look for a file: each once
package smartvis "$version"
for part in smartvis.so smartvis_check.so host_sim sv_validate sv_replay sv_bench; do
    [ -e "$build/$part" ] || continue
    package "$part" "$version"
    relation smartvis CONTAINS "$part"
    for name in $(LC_ALL=C readelf -dW "$build/$part" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p'); do
        path=$(ldd "$build/$part" | awk -v name="$name" '$1 == name { print $3 }')
        [ -n "$path" ] || { echo "spdx: $part needs $name, which is not found here" >&2; exit 1; }
        from=${owners[$path]:=$(owner "$(realpath "$path")")}
        debian "$from"
        relation "$part" DEPENDS_ON "$from"
    done
done
for list in scripts/packages*.txt; do
    kind=DEV_TOOL_OF
    [ "$list" != scripts/packages.txt ] || kind=BUILD_DEPENDENCY_OF
    for name in $(sed 's/#.*//' "$list"); do
        debian "$name"
        relation "$name" "$kind" smartvis
    done
done
while IFS='=' read -r name _ pinned; do
    package "pypi-$name" "$pinned" "pkg:pypi/${name,,}@$pinned"
    relation "pypi-$name" DEV_TOOL_OF smartvis
done < <(cat python/requirements*.txt | sed -n 's/^\([A-Za-z0-9_.-]*==[^ ;]*\).*/\1/p' | sort -u)

{
    printf 'SPDXVersion: SPDX-2.3\nDataLicense: CC0-1.0\nSPDXID: SPDXRef-DOCUMENT\nDocumentName: smartvis-%s\n' "$version"
    printf 'DocumentNamespace: https://spdx.org/spdxdocs/smartvis-%s-%s\nCreator: Tool: scripts/spdx.sh\nCreated: %s\n' \
        "$version" "$commit" "$(date -u -d "@$created" +%Y-%m-%dT%H:%M:%SZ)"
    cat "$work/packages"
    printf '\nRelationship: SPDXRef-DOCUMENT DESCRIBES SPDXRef-smartvis\n'
    sort -u "$work/relations"
} > "$out"
echo "$out: $(grep -c '^PackageName' "$out") packages"
