# SPDX-License-Identifier: MIT
"""The reader's side of `_process`: reads and writes what foreign libraries know, until nobody asks any more."""

from __future__ import annotations

import os
import pickle
import signal
import sys
from pathlib import Path
from typing import Any

from . import _images, _unsay
from ._complaints import reason
from ._errors import FileError, HostError, MissingExtraError, OutputError, state_of
from ._reader import Reader

_reader: Reader | None = None  # of the file that was asked for last


def open_file(path: str, mirror: bool) -> dict[str, Any]:
    """What is known of a file before a volume is read."""
    global _reader
    _reader = None
    _reader = Reader(path, mirror=mirror)
    return {"count": _reader.count, "names": [volume.name for volume in _reader._dicom]}


def read(path: str, mirror: bool, number: int) -> tuple[Any, ...]:
    """A volume as (voxels, spacing, origin, direction, notes), and whether the file knows the patient."""
    if _reader is None or str(_reader.path) != path or _reader._mirror != mirror:
        open_file(path, mirror)
    assert _reader is not None
    return (*_images.parts(_reader.read(number)), _reader.knows_patient)


def write(path: str, part: str, image: tuple[Any, ...]) -> None:
    """Writes an image in the format that `part` names, compressed where the format can."""
    try:
        notes = image[-1]
        said = {_images.FILE_NOTES: _images.UNPLACED} if _images.PLACE in notes else {}
        _images.sitk().WriteImage(_images.whole(*(*image[:-1], said)), part, True)
        if _images.NOT_SAID in notes or _images.PLACE in notes:
            _unsay.unsay(Path(part), spacing=_images.NOT_SAID in notes, place=_images.PLACE in notes)
    except RuntimeError as error:
        raise OutputError(f"{path}: {reason(error)}") from None


def crash(_: str) -> None:
    """Dies as a library might: for tests."""
    os.abort()


def serve(version: tuple[int, int], answers: int, life: int) -> None:
    """Greets whoever started it, and answers until nobody asks any more. `answers` and `life` are descriptors, on
    Windows handles; the second closes when that process ends."""
    told = _opened(answers, os.O_WRONLY)
    if version != sys.version_info[:2]:
        _answer(told, (False, f"it is Python {sys.version_info[0]}.{sys.version_info[1]}"))
        return
    _end_with(_opened(life, os.O_RDONLY))
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _answer(told, (True, None))
    what: dict[str, Any] = {"open": open_file, "read": read, "write": write, "crash": crash}
    while True:
        try:
            name, *arguments = pickle.load(sys.stdin.buffer)
        except (EOFError, pickle.UnpicklingError):  # perhaps in the middle of a question
            return
        _answer(told, _what_comes_of(what[name], arguments))


def _what_comes_of(function: Any, arguments: list[Any]) -> tuple[bool, Any]:
    try:
        return True, function(*arguments)
    except MemoryError:
        return False, ("memory", f"{arguments[0]}: no memory to read it")
    except (FileError, MissingExtraError, HostError) as error:
        return False, (state_of(error), str(error))
    except RecursionError:
        return False, ("input", f"{arguments[0]}: is nested too deep")
    except Exception as error:
        return False, ("input", f"{arguments[0]}: cannot be read as a volume ({type(error).__name__})")


def _opened(number: int, how: int) -> int:
    """What was handed over, as a descriptor that no further process inherits."""
    if sys.platform == "win32":
        import msvcrt

        number = msvcrt.open_osfhandle(number, how | os.O_BINARY)
    os.set_inheritable(number, False)
    return number


def _end_with(life: int) -> None:
    """Whatever a library is at, the kernel ends this process when the other side has closed. Elsewhere than on Linux
    the end of the questions does, when the library is through."""
    if sys.platform == "linux":
        import fcntl

        fcntl.fcntl(life, fcntl.F_SETOWN, os.getpid())
        fcntl.fcntl(life, fcntl.F_SETSIG, signal.SIGKILL)
        fcntl.fcntl(life, fcntl.F_SETFL, fcntl.fcntl(life, fcntl.F_GETFL) | os.O_ASYNC)


def _answer(descriptor: int, answer: tuple[bool, Any]) -> None:
    with os.fdopen(descriptor, "wb", closefd=False) as file:
        pickle.dump(answer, file, protocol=5)
