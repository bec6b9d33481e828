#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fill_wheel.py WHEEL CONTENT OUT [PLATFORM]: the wheel with the files of CONTENT as well, CONTENT/plugin beside the plugin and CONTENT/licences
among its licences, written to the folder OUT; PLATFORM takes the place of the one in its name and tag. Needs auditwheel's environment."""

import re
import shutil
import sys
from pathlib import Path

from auditwheel.wheeltools import InWheel

wheel, content, out = map(Path, sys.argv[1:4])
platform = sys.argv[4] if sys.argv[4:] else wheel.stem.split("-")[-1]
with InWheel(wheel, out.absolute() / f"{wheel.stem.rsplit('-', 1)[0]}-{platform}.whl") as root:
    info = next(Path(root).glob("*.dist-info"))
    shutil.copytree(content / "plugin", Path(root, "smartvis", "plugin"), dirs_exist_ok=True)
    shutil.copytree(content / "licences", info / "licenses", dirs_exist_ok=True)
    tags = info / "WHEEL"
    tags.write_text(re.sub(r"(?m)^(Tag: .*-).*$", rf"\g<1>{platform}", tags.read_text()))
