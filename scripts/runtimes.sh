#!/bin/bash
# SPDX-License-Identifier: MIT
# runtimes.sh BUILD_FOLDER OUT [NAME...]: the tests of scripts/runtimes.txt on its OpenCL runtimes, all or those named, the validator, and
# every method's bits against those of this machine's PoCL. A runtime comes from Debian's packages of its suite, unpacked into a root in
# OUT/NAME, where it runs with that suite's C library; the programs are those of BUILD_FOLDER. Nothing is installed. Needs the right to
# make namespaces, which root has. Exit code 1 if any failed or a version is another; 3 if it is not possible here.
set -eu
build=$(cd "$1" && pwd)
mkdir -p "$2"
out=$(cd "$2" && pwd)
shift 2
checkout=$(cd "$(dirname "$0")/.." && pwd)
. "$checkout/scripts/mirror.sh"
stop() { echo "runtimes: $1" >&2; exit 3; }
unshare --mount --pid --fork true 2> /dev/null || stop "unshare makes no namespaces here"
command -v apt-get > /dev/null || stop "no apt-get"

# The packages and what they depend on, however much of it this machine has: apt is told that nothing is installed.
unpack() { # unpack SUITE PACKAGE ROOT
    local apt=$3.apt archive
    mkdir -p "$apt/lists/partial" "$apt/cache/archives/partial" "$apt/sources" "$3"
    : > "$apt/status"
    local mirror
    mirror=$(find_mirror "$1" "$apt") || stop "no repository of apt's configuration has '$1': run apt-get update"
    echo "deb $mirror $1 main" > "$apt/sources/suite.list"
    cat > "$apt/conf" << END
Dir::State::Lists "$apt/lists";
Dir::State::status "$apt/status";
Dir::Etc::SourceList "/dev/null";
Dir::Etc::SourceParts "$apt/sources";
Dir::Cache "$apt/cache";
APT::Install-Recommends "false";
APT::Sandbox::User "root";
Debug::NoLocking "true";
END
    APT_CONFIG=$apt/conf apt-get -q update
    APT_CONFIG=$apt/conf apt-get -q -y --download-only install base-files coreutils libc-bin "$2"
    # base-files has the links of /bin and /lib into /usr: they come before what is put behind them.
    for archive in "$apt"/cache/archives/base-files_*.deb "$apt"/cache/archives/*.deb; do
        dpkg-deb --fsys-tarfile "$archive" | tar -x -C "$3" --keep-directory-symlink
    done
    chroot "$3" /sbin/ldconfig
    mkdir -p "$3/proc" "$3/dev" "$3/sys" "$3/machine" "$3/tmp/cache" "$3$build" "$3$checkout"
}

# within ROOT COMMAND...: in the root, with the machine's libraries for what the suite's packages lack.
within() {
    unshare --mount --pid --fork --kill-child bash -c 'root=$1 build=$2 checkout=$3
        shift 3
        mount -t proc proc "$root/proc" && mount --rbind /dev "$root/dev" && mount --rbind /sys "$root/sys" &&
            mount --bind /usr/lib/x86_64-linux-gnu "$root/machine" && mount --bind "$checkout" "$root$checkout" &&
            { [ ! -d "$root$build" ] || mount --bind "$build" "$root$build"; } || exit 3
        exec chroot "$root" /usr/bin/env -i PATH=/usr/bin:/usr/sbin LD_LIBRARY_PATH=/usr/lib/x86_64-linux-gnu:/machine "$@"' \
        bash "$1" "$build" "$checkout" POCL_CACHE_DIR=/tmp/cache XDG_CACHE_HOME=/tmp/cache POCL_SIGFPE_HANDLER=0 \
        RUSTICL_ENABLE=llvmpipe SV_SOURCE_DIR="$checkout" SV_BUILD_DIR="$build" "${@:2}"
}

failed=0
# tries NAME WHAT COMMAND...: a line of it.
tries() {
    local name=$1 what=$2 start=$SECONDS code=0 log=$out/$1.$2.log
    shift 2
    within "$out/$name" "$@" > "$log" 2>&1 || code=$?
    if [ $code = 0 ]; then
        echo "runtimes: $name: $what: ok ($((SECONDS - start)) s)"
    else
        echo "runtimes: $name: $what: FAILED, exit code $code, see $log"
        tail -n 20 "$log"
        failed=1
    fi
}

# same_bits NAME WANTED: what its frames came to, in OUT/NAME.txt, is what they came to here.
same_bits() {
    diff "$2" "$out/$1.txt" || { echo "runtimes: $1: FAILED: other bits than this machine's PoCL"; failed=1; }
}

# whole NAME: it builds everything.
whole() {
    local name=$1 test
    tries "$name" every_method "$build/tests/every_method" "$build/smartvis.so"
    grep ' outcome ' "$out/$name.every_method.log" > "$out/$name.txt" || true
    # A device may have no images that slabs could be.
    grep -q ' image ' "$out/$name.txt" && cp "$out/here.txt" "$out/wanted.txt" || grep -v ' image ' "$out/here.txt" > "$out/wanted.txt"
    same_bits "$name" "$out/wanted.txt"
    for test in $tests; do tries "$name" "test_$test" "$build/tests/test_$test"; done
    tries "$name" sv_validate "$build/sv_validate" --level 1 "$build/smartvis.so"
}

# part NAME LAYOUT METHOD...: it builds these methods in one layout.
part() {
    local name=$1 layout=$2 method test
    : > "$out/$name.txt"
    : > "$out/wanted.txt"
    for method in "${@:3}"; do
        "$build/tests/every_method" "$build/smartvis.so" small "$method" "$layout" >> "$out/wanted.txt" 2>> "$out/here.err"
        tries "$name" "$method" "$build/tests/every_method" "$build/smartvis.so" small "$method" "$layout"
        grep ' outcome ' "$out/$name.$method.log" >> "$out/$name.txt" || true
    done
    same_bits "$name" "$out/wanted.txt"
    for test in $open_tests; do tries "$name" "test_$test" "$build/tests/test_$test"; done
}

"$build/tests/every_method" "$build/smartvis.so" > "$out/here.txt" 2> "$out/here.err" || stop "every_method fails here"
tests=$(sed -n 's/^tests //p' "$checkout/scripts/runtimes.txt")
open_tests=$(sed -n 's/^open_tests //p' "$checkout/scripts/runtimes.txt")
while read -r name suite package version layout methods; do
    [ $# = 0 ] || [[ " $* " == *" $name "* ]] || continue
    rm -rf --one-file-system "${out:?}/$name" "${out:?}/$name.apt"
    unpack "$suite" "$package" "$out/$name" > "$out/$name.log" 2>&1 || { tail -n 5 "$out/$name.log"; stop "$name cannot be had"; }
    came=$(basename "$out/$name.apt/cache/archives/${package}"_*.deb | cut -d _ -f 2)
    echo "runtimes: $name: $package $came of $suite"
    [[ $came == "$version"* ]] || { echo "runtimes: $name: FAILED: scripts/runtimes.txt says $version"; failed=1; }
    if [ -z "$layout" ]; then whole "$name"; else part "$name" "$layout" $methods; fi
done < <(sed -e 's/#.*//' -e '/^[a-z_]*tests /d' -e '/^ *$/d' "$checkout/scripts/runtimes.txt")
exit $failed
