#!/bin/bash
# SPDX-License-Identifier: MIT
# test_validate_cli.sh SOURCE_FOLDER BUILD_FOLDER: the command line of sv_validate: options, exit codes, what is printed where.
set -u
build=$2
validate=$build/sv_validate
right=$build/wrong/right/params.so
wrong=$build/wrong/depth_nan.so
. "$1/tests/support/holds.sh"

# expect CODE TEXT ARGUMENT...: exit code and a pattern in what is printed.
expect() {
    ends "$1" timeout 600 "$validate" "${@:3}"
    holds grep -qE -- "$2" "$work/stdout" "$work/stderr"
}

expect 0 '^Usage: sv_validate' --help
expect 0 '^sv_validate [0-9.]+[+0-9a-f]*(.changed)?, plugin ABI 1\.1' --version
expect 0 '^state-walk +[A-Z]' --list
expect 2 'no library given'
expect 2 'more than one library' "$right" "$right"
expect 2 '--nonsense: not an option' --nonsense "$right"
expect 2 "no check 'depth'" --only depth "$right"
expect 2 '--level: 11 is outside 1 .. 10' --level 11 "$right"
expect 2 '--timeout' --timeout 0 "$right"
expect 3 'cannot be read' "$work/nothing.so"
expect 3 'not a file' "$work"
echo "no library" > "$work/text.so"
expect 3 'not a shared library' "$work/text.so"
: > "$work/empty.so"
expect 3 'not a shared library' "$work/empty.so"
# A library that the loader refuses has failed a check.
head -c 2000 "$right" > "$work/short.so"
expect 1 '^(fail|crash) +library-loads .*(dlopen|loading)' "$work/short.so"
expect 1 '^fail +instance-whole|no plugin with the id' --only first-frame --id org.nobody "$right"
expect 0 '1 pass' --only first-frame --id org.smartvis.test.wrong "$right"
expect 1 '^fail +depth-values .*NaN' --only depth-values "$wrong"
expect 1 'What to mend' --only depth-values "$wrong"
expect 0 '1 pass' --in-process --only first-frame "$right"
expect 0 '2 pass' --only first-frame --only depth-values "$right"
expect 0 '"verdict": "pass"' --json --only first-frame "$right"
expect 1 '"passed": false' --json --only depth-values "$wrong"
# AddressSanitizer ends a process that crashes by itself.
expect 1 '^crash +first-frame .*(SIGSEGV|left by exit.1.); under way: slab' "$build/wrong/crash_in_slab.so"
expect 1 '^crash +first-frame .*left by exit\(0\); under way: end' "$build/wrong/exit_in_end.so"
expect 1 '^crash +first-frame .*aborted; under way: slab' "$build/wrong/abort_in_slab.so"
expect 1 '^timeout +first-frame .*ran out of time \(2\.0 s\); under way: end' --timeout 12 --junit "$work/hang.xml" "$build/wrong/hang_in_end.so"
# A kernel that does not end is told by its name, before the time for a check is over, although the first frame may compile.
expect 1 '^timeout +first-frame .*ran out of time \(5\.0 s\); under way: .*; running: kernel find' --timeout 30 \
    --only first-frame "$build/wrong/hang_in_kernel.so"
# A loop beside OpenCL is told as soon, in the first frame, too; what OpenCL takes there may be a compilation.
expect 1 '^timeout +first-frame .*ran out of time \(1\.5 s\); under way: slab .*; values of the frame: the defaults' \
    --timeout 9 --only first-frame "$build/wrong/hang_beside_opencl.so"
expect 0 '1 pass' --timeout 9 --only first-frame "$build/wrong/frame_waits_long.so"
# A frame that does not end costs a sixth of the time for a check, and is told with its values and an advice of its own.
expect 1 '^timeout +param-fuzz .*ran out of time \(3\.0 s\); under way: end; values of the frame: .*gap = 5[,;]' --timeout 18 \
    --only param-fuzz "$build/wrong/hang_with_value.so"
