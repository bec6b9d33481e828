# SPDX-License-Identifier: MIT
"""The package's numbers are the headers', and its structs the door's: a C compiler tells numbers, sizes and offsets."""

import ctypes
import os
import subprocess
from pathlib import Path

from conftest import SOURCE

from smartvis import _abi, _door

HEADERS = ["smartvis_plugin.h", *(f"smartvis/{name}.h" for name in ("confidence", "needs", "points", "timing"))]
FORMATS = {int: "lld", float: ".1f", str: "s"}
CASTS = {int: "(long long)", float: "(double)", str: ""}
CONSTANTS = _abi.NUMBERS | _door.NUMBERS


def told_by_the_compiler(folder: Path) -> dict[str, str]:
    lines = [f'printf("{n} %{FORMATS[type(v)]}\\n", {CASTS[type(v)]}({n}));' for n, v in CONSTANTS.items()]
    for name, struct in _door.STRUCTS.items():
        lines.append(f'printf("{name} %zu\\n", sizeof({name}));')
        for field, *_ in struct._fields_:
            member = f"((({name} *)0)->{field})"
            lines.append(f'printf("{name}.{field} %zu %zu\\n", offsetof({name}, {field}), sizeof{member});')
    source = "".join(f"#include <{h}>\n" for h in [*HEADERS, "smartvis_host.h"])
    source += "#include <stddef.h>\n#include <stdio.h>\nint main(void) {\n" + "\n".join(lines) + "\nreturn 0;\n}\n"
    (folder / "told.c").write_text(source)
    compiler = os.environ.get("CC", "cc")
    folders = (f"-I{SOURCE / 'include'}", f"-I{SOURCE / 'host_sim/door'}")
    subprocess.run([compiler, *folders, folder / "told.c", "-o", folder / "told"], check=True)
    out = subprocess.run([folder / "told"], check=True, capture_output=True, text=True).stdout
    return dict(line.split(" ", 1) for line in out.splitlines())


def test_every_number_size_and_offset_is_the_headers(tmp_path: Path) -> None:
    told = told_by_the_compiler(tmp_path)
    ours = {n: str(v) for n, v in CONSTANTS.items()}
    for name, struct in _door.STRUCTS.items():
        ours[name] = str(ctypes.sizeof(struct))
        for field, *_ in struct._fields_:
            at = getattr(struct, field)
            ours[f"{name}.{field}"] = f"{at.offset} {at.size}"
    assert len(ours) > 200
    assert ours == told


def test_nothing_of_the_doors_header_is_missing() -> None:
    text = (SOURCE / "host_sim/door/smartvis_host.h").read_text()
    functions = [
        line.split("(")[0].split()[-1].lstrip("*") for line in text.splitlines() if line.startswith("SVH_EXPORT")
    ]
    assert len(functions) > 20
    for name in functions:
        assert getattr(_door.library(), name).argtypes is not None, name


def test_no_status_of_the_header_is_missing() -> None:
    text = (SOURCE / "include" / "smartvis_plugin.h").read_text()
    for line in text.splitlines():
        word = line.strip().split(" ")[0]
        if word.startswith(("SV_ERR_", "SV_PARAM_", "SV_LOG_")):
            assert word in CONSTANTS, word
