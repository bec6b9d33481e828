#!/bin/bash
# SPDX-License-Identifier: MIT
# What a user gets from `cmake --install`: it is whole, knows no path of the machine that built it, and works wherever it is
# moved. Plugins and hosts in C, C++17 and, where rustc is there, Rust are built against it, outside of the sources.
# Called with the source and the build folder.
set -u
source_dir=$1
build_dir=$2
# shellcheck source=tests/support/holds.sh
. "$source_dir/tests/support/holds.sh"
unset SMARTVIS_PLUGIN_PATH SMARTVIS_SCENES PKG_CONFIG_PATH CMAKE_PREFIX_PATH

# Quiet if it succeeds.
works() {
    "$@" > "$work/log" 2>&1 && return 0
    tail -n 30 "$work/log"
    return 1
}
said() { grep -qF -- "$1" "$work/log" || { cat "$work/log"; return 1; }; }
refuses() { # refuses WORDS COMMAND...: it fails and says WORDS
    if "${@:2}" > "$work/log" 2>&1; then return 1; fi
    said "$1"
}

# --- installed to one place, moved to another
prefix="$work/moved to/here"
mkdir -p "$work/moved to"
DESTDIR=$work/stage holds works cmake --install "$build_dir" --prefix /opt/somewhere
mv "$work/stage/opt/somewhere" "$prefix" || exit 1
holds test -z "$(ls "$work/stage/opt")"
host_sim=$prefix/bin/host_sim
for file in bin/host_sim bin/sv_validate bin/sv_bench share/man/man1/sv_bench.1 lib/smartvis/smartvis.so include/smartvis_plugin.h include/smartvis/author.h \
    share/smartvis/scenes/D01.json share/man/man1/host_sim.1 share/doc/smartvis/LICENSE share/doc/smartvis/docs/abi.md \
    share/pkgconfig/smartvis-plugin.pc share/cmake/SmartVisPlugin/SmartVisPluginConfig.cmake \
    share/smartvis/examples/README.md share/smartvis/examples/template/README.md; do
    holds test -s "$prefix/$file"
done
holds test "$(find "$prefix/share/smartvis/scenes" -name '*.json' | wc -l)" = "$(find "$source_dir/data/scenes" -name '*.json' | wc -l)"
holds test "$(cd "$prefix/include" && find . -type f | sort)" = "$(cd "$source_dir/include" && { find . -type f; echo ./smartvis_host.h; } | sort)"

holds test "$(cd "$prefix/lib/smartvis" && echo ./* */*)" = "./check ./smartvis.so check/smartvis_check.so"

# --- the sums of all of it, for sha256sum and for host_sim verify
sums=share/smartvis/sums/smartvis.sha256
holds works bash -c "cd '$prefix' && sha256sum --quiet -c $sums"
holds test "$(cd "$prefix" && find . -type f ! -path "./$sums" | wc -l)" = "$(wc -l < "$prefix/$sums")"

# --- no path of the build in it, neither in texts nor in programs
# A checkout in /smartvis is none of the /smartvis in "lib/smartvis".
for path in "$source_dir" "$build_dir" /opt/somewhere; do
    holds test -z "$(LC_ALL=C grep -rlP -- "(?<![\w.}/-])\Q$path\E(?![\w-])" "$prefix")"
done
for file in "$prefix/bin/"* "$prefix/lib/smartvis/smartvis.so" "$prefix/lib/smartvis/check/smartvis_check.so"; do
    holds test -z "$(readelf -d "$file" | grep -E 'R(UN)?PATH')"
done

