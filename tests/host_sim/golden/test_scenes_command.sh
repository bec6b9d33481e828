#!/bin/bash
# SPDX-License-Identifier: MIT
# test_scenes_command.sh SOURCE BUILD: the command `host_sim scenes` from end to end: list, exit codes, exported files, the
# same bytes whatever the number of threads.
set -u
host_sim=$2/host_sim
[ -x "$host_sim" ] || { echo "no $host_sim"; exit 77; }
. "$1/tests/support/holds.sh"
code() { # code EXPECTED ARGUMENTS...: the exit code; what is wrong is in stderr
    ends "$1" "$host_sim" scenes "${@:2}"
}
differ() { ! cmp -s "$1" "$2"; }
says() { # says WORDS ARGUMENTS...: host_sim info prints them
    ends 0 "$host_sim" info "${@:2}"
    holds grep -qF -- "$1" "$work/stdout"
}

code 0 --help
holds grep -q -- '--export' "$work/stdout"
code 0
holds [ "$(grep -cE '^(E0[1-4]|M0[1-3]|D0[12]|real) ' "$work/stdout")" -eq 10 ]
holds [ "$(grep -cE '^H(0[1-9]|1[0-6]) ' "$work/stdout")" -eq 16 ]
cp "$work/stdout" "$work/list"
for file in "$1"/data/scenes/*.json; do
    holds grep -q "^$(basename "$file" .json) " "$work/list"
done

code 2 --size 31 D01
holds grep -q 'size: 31' "$work/stderr"
code 2 --all D01
code 2 --colour
code 2 D01 --frames
code 2 real
code 2 --all --hard
code 3 R7_100000
code 3 Q77
code 3 "$work/absent.json"
printf '{ "name": "x",\n  "title": "y", "seed": -3 }' > "$work/bad.json"
code 3 "$work/bad.json"
holds grep -q 'bad.json: seed: is -3' "$work/stderr"
code 6 D01 --size 32 --export --out /proc/none

code 0 E02 --size 48 --frames 2 --threads 1 --export --out "$work/one"
code 0 E02 --size 48 --frames 2 --threads 3 --export --out "$work/three"
holds diff -rq "$work/one" "$work/three"
written=("$work"/one/*)
holds [ ${#written[@]} -eq 11 ]
holds differ "$work/one/E02_f000_full.mha" "$work/one/E02_f001_full.mha"
holds grep -aq 'ElementType = MET_FLOAT' "$work/one/E02_f000_near.mha"
says '48 x 48 x 48 voxels of 2.5' "$work/one/E02_f000_full.mha"

# A random scene: the same volume by seed and number, whatever the number of threads; its JSON makes the same scene again.
code 0 R7_1 R7_0 --size 40 --threads 1 --export --out "$work/random"
code 0 R7_1 --size 40 --threads 3 --export --out "$work/again"
holds diff -q "$work/random/R7_1_full.mha" "$work/again/R7_1_full.mha"
code 0 "$work/random/R7_1.json" --size 40 --export --out "$work/file"
holds diff -q "$work/random/R7_1_full.mha" "$work/file/R7_1_full.mha"
holds differ "$work/random/R7_0.json" "$work/random/R7_1.json"

# As Kretz files: read and described; several frames are a sequence.
code 0 E02 --size 48 --export --format vol --out "$work/vol"
holds [ -s "$work/vol/E02_truth.vol" ]
holds [ -s "$work/vol/E02_label.mha" ]
for words in 'samples of' 'from 18 mm on; the sweep'"'"'s axis at -12 mm' 'sweep + at -y: a choice'; do
    says "$words" "$work/vol/E02_full.vol"
done
says 'sweep + at +y, mirrored' --mirror "$work/vol/E02_full.vol"
code 0 E02 --size 48 --frames 3 --export --format vol --out "$work/sequence"
written=("$work"/sequence/*)
holds [ ${#written[@]} -eq 3 ]
says 'a sequence of 3 volumes' "$work/sequence/E02_full.vol"
code 2 E02 --export --format nrrd
code 2 E02 --format vol

code 0 real --real "$work/one/E02_f000_truth.mha" --export --out "$work/real"
holds [ -s "$work/real/real_full.mha" ]
code 0 real --real "$work/vol/E02_truth.vol" --export --out "$work/real_vol"
holds [ -s "$work/real_vol/real_full.mha" ]
code 3 real --real "$work/sequence/E02_truth.vol" --export --out "$work/none"
holds grep -q 'E02_truth.vol: a sequence of 3 volumes, expected one volume' "$work/stderr"
[ "$failed" -eq 0 ]
