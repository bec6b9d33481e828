#!/bin/bash
# SPDX-License-Identifier: MIT
# bare_root.sh: what a newcomer does, on a bare Debian of any suite. The text below says how.
set -eu

usage() {
    cat << 'END'
Usage: scripts/bare_root.sh [OPTION...] SUITE TARGET...

Makes a root of the Debian SUITE (bookworm, trixie) that holds the essential packages, make and ca-certificates, puts a
clean clone of this checkout in it, and runs `make TARGET` there for each TARGET. Everything else must come from the
targets themselves, but for the certificates that this machine trusts beyond Debian's. A TARGET of the form NAME=VALUE is a
variable for all of them (SV_WERROR=ON). The clone has what is committed.

  --dir FOLDER   where the root is made: a folder that is empty or not there (default: a new one in $TMPDIR or /tmp)
  --mirror URL   Debian mirror (default: the first repository of apt's configuration that has the SUITE)
  --bring FOLDER copied into the clone, as out/<its name>: what was built elsewhere, for a target that tries it
  --keep         leave the root there at the end, unmounted
  --help         print this text

Needs root, debootstrap, git, unshare (util-linux), and 3 GB of disk. Without --keep, the root is removed at the end,
however that comes.

Exit code: 0 all targets succeeded; 1 a target failed; 2 wrong call; 3 not possible here (not root, a program or a mirror is
missing, no namespaces, the folder is in use); 4 the root could not be made; 130 interrupted.
END
}

stop() { # stop CODE MESSAGE
    echo "bare_root: $2" >&2
    exit "$1"
}

# debootstrap reads the proxy from its environment, where apt reads it from its configuration.
export_proxies() {
    command -v apt-config > /dev/null || return 0
    local scheme proxy
    for scheme in http https; do
        proxy=
        eval "$(apt-config shell proxy "Acquire::$scheme::Proxy")"
        [ -z "$proxy" ] || export "${scheme}_proxy=$proxy"
    done
}

# Prints the certificates of the bundle HERE that the bundle THERE lacks, one after the other.
certificates_beyond() { # certificates_beyond THERE HERE
    awk '/BEGIN CERTIFICATE/ { one = "" } { one = one $0 "\n" }
        /END CERTIFICATE/ { if (FILENAME == ARGV[1]) known[one] = 1; else if (!(one in known)) printf "%s", one }' "$1" "$2"
}

# Whom the machine trusts beyond Debian's list, such as the proxy of a company, the root trusts, too: what comes by https
# passes there as here.
trust_as_here() { # trust_as_here ROOT
    local bundle=etc/ssl/certs/ca-certificates.crt own=$1/usr/local/share/ca-certificates/machine
    [ -s "/$bundle" ] && [ -s "$1/$bundle" ] || return 0
    mkdir -p "$own"
    certificates_beyond "$1/$bundle" "/$bundle" | awk -v own="$own" '/BEGIN CERTIFICATE/ { n++ } { print > (own "/" n ".crt") }'
    chroot "$1" update-ca-certificates > /dev/null
}

make_root() { # make_root ROOT SUITE MIRROR CHECKOUT BRING
    # A mount point of its own: only so can what runs in it make namespaces, as a test of this script does.
    mount --bind "$1" "$1" || return 1
    chmod 755 "$1" || return 1 # as / is: a user other than root reads it, too
    debootstrap --variant=minbase --include=make,ca-certificates "$2" "$1" "$3" || return 1
    # The machine's way to the mirror holds in the root, too: proxies, and which dates apt checks.
    if command -v apt-config > /dev/null; then
        apt-config dump | grep -E '^Acquire::(https?::Proxy|Check-Date|Check-Valid-Until) ' \
            > "$1/etc/apt/apt.conf.d/10machine" || true
    fi
    trust_as_here "$1" || return 1
    git clone --quiet --no-hardlinks "$4" "$1/smartvis" || return 1
    [ -z "$5" ] || { mkdir -p "$1/smartvis/out" && cp -r "$5" "$1/smartvis/out/"; } || return 1
    mount -t proc proc "$1/proc" && mount --rbind /sys "$1/sys" && mount --rbind /dev "$1/dev"
}

# Runs as the first process of namespaces of its own: when it ends, in whatever way, so do all processes and mounts.
inside() { # inside ROOT SUITE MIRROR CHECKOUT BRING TARGET...
    local root=$1 suite=$2 target start variables=() targets=() code=0
    make_root "$1" "$2" "$3" "$4" "$5" || stop 4 "the root of $suite could not be made"
    shift 5
    for target in "$@"; do
        case $target in
        *=*) variables+=("$target") ;;
        *) targets+=("$target") ;;
        esac
    done
    local results=()
    for target in "${targets[@]}"; do
        start=$SECONDS
        if env -i HOME=/root LANG=C.UTF-8 PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin \
            chroot "$root" make -C /smartvis "${variables[@]}" "$target"; then
            results+=("bare_root: $suite: make $target: ok ($((SECONDS - start)) s)")
        else
            results+=("bare_root: $suite: make $target: FAILED ($((SECONDS - start)) s)")
            code=1
        fi
    done
    printf '%s\n' "${results[@]}"
    return $code
}

