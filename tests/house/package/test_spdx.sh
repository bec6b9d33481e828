#!/bin/bash
# SPDX-License-Identifier: MIT
# The list of dependencies (scripts/spdx.sh): it has what the plugin and the programs load, what every list of packages names, and
# what is pinned of PyPI, with versions; every relation is between packages of the list. Called with the source and the build folder.
set -u
source_dir=$1
# shellcheck source=tests/support/holds.sh
. "$source_dir/tests/support/holds.sh"
command -v dpkg-query > /dev/null || {
    echo "skipped: no Debian"
    exit 77
}

holds bash "$source_dir/scripts/spdx.sh" "$2" "$work/list"
holds [ "$(head -n 1 "$work/list")" = "SPDXVersion: SPDX-2.3" ]
sed -n 's/^SPDXID: //p' "$work/list" | sort > "$work/ids"
holds [ -z "$(uniq -d "$work/ids")" ]
sed -n 's/^Relationship: \([^ ]*\) [A-Z_]* \([^ ]*\)$/\1\n\2/p' "$work/list" | sort -u > "$work/named"
holds [ -z "$(comm -13 "$work/ids" "$work/named")" ]
# The plugin needs OpenCL and libc only.
holds [ "$(sed -n 's/^Relationship: SPDXRef-smartvis.so DEPENDS_ON SPDXRef-//p' "$work/list" | paste -sd ' ')" = "libc6 ocl-icd-libopencl1" ]
holds grep -qx 'Relationship: SPDXRef-host-sim DEPENDS_ON SPDXRef-libcivetweb1' "$work/list"
# What is the project's own has its version.
version=$(sed -n 's/^project(smartvis VERSION \([0-9.]*\) .*/\1/p' "$source_dir/CMakeLists.txt")
for part in smartvis smartvis.so smartvis_check.so host_sim sv_validate sv_replay; do
    holds grep -qxF "PackageVersion: $version" <(grep -xF -A 2 "PackageName: $part" "$work/list")
done
# Each has a supplier; what is built has its sum, and every list a name of its own, also where there is no git.
holds [ "$(grep -c '^PackageSupplier: Organization: ' "$work/list")" = "$(grep -c '^PackageName: ' "$work/list")" ]
for part in smartvis.so smartvis_check.so host_sim sv_validate sv_replay; do
    holds grep -qxF "PackageChecksum: SHA256: $(sha256sum < "$2/$part" | head -c 64)" <(grep -xF -A 6 "PackageName: $part" "$work/list")
done
holds grep -qE '^DocumentNamespace: .*-[0-9a-f]{7,}$' "$work/list"
mkdir "$work/no_git"
printf '#!/bin/sh\nexit 128\n' > "$work/no_git/git"
chmod +x "$work/no_git/git"
PATH=$work/no_git:$PATH holds bash "$source_dir/scripts/spdx.sh" "$2" "$work/without"
holds grep -qxF "DocumentNamespace: https://spdx.org/spdxdocs/smartvis-$version-$(sha256sum < "$2/smartvis.so" | head -c 12)" "$work/without"
# What is needed to build is installed where this runs: it has the version that dpkg tells.
for name in $(sed 's/#.*//' "$source_dir/scripts/packages.txt"); do
    installed=$(dpkg-query -W -f '${Version}' "$name" 2> /dev/null)
    holds grep -qxF "PackageVersion: $installed" <(grep -xF -A 2 "PackageName: $name" "$work/list")
    holds grep -qxF "Relationship: SPDXRef-$(sed 's/[^A-Za-z0-9.-]/-/g' <<< "$name") BUILD_DEPENDENCY_OF SPDXRef-smartvis" "$work/list"
done
for line in $(sed -n 's/^\([A-Za-z0-9_.-]*==[^ ;]*\).*/\1/p' "$source_dir"/python/requirements*.txt); do
    holds grep -qxF "PackageVersion: ${line#*==}" <(grep -xF -A 2 "PackageName: pypi-${line%%=*}" "$work/list")
done
echo "$checked checks, $failed failed"
[ "$failed" -eq 0 ]