holds grep -q '^      Look for a loop or a wait' "$work/stdout"
expect 1 '^skip +state-walk .*first-frame did not pass' "$build/wrong/crash_in_slab.so"
# The device is the one that plugin and host take. Where there is none, that is told, and no run that could try nothing passes.
blocks=$build/wrong/frame_blocks.so
for wish in "" cpu; do SMARTVIS_DEVICE=$wish expect 1 '^fail +frame-path-opencl' --only frame-path-opencl "$blocks"; done
SMARTVIS_DEVICE=gqu expect 5 "first-frame: SMARTVIS_DEVICE is 'gqu', expected 'cpu' or 'gpu'" --level 1 "$blocks"
SMARTVIS_DEVICE=gqu expect 5 "SMARTVIS_DEVICE is 'gqu'" --json --in-process --only frame-path-opencl "$blocks"
OCL_ICD_VENDORS=$work/none expect 5 "frame-path-opencl: no OpenCL platform: .* is '$work/none'" --only frame-path-opencl "$blocks"
SMARTVIS_DEVICE=gqu expect 0 '1 pass' --only first-frame "$right" # it computes without one
# A pipe that the caller left open, and that nobody reads: not the plugin's.
mkfifo "$work/pipe"
: < "$work/pipe" &
exec 9> "$work/pipe"
wait
expect 1 '^fail +process-untouched' --only process-untouched "$build/wrong/writes_to_files.so"
exec 9>&-
# In a pipe there are no colours, and nothing that the plugin printed or that a terminal would obey.
lacks() { ! grep -q "$@" "$work/stdout"; }
expect 1 'param-strings' "$build/wrong/param_key_blank.so"
holds lacks -P '[\x00-\x08\x0b-\x1f\x7f]'
expect 1 'process-untouched' "$build/wrong/prints.so"
holds lacks '^slab '
# The same seed tries the same. A wrong map is found after as many random calls, whatever else the machine does.
for seed in 1 1 2; do
    "$validate" --only state-walk --only param-fuzz --seed $seed "$build/wrong/lost_after_adjust.so" |
        sed -nE 's/^(fail|pass) +([a-z-]+) +[0-9.]+ s/\1 \2/p' >> "$work/seed$seed"
done
holds [ "$(sort -u "$work/seed1" | wc -l)" -eq 2 ] # the same findings
holds [ -s "$work/seed2" ]
# JUnit's XML is well-formed, counts as the lines do, and has the texts; a place where it cannot be is found first. Of a path,
# too, XML's own characters are escaped, and those that XML does not know.
odd="$work/a<b>&\"c"$'\x01\xff'.so
cp "$right" "$odd"
expect 6 'no/junit.xml: cannot be created' --junit "$work/no/junit.xml" "$right"
expect 0 '1 pass' --only library-loads --junit "$work/odd.xml" "$odd"
expect 1 '^crash' --junit "$work/junit.xml" "$build/wrong/crash_in_slab.so"
holds python3 - "$work/junit.xml" "$work/stdout" "$work/odd.xml" "$work/hang.xml" << 'END'
import re, sys, xml.etree.ElementTree as tree
suite, lines = tree.parse(sys.argv[1]).getroot(), open(sys.argv[2]).read()
cases = {case.get("name"): case for case in suite.findall("testcase")}
count = {v: len(re.findall(f"^{v} +[a-z-]+ +[0-9.]+ s", lines, re.M)) for v in ("fail", "crash", "timeout", "skip")}
assert [int(suite.get(k)) for k in ("tests", "failures", "errors", "skipped")] == [
    len(cases), count["fail"], count["crash"] + count["timeout"], count["skip"]], (suite.attrib, count)
error = cases["first-frame"].find("error")
assert error.get("type") == "crash" and error.get("message") in lines, error.attrib
assert "Three frames come out" in error.text
assert cases["state-walk"].find("skipped").get("message") == "first-frame did not pass"
assert len(cases["library-loads"]) == 0
late = tree.parse(sys.argv[4]).getroot()
assert late.get("errors") == "1" and late.find("testcase/error").get("type") == "timeout", late.attrib
assert 'a<b>&"c\\x01\\xff.so' in tree.parse(sys.argv[3]).getroot().get("name")
END
# Too few descriptors are not the plugin's fault.
few() { (ulimit -n 32 && ends 7 "$validate" "$right" && grep -q 'may open 32 files (ulimit -n), 64 are needed' "$work/stderr"); }
holds few
# A full disk is no success, and hides nothing that was found.
full() { # full CODE ARGUMENT...
    local found=0
    "$validate" "${@:2}" > /dev/full 2> /dev/null || found=$?
    [ $found -eq "$1" ]
}
holds full 6 --list
holds full 6 --only first-frame "$right"
holds full 1 --only first-frame --only depth-values "$wrong"
[ $failed = 0 ]
