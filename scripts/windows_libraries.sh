#!/bin/bash
# SPDX-License-Identifier: MIT
# windows_libraries.sh ROOT: jansson, libpng and libjpeg-turbo for 64-bit Windows, static, cross-built from Debian's own source packages,
# to ROOT/lib and ROOT/include, with their licences in ROOT/licences. Sources come from where this machine's packages come from, by
# lists and a cache of apt in ROOT/apt; nothing is installed. What is there already is not built again.
set -eu -o pipefail
mkdir -p "$1/apt/lists/partial" "$1/apt/cache/archives/partial" "$1/licences"
root=$(realpath "$1")
toolchain=$(realpath "$(dirname "$0")/../cmake/x86_64-windows.cmake")

fetch() { # fetch PACKAGE: its source, with Debian's patches, in ROOT/apt/PACKAGE-VERSION
    local own=(-o "Dir::Etc::sourcelist=$root/apt/sources.list" -o Dir::Etc::sourceparts=- -o "Dir::State::lists=$root/apt/lists"
        -o "Dir::Cache=$root/apt/cache" -o APT::Sandbox::User=root)
    cd "$root/apt"
    if [ ! -e sources.list ]; then
        # What is not signed by Debian is not read.
        apt-get indextargets --format "deb-src [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] \$(REPO_URI) \$(RELEASE) \$(COMPONENT)" \
            'Created-By: Packages' > sources.new
        apt-get "${own[@]/sources.list/sources.new}" -q update || true
        mv sources.new sources.list
    fi
    # The newest that is there: not every mirror has what its lists name.
    for version in $(apt-cache "${own[@]}" showsrc --only-source "$1" | sed -n 's/^Version: //p' | sort -rVu); do
        apt-get "${own[@]}" -q source "$1=$version" && return
    done
    rm sources.list # to be read anew
    echo "windows_libraries: the source of the Debian package $1 cannot be had from here"
    return 1
}

build() { # build LIBRARY PACKAGE TARGET "HEADER..." ARGUMENT...: this target alone, unless ROOT/lib/LIBRARY.a is there
    local source built=$root/apt/build/$2 header description to
    [ ! -e "$root/lib/$1.a" ] || return 0
    fetch "$2"
    source=$(find "$root/apt" -maxdepth 1 -type d -name "$2-*")
    cmake -S "$source" -B "$built" -G Ninja -D "CMAKE_TOOLCHAIN_FILE=$toolchain" -D "SV_WINDOWS_ROOT=$root" \
        -D "CMAKE_INSTALL_PREFIX=$root" -D CMAKE_BUILD_TYPE=Release -D CMAKE_C_FLAGS=-w "${@:5}"
    cmake --build "$built" --target "$3"
    # Its own installation wants the programs, too, most of what there is to compile.
    description=$(find "$built" -name "${1%16}.pc" -o -name "${1#lib}.pc")
    to=$(pkg-config --variable=includedir "$description")
    mkdir -p "$root/lib/pkgconfig" "$to"
    # What was configured comes first: sources hold headers of that name for other systems.
    for header in $4; do cp "$(find "$built" "$source" -name "$header" -print -quit)" "$to"; done
    cp "$description" "$root/lib/pkgconfig"
    cp "$source/debian/copyright" "$root/licences/$2"
    find "$built" -name "$1.a" -exec cp {} "$root/lib" ';'
}
log=$root/apt/log
exec 3>&2 > "$log" 2>&1
trap '[ $? = 0 ] || tail -n 40 "$log" >&3' EXIT
build libjansson jansson jansson 'jansson.h jansson_config.h' -D JANSSON_EXAMPLES=OFF -D JANSSON_BUILD_DOCS=OFF -D JANSSON_WITHOUT_TESTS=ON
build libpng16 libpng1.6 png_static 'png.h pngconf.h pnglibconf.h' -D PNG_SHARED=OFF -D PNG_TESTS=OFF
build libturbojpeg libjpeg-turbo turbojpeg-static turbojpeg.h -D ENABLE_SHARED=OFF -D WITH_SIMD=OFF
