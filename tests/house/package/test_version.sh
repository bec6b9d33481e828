#!/bin/bash
# SPDX-License-Identifier: MIT
# One version everywhere: CMakeLists.txt has it; programs, the plugin's descriptor, Debian packages, wheel and crate say the same, what
# was built and its pictures with one commit, and
# the changelog has a dated section of it below one for what is not released. The ABI counts for itself: header, packages for plugins
# and hosts, and the newest dump in abi/ agree. Called with the source and the build folder.
# Requirement: R17.
set -u
source_dir=$1 build=$2
# shellcheck source=tests/support/holds.sh
. "$source_dir/tests/support/holds.sh"
cd "$source_dir" || exit 1
is() { # is WHAT VERSION
    [ "$2" = "$version" ] || { echo "$1 says '$2', CMakeLists.txt $version"; return 1; }
}

version=$(sed -n 's/^project(smartvis VERSION \([0-9.]*\) .*/\1/p' CMakeLists.txt)
holds grep -qxE '[0-9]+\.[0-9]+\.[0-9]+' <<< "$version"
holds is debian/changelog "$(sed -n '1s/^smartvis (\([^)]*\)).*/\1/p' debian/changelog)"
holds is bindings/rust/Cargo.toml "$(sed -n 's/^version = "\(.*\)"$/\1/p' bindings/rust/Cargo.toml)"
holds is python/smartvis/_version.py "$(sed -n 's/^__version__ = "\(.*\)"$/\1/p' python/smartvis/_version.py)"
holds grep -qxF 'input = "smartvis/_version.py"' python/pyproject.toml
holds is CITATION.cff "$(sed -n "s/^version: //p" CITATION.cff)"
commit=$(cat "$build/commit.txt")
built() { # built WHAT VERSION
    [ "$2" = "$version${commit:++$commit}" ] || { echo "$1 says '$2', version $version of commit '$commit' was built"; return 1; }
}
for program in host_sim sv_validate sv_replay sv_bench; do
    [ ! -e "$build/$program" ] || holds built $program "$("$build/$program" --version | sed 's/^[a-z_]* \([^,]*\),.*/\1/')"
done
"$build/host_sim" run --scene D01 --size 32 --frames 1 --out "$work" > "$work/run"
software='import sys; png = open(sys.argv[1], "rb").read(); print(png[50 : 41 + int.from_bytes(png[33:37], "big")].decode())'
holds built pictures "$(python3 -c "$software" "$work/result.png" | sed -n 's/^SmartVis //p')"
SMARTVIS_CHECK_PLUGIN=$build/smartvis.so SMARTVIS_RECORD=$work/recording holds "$build/host_sim" list --plugin "$build/smartvis_check.so" > "$work/list"
holds built "the checking layer" "$("$build/sv_replay" --list "$work/recording" | sed -n 's/.*SmartVis checking layer \([^ ]*\)$/\1/p')"
version_of='import ctypes, sys; f = ctypes.CDLL(sys.argv[1]).svh_version; f.restype = ctypes.c_char_p; print(f().decode())'
holds built libsmartvis_host "$(python3 -c "$version_of" "$build/libsmartvis_host.so")"
holds built org.smartvis.clip "$("$build/host_sim" list | sed -n 's/^org\.smartvis\.clip \([^ ]*\): .*/\1/p')"

# --- the changelog: what is not released, then this version with its day
sections=$(grep '^## ' CHANGELOG.md)
holds test "$(sed -n 1p <<< "$sections")" = '## [Unreleased]'
holds is CHANGELOG.md "$(sed -n '2s/^## \[\([0-9.]*\)\] - 20[0-9][0-9]-[01][0-9]-[0-3][0-9]$/\1/p' <<< "$sections")"

# --- the ABI
abi=$(awk '/^#define SV_ABI_(MAJOR|MINOR) / { printf "%s%d", dot, $3; dot = "." }' include/smartvis_plugin.h)
holds grep -qF "SmartVis plugin ABI, version $abi:" include/smartvis_plugin.h
holds grep -qxF "Version: $abi" "$build/share/pkgconfig/smartvis-plugin.pc"
holds grep -qF "set(PACKAGE_VERSION \"$abi\")" "$build/share/cmake/SmartVisPlugin/SmartVisPluginConfigVersion.cmake"
for program in host_sim sv_validate; do holds grep -qF "plugin ABI $abi" <("$build/$program" --version); done

echo "$checked checked, $failed failed"
[ "$failed" = 0 ]
