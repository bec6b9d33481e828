#!/bin/bash
# SPDX-License-Identifier: MIT
# scripts/run_tests.sh says what failed, what was left out and why, and the command that runs again what failed. Called with the
# source folder.
set -u
source_dir=$1
# shellcheck source=tests/support/holds.sh
. "$source_dir/tests/support/holds.sh"
cd "$work" || exit 1
mkdir build
cat > build/CTestTestfile.cmake << 'END'
add_test(part/good true)
add_test(part/goods false)
add_test(part/wrong sh -c "echo it is broken; exit 1")
add_test(part/idle sh -c "echo skipped: no moon; exit 77")
set_tests_properties(part/idle PROPERTIES SKIP_RETURN_CODE 77)
END
ends 8 "$source_dir/scripts/run_tests.sh" build 1
cat "$work/stdout" "$work/stderr" > said
holds grep -qF "tests (build): 1 passed, 2 failed, 1 did not run, of 4" said
holds grep -qF "it is broken" said
holds grep -qxF "LEFT OUT, no moon: part/idle" said
again=$(sed -n 's/^Again: //p' said)
holds [ -n "$again" ]
eval "$again" > said 2>&1
holds grep -qF "2 tests failed out of 2" said
holds grep -qF "part/wrong" said
holds [ "$(grep -c "part/good " said)" = 0 ]

echo 'add_test(part/good true)' > build/CTestTestfile.cmake
ends 0 "$source_dir/scripts/run_tests.sh" build 1
holds [ "$(grep -c "Again" "$work/stdout")" = 0 ]
echo "$checked checked, $failed failed"
[ "$failed" = 0 ]