# --- the manual pages say what the programs say
for program in "$prefix"/bin/*; do
    page=$prefix/share/man/man1/$(basename "$program").1
    holds works bash "$source_dir/scripts/man_page.sh" "$program" "$work/page.1"
    holds cmp "$work/page.1" "$page"
    for option in $("$program" --help | grep -oE '^  --[a-z-]+'); do
        holds grep -qF -- "${option//-/\\-}" "$page"
    done
done
for option in carrier ghost-width panel; do holds grep -q -- "^.B .*${option//-/.-}" "$prefix/share/man/man1/host_sim.1"; done
if command -v man > /dev/null; then
    for page in "$prefix"/share/man/man1/*; do
        holds test "$(LC_ALL=C MANROFFSEQ='' MANWIDTH=80 man --warnings -E UTF-8 -l -Tutf8 -Z "$page" 2>&1 > /dev/null)" = ""
    done
fi

# --- the machine as a library: it shows what its header declares, and finds plugin and guard from where it is
declared=$(grep -oE '\bsvh_[a-z_]+\(' "$prefix/include/smartvis_host.h" | tr -d '(' | sort -u)
holds test "$(nm -D --defined-only "$prefix/lib/libsmartvis_host.so" | awk '{ print $3 }' | sort)" = "$declared"
holds works "$host_sim" scenes D01 --size 48 --export --out "$work/scan"
printf '#include <smartvis_host.h>\n#include <stdio.h>\nint main(int n, char **of) {\n    svh_error e = {.size = sizeof e};\n%s\n%s\n%s\n}\n' \
    '    svh_host *h; svh_clipper *c; svh_volume *v; svh_result r = {.size = sizeof r};' \
    '    int code = svh_open(NULL, &h, &e) || svh_clipper_open(h, n > 2 ? of[2] : NULL, NULL, &c, &e) || svh_volume_read(h, of[1], NULL, &v, &e);' \
    '    return puts(code || svh_clip(c, v, NULL, NULL, &r, &e) ? e.text : r.clips ? "clipped" : r.why) < 0;' > "$work/by_library.c"
holds works cc -std=c11 -Wall -Wextra -Werror -I "$prefix/include" "$work/by_library.c" -L "$prefix/lib" -lsmartvis_host -o "$work/by_library"
export LD_LIBRARY_PATH=$prefix/lib
holds works "$work/by_library" "$work/scan/D01_full.mha"
holds said clipped
holds works "$work/by_library" "$work/scan/D01_full.mha" "$build_dir/wrong/crash_in_slab.so"
holds said 'crashed: SIGSEGV in slab'
unset LD_LIBRARY_PATH

# --- programs find plugin and scenes from where they are, in whatever folder they are called
mkdir "$work/elsewhere"
cd "$work/elsewhere" || exit 1
run=("$host_sim" run --scene D01 --size 128 --setting smartvis --frames 2 --picture 96 --panel 96 --out "$work/run")
holds works "$host_sim" list
holds said "$prefix/lib/smartvis/smartvis.so"
holds works "${run[@]}"
holds said 'Frames: 2 clipped'
holds test -s "$work/run/panel.png"
holds works "$host_sim" scenes E01 --size 32

# --- CMake: every example as a copy; the wrong version is refused
for name in first_edge kernel_edge small_host queue_host deadline_host cpp; do
    cp -r "$prefix/share/smartvis/examples/$name" "$work/$name"
    holds works cmake -S "$work/$name" -B "$work/$name/build" -D CMAKE_PREFIX_PATH="$prefix" -D CMAKE_C_FLAGS='-Wall -Wextra -Werror' \
        -D CMAKE_CXX_FLAGS='-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror'
    holds works cmake --build "$work/$name/build"
done
cp -r "$work/first_edge" "$work/later"
rm -r "$work/later/build"
sed -i 's/SmartVisPlugin 1.0/SmartVisPlugin 2.0/' "$work/later/CMakeLists.txt"
holds refuses 'compatible with requested version "2.0"' cmake -S "$work/later" -B "$work/later/build" -D CMAKE_PREFIX_PATH="$prefix"
holds refuses 'SmartVisPlugin' cmake -S "$work/first_edge" -B "$work/first_edge/none" -D CMAKE_FIND_USE_CMAKE_SYSTEM_PATH=OFF

# --- the template: copied under a name of its own, built, installed, found by that name, and a picture
cp -r "$prefix/share/smartvis/examples/template" "$work/my-plugin"
holds works cmake -S "$work/my-plugin" -B "$work/my-plugin/build" -D CMAKE_PREFIX_PATH="$prefix"
holds works cmake --build "$work/my-plugin/build"
holds works "${run[@]}" --plugin "$work/my-plugin/build/my_plugin.so"
holds said 'org.example.my_plugin 0.1.0'
holds said 'Frames: 2 clipped'
holds refuses 'my_plugin: cannot read the plugin file' "$host_sim" list --plugin my_plugin
SMARTVIS_PLUGIN_PATH=/nowhere::$work/my-plugin/build holds works "$host_sim" list --plugin my_plugin
holds said "$work/my-plugin/build/my_plugin.so"
# Its workflow for a public CI, as its steps stand there, with what is installed: all hold, and a changed plugin is noticed.
workflow=$work/my-plugin/.github/workflows/plugin.yml
steps() { awk '/^      - / { on = /name: (Build|Validate|Acceptance)$/ } on && /^          / { print substr($0, 11) }' "$workflow"; }
ci() { (cd "$work/my-plugin" && PATH=$prefix/bin:$PATH CMAKE_PREFIX_PATH=$prefix bash -e -c "$(steps)"); }
holds test "$(steps | wc -l)" = 6
holds works ci
holds said '0 of 4096 rays differ by more than 0 mm'
holds grep -q 'testsuite name="sv_validate .*my_plugin.so" tests="[0-9]*" failures="0" errors="0"' "$work/my-plugin/validate.xml"
sed -i 's/(float)end - 0.5f/(float)end - 1.5f/' "$work/my-plugin/my_surface.c"
holds refuses 'rays differ by more than 0 mm, the most by 1.875 mm' ci
holds test "$(wc -l < "$work/my-plugin/out/acceptance/D01/differences.csv")" -gt 1000
holds works cmake --install "$work/my-plugin/build" --prefix "$prefix"
holds works "$host_sim" list --plugin my_plugin.so
holds said "$prefix/lib/smartvis/my_plugin.so"

# --- pkg-config: version and paths; C without CMake
export PKG_CONFIG_PATH=$prefix/share/pkgconfig
abi=$(awk '/^#define SV_ABI_(MAJOR|MINOR) / { printf "%s%d", dot, $3; dot = "." }' "$source_dir/include/smartvis_plugin.h")
holds test "$(pkg-config --modversion smartvis-plugin)" = "$abi"
holds test "$(readlink -m "$(pkg-config --variable=plugindir smartvis-plugin | sed 's/\\ / /g')")" = "$prefix/lib/smartvis"
flags=()
eval "flags=($(pkg-config --cflags smartvis-plugin))" # a prefix with blanks is quoted
strict=(-O2 -Wall -Wextra -Wpedantic -Werror)
holds works cc -std=c99 "${strict[@]}" -fPIC -shared '-DPLUGIN_NAME="mine"' '-DPLUGIN_VERSION="0.1.0"' "${flags[@]}" "$work/my-plugin/my_surface.c" -o "$work/mine.so"
holds works "$host_sim" list --plugin "$work/mine.so"

# --- Rust: the crate, copied, finds the headers by pkg-config and is what they say
plugins=("$work/cpp/build/fluid_plugin.so") hosts=("$work/queue_host/build/queue_host" "$work/cpp/build/small_host")
if command -v cargo > /dev/null; then
    cp -r "$prefix/share/smartvis/bindings/rust" "$work/my crate"
    export RUSTFLAGS='-D warnings'
    holds works cargo test --offline --manifest-path "$work/my crate/Cargo.toml"
    holds works cargo build --offline --release --examples --manifest-path "$work/my crate/Cargo.toml"
    holds works cargo build --offline --manifest-path "$prefix/share/smartvis/bindings/rust/Cargo.toml" --target-dir "$work/in_place"
    plugins+=("$work/my crate/target/release/examples/libfirst_fluid.so") hosts+=("$work/my crate/target/release/examples/small_host")
else
    echo "no cargo: without the crate in Rust"
fi

# --- plugins in C++ and Rust: one symbol, nothing for the validator to say, a picture
for plugin in "${plugins[@]}"; do
    holds test "$(nm -D --defined-only "$plugin" | awk '$2 != "W" { print $3 }')" = smartvis_plugin_entry
    holds works "$prefix/bin/sv_validate" "$plugin"
    holds works "${run[@]}" --plugin "$plugin"
    holds said 'Frames: 2 clipped'
done

# --- hosts: on the host's queue, in C++, in Rust. All print what the one in C does; the checking layer has nothing to say; what is
# no plugin is refused; and after a failed call the instance is given back in order.
"$work/small_host/build/small_host" "$prefix/lib/smartvis/smartvis.so" > "$work/expected" 2>&1
holds grep -q 'rendered with the map' "$work/expected"
layer=$prefix/lib/smartvis/check/smartvis_check.so
for host in "${hosts[@]}"; do
    "$host" "$prefix/lib/smartvis/smartvis.so" > "$work/got" 2>&1
    holds cmp "$work/expected" "$work/got"
    SMARTVIS_CHECK=stop SMARTVIS_CHECK_PLUGIN=$prefix/lib/smartvis/smartvis.so "$host" "$layer" > "$work/got" 2>&1
    holds cmp "$work/expected" "$work/got"
    for wrong in no_symbol other_major older_major; do
        "$host" "$build_dir/tests/plugins/$wrong.so" > "$work/got" 2>&1
        holds test $? -ne 0
    done
done
for host in "${hosts[@]:1}"; do
    SMARTVIS_CHECK=stop SMARTVIS_CHECK_PLUGIN=$build_dir/tests/plugins/begin_77.so "$host" "$layer" > "$work/log" 2>&1
    holds test $? = 4
    holds said 'rendered unclipped'
    holds test "$(grep -c 'check: host-' "$work/log")" = 0
    holds said 'rules that were broken' # destroy tells
done

echo "$checked checked, $failed failed"
[ "$failed" = 0 ]
