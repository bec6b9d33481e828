# SPDX-License-Identifier: MIT
# Sourced by test scripts: counts what they check, and what failed.
checked=0
failed=0

# Fails unless the command given succeeds.
holds() {
    checked=$((checked + 1))
    if ! "$@"; then
        echo "FAIL: $*"
        failed=$((failed + 1))
    fi
}
