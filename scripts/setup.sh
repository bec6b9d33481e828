#!/bin/bash
# SPDX-License-Identifier: MIT
# setup.sh [--check] LIST...: installs the Debian packages of the lists (scripts/packages*.txt) that are missing.
# Does nothing, and needs no network, if all are there. --check installs nothing: it names what is missing.
# Exit code 1 if packages are missing and were not installed.
set -eu

check_only=0
if [ "${1:-}" = --check ]; then
    check_only=1
    shift
fi

mapfile -t wanted < <(sed -e 's/#.*//' -e 's/[[:space:]]//g' -e '/^$/d' "$@")
if ! command -v dpkg-query > /dev/null; then
    echo "setup: this is no Debian. What is needed is the equivalent of: ${wanted[*]}" >&2
    exit 0
fi

# Names of the packages that are not installed. dpkg-query also fails for a name it never heard of: that is missing.
installed=$(dpkg-query -W -f='${Package} ${db:Status-Status}\n' "${wanted[@]}" 2> /dev/null || true)
missing=()
for package in "${wanted[@]}"; do
    grep -qxF "$package installed" <<< "$installed" || missing+=("$package")
done
[ ${#missing[@]} -gt 0 ] || exit 0

command="apt-get install -y --no-install-recommends ${missing[*]}"
if [ $check_only = 1 ]; then
    printf 'setup: missing Debian packages: %s\n' "${missing[*]}" >&2
    printf 'setup: install them as root with\n    apt-get update && %s\n' "$command" >&2
    printf 'setup: where others stand for them: cmake -S . -B build -G Ninja && cmake --build build\n' >&2
    exit 1
fi
if [ "$(id -u)" -ne 0 ]; then
    printf 'setup: missing Debian packages: %s\n' "${missing[*]}" >&2
    printf 'setup: not root, so they are not installed from here. Run\n' >&2
    printf "    sudo sh -c 'apt-get update && %s'\n" "$command" >&2
    exit 1
fi

export DEBIAN_FRONTEND=noninteractive
echo "setup: installing ${#missing[@]} Debian packages"
"$(dirname "$0")/quietly.sh" setup out/log/setup.log sh -c "apt-get update && $command"
