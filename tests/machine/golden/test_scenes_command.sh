#!/bin/bash
# SPDX-License-Identifier: MIT
# test_scenes_command.sh SOURCE BUILD: the command `host_sim scenes` from end to end: list, exit codes, exported files, the
# same bytes whatever the number of threads, a contact sheet.
set -u
host_sim=$2/host_sim
[ -x "$host_sim" ] || { echo "no $host_sim"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failed=0
fail() {
    echo "FAILED: $*"
    failed=1
}
code() { # code EXPECTED ARGUMENTS...: the exit code, and on an error one line that says what is wrong
    local expected=$1
    shift
    "$host_sim" scenes "$@" > "$folder/out" 2> "$folder/err"
    local found=$?
    [ $found -eq "$expected" ] || fail "scenes $*: exit code $found, expected $expected: $(cat "$folder/err")"
}

code 0 --help
grep -q -- '--sheet' "$folder/out" || fail "--help does not name --sheet"
code 0
[ "$(grep -cE '^(E0[1-4]|M0[1-3]|D0[12]|real) ' "$folder/out")" -eq 10 ] || fail "the list does not hold the ten scenes"
[ "$(grep -cE '^H(0[1-9]|1[0-6]) ' "$folder/out")" -eq 16 ] || fail "the list does not hold the hard cases"
cp "$folder/out" "$folder/list"
code 0 --list
cmp -s "$folder/list" "$folder/out" || fail "--list prints another list than no argument"
for file in "$1"/data/scenes/*.json; do
    grep -q "^$(basename "$file" .json) " "$folder/list" || fail "the list does not hold $file"
done

# The table of ranges.
code 0 --ranges
[ "$(grep -c '^| ' "$folder/out")" -gt 40 ] || fail "--ranges prints no table"

code 2 --size 31 D01
grep -q 'size: 31' "$folder/err" || fail "a wrong size is not named: $(cat "$folder/err")"
code 2 --all D01
code 2 --colour
code 2 D01 --frames
code 2 real
code 2 --random 0
code 2 --random 2 --hard
code 2 --random 2 D01
code 2 D01 --set seed
grep -q "'seed' is not PATH=VALUE" "$folder/err" || fail "a wrong --set is not named: $(cat "$folder/err")"
code 3 D01 --set artefacts.haze.level_db=5
grep -q 'level_db: is 5, expected -60 .. 0' "$folder/err" || fail "a value out of range is not named: $(cat "$folder/err")"
code 3 R7_100000
code 3 Q77
code 3 "$folder/absent.json"
printf '{ "name": "x",\n  "title": "y", "seed": -3 }' > "$folder/bad.json"
code 3 "$folder/bad.json"
grep -q 'bad.json: seed: is -3' "$folder/err" || fail "file and field are not named: $(cat "$folder/err")"
code 6 D01 --size 32 --export --out /proc/none

code 0 E02 --size 48 --frames 2 --threads 1 --export --out "$folder/one"
code 0 E02 --size 48 --frames 2 --threads 3 --export --out "$folder/three"
diff -rq "$folder/one" "$folder/three" || fail "the bytes depend on the number of threads"
written=("$folder"/one/*)
[ ${#written[@]} -eq 11 ] || fail "two frames are not ten files and the scene: ${written[*]}"
cmp -s "$folder/one/E02_f000_full.mha" "$folder/one/E02_f001_full.mha" && fail "two frames are alike"
head -c 400 "$folder/one/E02_f000_near.mha" | grep -aq 'ElementType = MET_FLOAT' || fail "near is not float32"
"$host_sim" info "$folder/one/E02_f000_full.mha" | grep -q '48 x 48 x 48 voxels of 2.5' || fail "info does not read the volume"

# A random set: the same files and volumes by seed, whatever the number of threads; the JSON makes the same scene again.
code 0 --random 3 --seed 7 --json --out "$folder/set"
written=("$folder"/set/*)
[ "${written[*]##*/}" = "R7_0.json R7_1.json R7_2.json" ] || fail "--random --json wrote ${written[*]}"
code 0 --random 2 --seed 7 --size 40 --threads 1 --export --out "$folder/random"
cmp -s "$folder/set/R7_1.json" "$folder/random/R7_1.json" || fail "--json and --export write unlike scenes"
code 0 R7_1 --size 40 --threads 3 --export --out "$folder/again"
diff -q "$folder/random/R7_1_full.mha" "$folder/again/R7_1_full.mha" || fail "a random scene depends on threads or company"
code 0 "$folder/set/R7_1.json" --size 40 --export --out "$folder/file"
diff -q "$folder/random/R7_1_full.mha" "$folder/file/R7_1_full.mha" || fail "a scene's JSON makes another scene"
cmp -s "$folder/set/R7_0.json" "$folder/set/R7_1.json" && fail "two random scenes are alike"

