# SPDX-License-Identifier: MIT
"""The machine as a library (docs/host_library.md), as its header says: structs, numbers and functions are read from
smartvis_host.h. ``tests/test_abi.py`` compiles the header and compares every size, offset and number."""

from __future__ import annotations

import ctypes
import logging
import os
import re
import threading
import weakref
from functools import cache
from pathlib import Path
from typing import Any

from . import _abi, _host, _places, _runtime
from ._errors import DeviceError, HostError, LoadError
from ._text import plain

log = logging.getLogger("smartvis.plugin")

_HEADER = next(
    path
    for path in (Path(__file__).parent / "door" / "smartvis_host.h", _places.clone() / "host_sim/door/smartvis_host.h")
    if path.is_file()
)
_BASIC: dict[str, Any] = {
    "void": None,
    "char": ctypes.c_char,
    "uint8_t": ctypes.c_uint8,
    "uint16_t": ctypes.c_uint16,
    "uint32_t": ctypes.c_uint32,
    "int32_t": ctypes.c_int32,
    "uint64_t": ctypes.c_uint64,
    "float": ctypes.c_float,
    "double": ctypes.c_double,
}
LOG: Any = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int32, ctypes.c_char_p)


def _plain() -> str:
    """The header without comments and directives."""
    text = re.sub(r"/\*.*?\*/", "", _HEADER.read_text(), flags=re.DOTALL)
    return re.sub(r"^#.*(?:\\\n.*)*$", "", text, flags=re.MULTILINE)


def _constants(text: str) -> dict[str, int]:
    found: dict[str, int] = {}
    for body in re.findall(r"enum \{(.*?)\}", text, flags=re.DOTALL):
        value = -1
        for name, given in re.findall(r"(\w+)(?:\s*=\s*(\d+))?", re.sub(r"\d+u\b", lambda n: n[0][:-1], body)):
            value = int(given) if given else value + 1
            found[name] = value
    return found


def _kind(basic: str, name: str) -> Any:
    """The type of what is declared so; a pointer is an address, but for texts."""
    if "*" in name:
        return ctypes.c_char_p if basic == "char" else ctypes.c_void_p
    array = re.search(r"\[(\d+)\]", name)
    return _BASIC[basic] * int(array[1]) if array else _BASIC[basic]


def _structs(text: str) -> dict[str, type[ctypes.Structure]]:
    found: dict[str, type[ctypes.Structure]] = {}
    for body, struct in re.findall(r"typedef struct \{(.*?)\} (\w+);", text, flags=re.DOTALL):
        fields = []
        for line in filter(None, (part.strip() for part in body.split(";"))):
            function = re.match(r"void \(\*(\w+)\)", line)
            declared = re.match(r"(?:const )?(\w+)\s+(.*)", line, flags=re.DOTALL)
            if function:
                fields.append((function[1], LOG))
            elif declared:
                names = map(str.strip, declared[2].split(","))
                fields += [(re.sub(r"\[\d+\]|\W", "", name), _kind(declared[1], name)) for name in names]
        found[struct] = type(struct, (ctypes.Structure,), {"_fields_": fields})
    return found


def _declare(library: Any, text: str) -> None:
    """Types of results and arguments; whatever is a pointer may be given as a reference."""
    for result, star, name, arguments in re.findall(r"SVH_EXPORT (?:const )?(\w+) (\**)(\w+)\(([^)]*)\)", text):
        function = getattr(library, name)
        function.restype = _kind(result, star)
        given = [one.strip() for one in arguments.split(",") if one.strip() != "void"]
        kinds = [re.match(r"(?:const )?(\w+)", one)[1] for one in given]  # type: ignore[index]
        pointers = [re.sub(r"\[\d+\]", "*", one) for one in given]
        function.argtypes = [
            _kind(kind if kind in _BASIC else "void", one) for kind, one in zip(kinds, pointers, strict=True)
        ]


_TEXT = _plain()
NUMBERS = _constants(_TEXT)
STRUCTS = _structs(_TEXT)


def sized(struct: str, **fields: object) -> Any:
    """A struct of the header with its ``size`` set."""
    made: Any = STRUCTS[struct](**fields)
    made.size = ctypes.sizeof(made)
    return made


@cache
def library() -> Any:
    """The library; LoadError: it cannot be loaded."""
    path = _places.find(f"libsmartvis_host{_runtime.LIBRARY}")
    _runtime.use_one()
    try:
        loaded = ctypes.CDLL(str(path))
    except OSError as error:
        loader = " (sudo apt-get install ocl-icd-libopencl1)" if "libOpenCL.so" in str(error) else ""
        if _runtime.WINDOWS:  # which does not say what is missing
            loader = _runtime.mend(_abi.SV_ERR_NO_DEVICE, "")
        raise LoadError(f"{path}: {error}{loader}") from None
    _declare(loaded, _TEXT)
    return loaded


def call(name: str, *arguments: Any) -> None:
    """Calls a function that can fail. ValueError, DeviceError, MemoryError; `Failed` if a plugin is to blame."""
    _runtime.check_process()
    error = sized("svh_error")
    code = getattr(library(), name)(*arguments, ctypes.byref(error))
    if code == NUMBERS["SVH_OK"]:
        return
    text = error.text.decode("utf-8", "replace")
    if code == NUMBERS["SVH_DEVICE"]:
        raise DeviceError(text + _runtime.cure(text))
    if code == NUMBERS["SVH_MEMORY"]:
        raise MemoryError(text)
    if code == NUMBERS["SVH_PLUGIN"]:
        raise Failed(text, error.status, error.call.decode(), error.reason.decode("utf-8", "replace"))
    raise ValueError(text)


def free(name: str, handle: Any) -> None:
    """Gives an object back, unless it is of the process that this one was forked from: who waits there waits for
    ever."""
    if not _runtime.is_forked():
        getattr(library(), name)(handle)


class Failed(Exception):  # it never reaches a user
    """A plugin is to blame: what `_plugin` makes its own errors of."""

    def __init__(self, text: str, status: int, call: str, reason: str) -> None:
        super().__init__(text)
        self.text, self.status, self.call, self.reason = text, status, call, reason


_LEVELS = {_abi.SV_LOG_DEBUG: logging.DEBUG, _abi.SV_LOG_INFO: logging.INFO, _abi.SV_LOG_WARNING: logging.WARNING}


@LOG  # type: ignore[untyped-decorator]
def _on_log(_context: object, severity: int, text: bytes) -> None:
    log.log(_LEVELS.get(severity, logging.ERROR), "%s", plain((text or b"").decode("utf-8", "replace")))


def _guard_program() -> bytes | None:
    """host_sim, in which other plugins run; without it they are refused."""
    try:
        return os.fsencode(os.path.abspath(_host.find()))
    except HostError:
        return None


_lock = threading.Lock()
_hosts: list[Any] = []


def host() -> Any:
    """The package's one host: one OpenCL context for all that it does."""
    with _lock:
        if not _hosts:
            opened = ctypes.c_void_p()
            options = sized("svh_options", log=_on_log, program=_guard_program())
            call("svh_open", ctypes.byref(options), ctypes.byref(opened))
            _hosts.append(opened)
            # At the end of the process finalizers run from the last that was made: what lies in the host goes first.
            # `atexit` has another order: all of them in one place, where the process made its first one.
            weakref.finalize(opened, free, "svh_close", opened.value)
        return _hosts[0]
