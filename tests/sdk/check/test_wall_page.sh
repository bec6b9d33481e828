#!/bin/bash
# SPDX-License-Identifier: MIT
# test_wall_page.sh SOURCE_FOLDER: the table of constants in docs/surface.md has every constant of SV_WALL_CONSTANTS with its value,
# and no others.
set -eu
python3 -B - "$1" << 'END'
import re
import sys
from pathlib import Path

root = Path(sys.argv[1])
source = (root / "src/wall_layout.h").read_text()
code = {name: float(value) for name, value in re.findall(r"CONSTANT\((\w+), ([0-9.]+)\)", source) if name != "q"}  # a parameter
page = {}
for line in (root / "docs/surface.md").read_text().splitlines():
    row = re.match(r"\|[0-9, ]+\| (`[a-z_`, ]+`) \| ([0-9., ]+)(?: mm)? \|", line)
    if row:
        names, values = re.findall(r"\w+", row.group(1)), [float(value) for value in row.group(2).split(",")]
        assert len(names) == len(values), f"docs/surface.md: {line}: {len(names)} names, {len(values)} values"
        page |= zip(names, values)
assert len(code) > 20, f"src/wall_layout.h: {len(code)} constants found"
wrong = [f"{name}: {page.get(name, 'not there')} on the page, {code.get(name, 'none')} in the code"
         for name in sorted(page.keys() | code.keys()) if page.get(name) != code.get(name)]
sys.exit("docs/surface.md, the table of constants:\n" + "\n".join(wrong) if wrong else 0)
END
