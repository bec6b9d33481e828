# SPDX-License-Identifier: MIT
"""The ABI in ctypes is the headers': a C compiler tells every size, offset and number."""

import ctypes
import os
import subprocess
from pathlib import Path

from conftest import SOURCE

from smartvis import _abi

HEADERS = [
    "smartvis_plugin.h",
    *(f"smartvis/{name}.h" for name in ("confidence", "needs", "points", "timing")),
]
STRUCTS = list(_abi.STRUCTS.values())
FORMATS = {int: "lld", float: ".1f", str: "s"}
CASTS = {int: "(long long)", float: "(double)", str: ""}
CONSTANTS = {**_abi.NUMBERS, "SV_ABI_MINOR": _abi.SV_ABI_MINOR}


def told_by_the_compiler(folder: Path) -> dict[str, str]:
    lines = [f'printf("{n} %{FORMATS[type(v)]}\\n", {CASTS[type(v)]}({n}));' for n, v in CONSTANTS.items()]
    for struct in STRUCTS:
        name = struct.__name__
        lines.append(f'printf("{name} %zu\\n", sizeof(struct {name}));')
        for field, *_ in struct._fields_:
            member = f"(((struct {name} *)0)->{field})"
            lines.append(f'printf("{name}.{field} %zu %zu\\n", offsetof(struct {name}, {field}), sizeof{member});')
    # Anonymous structs behind a typedef have no tag: the tag is made from the typedef.
    text = "".join((SOURCE / "include" / h).read_text() for h in HEADERS)
    tags = {s.__name__ for s in STRUCTS if f"struct {s.__name__} {{" not in text}
    assert not tags, f"structs without a tag in the headers: {tags}"
    source = "".join(f"#include <{h}>\n" for h in HEADERS)
    source += "#include <stdio.h>\nint main(void) {\n" + "\n".join(lines) + "\nreturn 0;\n}\n"
    (folder / "told.c").write_text(source)
    compiler = os.environ.get("CC", "cc")
    subprocess.run([compiler, "-I", SOURCE / "include", folder / "told.c", "-o", folder / "told"], check=True)
    out = subprocess.run([folder / "told"], check=True, capture_output=True, text=True).stdout
    return dict(line.split(" ", 1) for line in out.splitlines())


def test_every_number_size_and_offset_is_the_headers(tmp_path: Path) -> None:
    told = told_by_the_compiler(tmp_path)
    ours = {n: str(v) for n, v in CONSTANTS.items()}
    for struct in STRUCTS:
        ours[struct.__name__] = str(ctypes.sizeof(struct))
        for field, *_ in struct._fields_:
            at = getattr(struct, field)
            ours[f"{struct.__name__}.{field}"] = f"{at.offset} {at.size}"
    assert len(ours) > 150
    assert ours == told


def test_no_status_of_the_header_is_missing() -> None:
    text = (SOURCE / "include" / "smartvis_plugin.h").read_text()
    for line in text.splitlines():
        word = line.strip().split(" ")[0]
        if word.startswith(("SV_ERR_", "SV_PARAM_", "SV_LOG_")):
            assert word in CONSTANTS, word
