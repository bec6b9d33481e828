#!/bin/bash
# SPDX-License-Identifier: MIT
# try_deb.sh FOLDER: what a newcomer does with the Debian packages in FOLDER: installs them and a compiler with apt, and runs
# the three commands of the template's README as they stand there, in an empty folder. Ends with 0 if there is a picture in
# which the plugin clipped. Needs root. On a bare Debian:
#     scripts/bare_root.sh --bring out/deb trixie try-deb
set -eu
folder=$1
shopt -s nullglob
packages=("$folder"/*.deb)
[ ${#packages[@]} -gt 0 ] || { echo "try_deb: no packages in $folder: run make deb" >&2; exit 1; }
[ "$(id -u)" -eq 0 ] || { echo "try_deb: not root: apt-get cannot install" >&2; exit 1; }
for i in "${!packages[@]}"; do packages[i]=$(realpath "${packages[i]}"); done
export DEBIAN_FRONTEND=noninteractive
apt-get update -q
apt-get install -y -q --no-install-recommends "${packages[@]}" cmake make gcc libc6-dev > /dev/null

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
readme=/usr/share/smartvis/examples/template/README.md
mapfile -t commands < <(sed -n 's/^    //p' "$readme")
[ ${#commands[@]} -eq 3 ] || { echo "try_deb: $readme has ${#commands[@]} commands, not three" >&2; exit 1; }
for command in "${commands[@]}"; do
    echo "\$ $command"
    bash -ec "$command" | tee -a log
done
grep -qE '^Frames: [1-9][0-9]* clipped' log || { echo "try_deb: the plugin clipped nothing" >&2; exit 1; }
[ "$(head -c 4 out/mine/panel.png | tail -c 3)" = PNG ] || { echo "try_deb: no picture" >&2; exit 1; }
man -P cat host_sim > /dev/null 2>&1 || test -s /usr/share/man/man1/host_sim.1.gz
echo "try_deb: the template, from three commands to a picture: ok"
