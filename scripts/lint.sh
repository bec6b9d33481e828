#!/bin/bash
# SPDX-License-Identifier: MIT
# lint.sh BUILD_FOLDER JOBS: everything that reads the sources without running them. ANALYZER=deep: clang's analyzer follows many more
# paths, for some twenty minutes of processor time; before a release. BUILD_FOLDER is configured for clang, with
# compile_commands.json, and has its target embedded. Runs all checks, then ends with 1 if any of them failed.
set -u
cd "$(dirname "$0")/.."
build=$(realpath "$1")
jobs=$2
failed=()

check() { # check NAME COMMAND...: runs it, says how it went
    local name=$1 start=$SECONDS
    shift
    if ("$@"); then
        echo "lint: $name: ok ($((SECONDS - start)) s)"
    else
        echo "lint: $name: FAILED"
        failed+=("$name")
    fi
}

# Of the documents: every link to a file or a heading leads there.
links() { scripts/list_sources.sh md | xargs -r python3 scripts/check_links.py; }

format() { scripts/list_sources.sh c h hpp cpp cl clh | xargs -r clang-format --dry-run -Werror; }

# Every file that the build compiles, with clang's own warnings. One file a process: clang-tidy's own script would need Python.
tidy() {
    local depth=() word
    [ "${ANALYZER:-}" = deep ] || for word in -Xclang -analyzer-config -Xclang mode=shallow; do depth+=("--extra-arg=$word"); done
    scripts/list_sources.sh c | while read -r file; do
        if grep -qF "\"$PWD/$file\"" "$build/compile_commands.json"; then echo "$file"; fi
    done | xargs -r -P "$jobs" -n 1 clang-tidy --quiet "${depth[@]}" -p "$build" 2> "$build/clang-tidy.log"
    local code=$?
    # Without the count of findings suppressed in system headers, which goes to stderr for every file.
    grep -vE '^[0-9]+ warnings? (treated as errors|generated)|^Suppressed|^Use -header-filter' "$build/clang-tidy.log" >&2
    return $code
}

# As OpenCL C 1.2, for a generic 64-bit device. What only one structural variant or one of several files uses is fine.
opencl() {
    clang -x cl -cl-std=CL1.2 -Xclang -finclude-default-header -target spir64-unknown-unknown -fsyntax-only \
        -Wall -Wextra -Wno-unused-parameter -Wno-unused-function -Werror "$@"
}

# Files as one source.
joined() {
    local file
    for file in "$@"; do printf '#line 1 "%s"\n' "$file" && cat "$file"; done
}

# Each kernel file of the plugin compiles alone. The host's are one source, in the order of their names.
kernels() {
    local code=0 file lanes host=host_sim/render/cl
    for file in cl/*/*.cl; do
        opencl -I cl "$file" || code=1
        opencl -I cl -DSV_SUBSTEPS=3 -DSV_STRIP=64 -DSV_PADDED=1 -DSV_WIDE_SUMS=1 "$file" || code=1
        opencl -I cl -DSV_DOUBLES=1 "$file" || code=1
    done
    for lanes in 1 16; do
        joined "$host"/*.cl | opencl -DLANES=$lanes - || code=1
    done
    return $code
}

# mypy and ruff in the versions of python/requirements-lint.txt. The tests' functions need no types of their own.
python_tools() { scripts/python_env.sh "$build/lint" python/requirements-lint.txt; }
python_ruff() {
    python_tools && cd python &&
        "$build/lint/bin/ruff" check --quiet --no-cache . ../examples/python ../lab ../tests/lab --config pyproject.toml &&
        "$build/lint/bin/ruff" format --quiet --no-cache --check . ../examples/python ../lab ../tests/lab --config pyproject.toml
}
python_types() {
    python_tools && cd python &&
        "$build/lint/bin/mypy" --no-error-summary --cache-dir "$build/mypy" &&
        "$build/lint/bin/mypy" --no-error-summary --cache-dir "$build/mypy" --platform win32 smartvis && # what Windows lacks
        MYPYPATH=../lab/surfaces "$build/lint/bin/mypy" --no-error-summary --cache-dir "$build/mypy" --no-warn-return-any ../lab/surfaces &&
        MYPYPATH=tests:bench "$build/lint/bin/mypy" --no-error-summary --cache-dir "$build/mypy" --allow-untyped-defs \
            --allow-incomplete-defs --allow-untyped-calls --allow-any-generics --no-warn-return-any tests ../examples/python
}

check "house rules" scripts/check_rules.sh
check "links" links
check "floors" scripts/check_floors.py .
check "clang-format" format
check "kernels" kernels
check "ruff" python_ruff
check "mypy" python_types
check "clang-tidy" tidy

if [ ${#failed[@]} -gt 0 ]; then
    printf 'lint: failed: %s\n' "${failed[*]}"
    exit 1
fi
echo "lint: all checks passed"