# What --set changes is in the JSON, and the JSON makes the same volume.
code 0 E01 --size 40 --set artefacts.haze=on --set artefacts.haze.level_db=-5 --set artefacts.fan=off --export --out "$folder/changed"
grep -q '"haze"' "$folder/changed/E01.json" || fail "the JSON does not tell what --set switched on"
grep -q '"fan"' "$folder/changed/E01.json" && fail "the JSON tells what --set took away"
code 0 "$folder/changed/E01.json" --size 40 --export --out "$folder/changed_again"
cmp -s "$folder/changed/E01_full.mha" "$folder/changed_again/E01_full.mha" || fail "the changed scene's JSON makes another"

# As Kretz files: read and described; several frames are a sequence.
code 0 E02 --size 48 --export --format vol --out "$folder/vol"
[ -s "$folder/vol/E02_truth.vol" ] || fail "no truth as a Kretz file"
[ -s "$folder/vol/E02_label.mha" ] || fail "no label map beside the Kretz files"
"$host_sim" info "$folder/vol/E02_full.vol" > "$folder/out" || fail "info does not read the Kretz file"
for words in 'samples of' 'from 18 mm on; the sweep'"'"'s axis at -12 mm' 'sweep + at -y: a choice'; do
    grep -qF "$words" "$folder/out" || fail "info does not tell '$words': $(cat "$folder/out")"
done
"$host_sim" info --mirror "$folder/vol/E02_full.vol" > "$folder/out" || fail "info --mirror"
grep -qF 'sweep + at +y, mirrored' "$folder/out" || fail "info does not tell the mirror"
code 0 E02 --size 48 --frames 3 --export --format vol --out "$folder/sequence"
written=("$folder"/sequence/*)
[ ${#written[@]} -eq 3 ] || fail "a sequence is not two files and the scene: ${written[*]}"
"$host_sim" info "$folder/sequence/E02_full.vol" | grep -qF 'a sequence of 3 volumes' || fail "info does not count volumes"
code 2 E02 --export --format nrrd
code 2 E02 --format vol

code 0 real --real "$folder/one/E02_f000_truth.mha" --export --out "$folder/real"
[ -s "$folder/real/real_full.mha" ] || fail "real wrote no volume"
code 0 real --real "$folder/vol/E02_truth.vol" --export --out "$folder/real_vol"
[ -s "$folder/real_vol/real_full.mha" ] || fail "real wrote no volume before a Kretz file"
code 3 real --real "$folder/sequence/E02_truth.vol" --export --out "$folder/none"
grep -q 'E02_truth.vol: a sequence of 3 volumes, expected one volume' "$folder/err" || fail "a sequence is not named: $(cat "$folder/err")"

code 0 D01 --size 64 --sheet --out "$folder/sheet"
[ "$(head -c 4 "$folder/sheet/D01_sheet.png" | tail -c 3)" = PNG ] || fail "the contact sheet is no PNG"
exit $failed
