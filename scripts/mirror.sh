# SPDX-License-Identifier: MIT
# Sourced. find_mirror SUITE SCRATCH_FOLDER: prints the first repository of apt's configuration that has the suite. apt itself downloads,
# so its proxies hold.
find_mirror() {
    command -v apt-get > /dev/null || return 1
    local uri
    while read -r uri; do
        if /usr/lib/apt/apt-helper download-file "${uri%/}/dists/$1/Release" "$2/Release" > /dev/null 2>&1; then
            echo "$uri"
            return 0
        fi
    done < <(apt-get indextargets --format '$(REPO_URI)' | grep -E '^https?:' | awk '!seen[$0]++')
    return 1
}