if [ "${1:-}" = --inside ]; then
    shift
    inside "$@"
    exit
fi

folder= mirror= bring= keep=0
while [[ ${1:-} == -* ]]; do
    case $1 in
    --help)
        usage
        exit 0
        ;;
    --keep) keep=1 ;;
    --dir | --mirror | --bring)
        [ -n "${2:-}" ] || stop 2 "$1 has no value"
        case $1 in
        --dir) folder=$2 ;;
        --mirror) mirror=$2 ;;
        --bring) bring=$2 ;;
        esac
        shift
        ;;
    *) stop 2 "unknown option '$1' (--help lists them)" ;;
    esac
    shift
done
[ $# -gt 0 ] || stop 2 "no SUITE (--help explains)"
suite=$1
shift
[[ $suite =~ ^[a-z][a-z0-9.-]*$ ]] || stop 2 "'$suite' is no name of a suite"
named=0
for target in "$@"; do
    [[ $target =~ ^[A-Za-z][A-Za-z0-9_-]*(=.*)?$ ]] || stop 2 "'$target' is neither a target nor NAME=VALUE"
    [[ $target == *=* ]] || named=1
done
[ $named = 1 ] || stop 2 "no TARGET for '$suite' (--help explains)"

[ -z "$bring" ] || [ -d "$bring" ] || stop 2 "--bring $bring is no folder"
[ "$(id -u)" -eq 0 ] || stop 3 "not root (user id $(id -u)): making and entering a root needs it"
PATH=$PATH:/usr/sbin:/sbin
for program in debootstrap git unshare; do
    command -v "$program" > /dev/null || stop 3 "$program is missing: apt-get install debootstrap git util-linux"
done
unshare --mount --pid --fork true 2> /dev/null || stop 3 "unshare makes no namespaces here: in a container, this needs SYS_ADMIN"
checkout=$(cd "$(dirname "$0")/.." && pwd)
changes=$(git -C "$checkout" status --porcelain) || stop 3 "$checkout is no checkout that git reads"
[ -z "$changes" ] || echo "bare_root: what is not committed is left out" >&2
if [ -n "$folder" ]; then
    [ ! -e "$folder" ] || [ -d "$folder" ] || stop 3 "--dir $folder is no folder"
    [ -z "$(ls -A "$folder" 2> /dev/null)" ] || stop 3 "--dir $folder is not empty"
fi

[ -z "$bring" ] || bring=$(cd "$bring" && pwd)

scratch=$(mktemp -d)
child=
# Processes that were killed may still be writing: a second attempt finds them gone.
remove() { rm -rf --one-file-system "$@" 2> /dev/null || { sleep 2 && rm -rf --one-file-system "$@"; }; }
clean_up() {
    [ -z "$child" ] || kill -KILL "$child" 2> /dev/null || true
    remove "$scratch"
    [ $keep = 1 ] || [ -z "$folder" ] || remove "$folder"
}
trap clean_up EXIT
trap 'exit 130' INT TERM HUP

if [ -z "$mirror" ]; then
    . "$checkout/scripts/mirror.sh"
    mirror=$(find_mirror "$suite" "$scratch") ||
        stop 3 "no repository of apt's configuration has '$suite': run apt-get update, or name one with --mirror URL"
fi
export_proxies
if [ -n "$folder" ]; then mkdir -p "$folder"; else folder=$(mktemp -d); fi
folder=$(cd "$folder" && pwd)
echo "bare_root: $suite from $mirror in $folder"

# In the background, so that a signal is heard at once: --kill-child then ends everything in the root.
unshare --mount --pid --fork --kill-child --propagation private \
    bash "$checkout/scripts/bare_root.sh" --inside "$folder" "$suite" "$mirror" "$checkout" "$bring" "$@" &
child=$!
code=0
wait "$child" || code=$?
child=
[ $keep = 0 ] || echo "bare_root: the root is $folder"
exit $code
