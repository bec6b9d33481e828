#!/bin/bash
# SPDX-License-Identifier: MIT
# scripts/bare_root.sh: wrong calls are refused; targets run in a root with /proc; whatever happens, nothing is left mounted
# and the root is gone. debootstrap and git are stand-ins here, so that this takes no network; the root holds a shell and a
# "make" that does what its target says. Called with the source and the build folder. Skipped, but for the calls, where no
# namespaces can be made.
set -u
script=$1/scripts/bare_root.sh
. "$1/tests/support/holds.sh"

# says CODE WORDS COMMAND...: the command ends with CODE and says WORDS.
says() {
    ends "$1" "${@:3}"
    holds grep -qF -- "$2" "$work/stdout" "$work/stderr"
}

says 0 "Exit code:" bash "$script" --help
says 2 "no SUITE" bash "$script"
says 2 "no TARGET for 'trixie'" bash "$script" trixie
says 2 "no TARGET for 'trixie'" bash "$script" trixie JOBS=2
says 2 "unknown option '--twice'" bash "$script" --twice trixie test
says 2 "--dir has no value" bash "$script" --dir
says 2 "--bring has no value" bash "$script" --bring
says 2 "--bring /nowhere is no folder" bash "$script" --bring /nowhere trixie test
says 2 "'Trixie!' is no name of a suite" bash "$script" 'Trixie!' test
says 2 "'-k' is neither a target" bash "$script" trixie test -k

finish() {
    echo "$checked checked, $failed failed"
    [ $failed = 0 ] || exit 1
    exit "$1"
}
if [ "$(id -u)" -ne 0 ]; then
    says 3 "not root" bash "$script" trixie test
    echo "skipped: not root"
    finish 77
fi
# Read from stdin, because that user may not read this folder.
says 3 "not root (user id 65534)" setpriv --reuid 65534 --clear-groups bash -s -- trixie test < "$script"
unshare --mount --pid --fork true 2> /dev/null || {
    echo "skipped: no namespaces can be made here"
    finish 77
}

mkdir "$work/bin"
export PATH=$work/bin:$PATH MACHINE_TRUSTS=/etc/ssl/certs/ca-certificates.crt
cat > "$work/bin/git" << 'END'
#!/bin/bash
if [ "$3" = status ]; then exit 0; fi
mkdir "${@: -1}"
END
cat > "$work/bin/debootstrap" << 'END'
#!/bin/bash
root=$4 mirror=$5
[ "$mirror" != http://broken.invalid ] || exit 1
mkdir -p "$root"/{proc,sys,dev,bin,etc/apt/apt.conf.d,etc/ssl/certs}
# Trusts whom this machine trusts, but for the last.
if [ -s "$MACHINE_TRUSTS" ]; then
    head -n $(($(grep -n BEGIN "$MACHINE_TRUSTS" | tail -n 1 | cut -d : -f 1) - 1)) "$MACHINE_TRUSTS" \
        > "$root/etc/ssl/certs/ca-certificates.crt"
fi
printf '#!/bin/bash\necho told > /trust.txt\n' > "$root/bin/update-ca-certificates"
cp -L --parents /bin/bash $(ldd /bin/bash | grep -o '/[^ ]*') "$root"
cat > "$root/bin/make" << 'MAKE'
#!/bin/bash
echo "make $* home $HOME kernel $(< /proc/sys/kernel/ostype)"
[ -c /dev/null ] || exit 1
case ${@: -1} in
bad) exit 2 ;;
hang) while :; do read -t 1 -r < <(:) || :; done ;;
esac
MAKE
chmod +x "$root"/bin/{make,update-ca-certificates}
END
chmod +x "$work/bin/git" "$work/bin/debootstrap"

root=$work/root
bare() { bash "$script" --dir "$root" --mirror http://stand.in.invalid "$@"; }
nothing_left() { ! grep -qF " $root" /proc/self/mounts && [ ! -e "$root" ]; }

says 0 "make -C /smartvis JOBS=2 demo home /root kernel Linux" bare trixie JOBS=2 demo test
holds grep -qF "trixie: make test: ok" "$work/stdout"
holds nothing_left
says 1 "trixie: make bad: FAILED" bare trixie bad demo
holds grep -qF "trixie: make demo: ok" "$work/stdout"
holds nothing_left
says 4 "the root of trixie could not be made" bash "$script" --dir "$root" --mirror http://broken.invalid trixie demo
holds nothing_left
mkdir -m 700 "$root"
mkdir -p "$work/built"
echo 1 > "$work/built/thing"
says 0 "the root is $root" bare --keep --bring "$work/built" trixie demo
holds [ "$(stat -c %a "$root")" = 755 ] # every user of the root reads it
holds cmp "$work/built/thing" "$root/smartvis/out/built/thing"
holds [ -d "$root/smartvis" ]
if [ -s "$MACHINE_TRUSTS" ]; then
    own=$root/usr/local/share/ca-certificates/machine
    holds [ "$(ls "$own")" = 1.crt ]
    holds [ "$(cat "$own/1.crt")" = "$(tail -n "$(wc -l < "$own/1.crt")" "$MACHINE_TRUSTS")" ]
    holds [ "$(cat "$root/trust.txt")" = told ]
fi
holds [ -z "$(ls -A "$root/proc" "$root/dev" 2>&1 | grep -v ':$' | grep .)" ]
says 3 "--dir $root is not empty" bare trixie demo
rm -rf "$root"

# Ended from outside in the middle of a target.
bash "$script" --dir "$root" --mirror http://stand.in.invalid trixie hang > "$work/hanging" 2>&1 &
running=$!
for _ in $(seq 100); do
    ! grep -qF "smartvis hang" "$work/hanging" || break
    sleep 0.1
done
holds grep -qF "smartvis hang" "$work/hanging"
kill -TERM $running
wait $running
holds [ $? = 130 ]
holds nothing_left
finish 0
