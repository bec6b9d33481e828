# SPDX-License-Identifier: MIT
"""The plugin ABI in ctypes: what ``abi/`` of the repository tells of smartvis_plugin.h and the extensions' headers.

``types-VERSION.txt`` has a line for every field of a struct, ``constants-VERSION.txt`` one for every number and
text; names are the headers'. ``tests/test_abi.py`` compiles the headers and compares every size, offset and number.
"""

import ctypes
import re
from pathlib import Path
from typing import Any, TypeVar

from . import _places

# In the package, or in a checkout.
_FOLDER = next(f for f in (Path(__file__).parent / "abi", _places.clone() / "abi") if f.is_dir())
_NEWEST = max(_FOLDER.glob("types-*.txt"), key=lambda path: [int(n) for n in re.findall(r"\d+", path.name)])
_BASIC = {
    "void": None,
    "char": ctypes.c_char,
    "unsigned char": ctypes.c_uint8,
    "unsigned short int": ctypes.c_uint16,
    "int": ctypes.c_int32,
    "unsigned int": ctypes.c_uint32,
    "unsigned long int": ctypes.c_uint64,
    "float": ctypes.c_float,
    "double": ctypes.c_double,
}


def _constants(text: str) -> dict[str, int | float | str]:
    read = {"whole": int, "real": float, "text": str}
    rows = (line.split(" ", 2) for line in text.splitlines())
    return {name: read[kind](value) for name, kind, value in rows}


def _ctype(name: str, structs: dict[str, Any]) -> Any:
    """The type that C calls so. What the host lends by its address alone is an address: arrays, OpenCL's objects."""
    name = name.removesuffix(" const")
    if array := re.fullmatch(r"(.*)\[(\d+)\]", name):
        return _ctype(array[1], structs) * int(array[2])
    if function := re.fullmatch(r"(.*?)\((.*)\)\*", name):
        return ctypes.CFUNCTYPE(*(_ctype(part, structs) for part in (function[1], *function[2].split(", "))))
    if not name.endswith("*"):
        return structs[name] if name in structs else _BASIC[name]
    to = name[:-1].removesuffix(" const")
    if to == "char":
        return ctypes.c_char_p
    if to.endswith("*") or (to in structs and to != "sv_scanned"):
        return ctypes.POINTER(_ctype(to, structs))
    return ctypes.c_void_p


def _structs(text: str) -> dict[str, type[ctypes.Structure]]:
    fields: dict[str, list[tuple[int, str, str]]] = {}
    for line in text.splitlines():
        name, at, kind = line.split(" ", 2)
        struct, _, field = name.partition(".")
        fields.setdefault(struct, [])
        if field:
            fields[struct].append((int(at), field, kind))
    structs: dict[str, type[ctypes.Structure]] = {n: type(n, (ctypes.Structure,), {}) for n in fields}
    for struct, made in structs.items():
        made._fields_ = [(field, _ctype(kind, structs)) for _, field, kind in sorted(fields[struct])]
    return structs


SV_ABI_MINOR = int(_NEWEST.stem.rsplit(".", 1)[1])
NUMBERS = _constants(_NEWEST.with_name(_NEWEST.name.replace("types", "constants")).read_text())
STRUCTS = _structs(_NEWEST.read_text())
SELF: Any = ctypes.POINTER(STRUCTS["sv_plugin"])
LOG: Any = next(kind for field, kind, *_ in STRUCTS["sv_host"]._fields_ if field == "log")


def __getattr__(name: str) -> Any:
    """A struct or a constant of the headers."""
    try:
        return STRUCTS[name] if name in STRUCTS else NUMBERS[name]
    except KeyError:
        raise AttributeError(f"the headers have no {name}") from None


_Struct = TypeVar("_Struct", bound=ctypes.Structure)


def sized(struct: type[_Struct], **fields: object) -> _Struct:
    """A struct with its ``size`` set, as the header asks of whoever owns the memory."""
    made = struct(**fields)
    made.size = ctypes.sizeof(struct)
    return made
