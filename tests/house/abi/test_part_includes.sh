#!/bin/bash
# SPDX-License-Identifier: MIT
# test_part_includes.sh SOURCE_FOLDER BUILD_FOLDER: what a part of the house must not know is not found by its compiler. With the folders
# that each of its targets gives to the compiler, a header of every other part is included: what stands above it in docs/architecture.md
# compiles, and the rest fails with the header's name. (scripts/check_floors.py holds the floors inside a part, and paths with "..".)
set -eu
python3 -B - "$1" "$2" << 'END'
import json
import shlex
import subprocess
import sys
from pathlib import Path

HEADERS = {"include": "smartvis_plugin.h", "cl": "common/sv_shared.h", "src": "ref/ref_mean.h", "base": "core/error.h",
           "sdk": "rules/rules.h", "host_sim": "volume/volume.h", "lab": "eval/eval_case.h"}
MAY = {"src": "include cl src", "base": "include base", "sdk": "include base sdk", "host_sim": "include base host_sim",
       "lab": "include base host_sim lab", "lab/bench": "include base host_sim lab sdk", "host_sim/program": "include base host_sim lab"}
# Which a part's target may leave out: sv_system and sv_rules need less than their parts may know.
LESS = {"base": "include", "sdk": "base"}

source, build = (Path(name).resolve() for name in sys.argv[1:])
found = {}  # (part, folders): one of its files
for entry in json.loads((build / "compile_commands.json").read_text()):
    words = shlex.split(entry["command"])
    path = Path(entry["file"])
    if not path.is_relative_to(source) or "obj/tests/" in words[words.index("-o") + 1]:
        continue  # tests may see everything
    name = str(path.relative_to(source).parent)
    part = name if name in MAY else name.split("/")[0]
    folders = tuple(word for word in words if word.startswith("-I"))
    if part in MAY and folders:
        found.setdefault((part, folders), str(path.relative_to(source)))

wrong = tried = 0
for (part, folders), file in sorted(found.items()):
    for other, header in HEADERS.items():
        ran = subprocess.run(["cc", "-E", "-x", "c", *folders, "-"], input=f'#include "{header}"\n', capture_output=True, text=True,
                             check=False)
        tried += 1
        may = other in MAY[part].split()
        refused = f"fatal error: {header}: No such file or directory" in ran.stderr
        if may and (ran.returncode == 0 or (refused and other in LESS.get(part, ""))):
            continue
        if may or not refused:
            wrong += 1
            print(f"{file}: its target {'cannot' if may else 'can'} include {header} of {other}/", ran.stderr)
missing = set(MAY) - {part for part, _ in found}
print(f"{tried} includes tried from {len(found)} sets of folders, {wrong} wrong", f"nothing compiled of {missing}" if missing else "")
sys.exit(bool(wrong or missing or tried < 50))
END
