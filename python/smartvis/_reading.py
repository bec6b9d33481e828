# SPDX-License-Identifier: MIT
"""The reader's side of `_process`: reads and writes what foreign libraries know, until nobody asks any more."""

from __future__ import annotations

import ctypes
import os
import pickle
import signal
import sys
from pathlib import Path
from typing import Any

from . import _geometry, _images
from ._errors import FileError, HostError, MissingExtraError, OutputError
from ._reader import Reader, reason

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
        _images.sitk().WriteImage(_images.whole(*image), part, True)
        if _images.NOT_SAID in image[-1]:
            _geometry.unsay_spacing(Path(part))
    except RuntimeError as error:
        raise OutputError(f"{path}: {reason(error)}") from None


def crash(_: str) -> None:
    """Dies as a library might: for tests."""
    os.abort()


def serve() -> None:
    """Answers until nobody asks any more; ends with whoever started it."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(1, signal.SIGKILL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what a library prints is no answer
    what: dict[str, Any] = {"open": open_file, "read": read, "write": write, "crash": crash}
    while True:
        try:
            name, *arguments = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        try:
            answer: tuple[bool, Any] = (True, what[name](*arguments))
        except OutputError as error:
            answer = (False, ("output", str(error)))
        except MemoryError:
            answer = (False, ("memory", f"{arguments[0]}: no memory to read it"))
        except (FileError, MissingExtraError, HostError) as error:
            answer = (False, ("file", str(error)))
        except RecursionError:
            answer = (False, ("file", f"{arguments[0]}: is nested too deep"))
        except Exception as error:
            answer = (False, ("file", f"{arguments[0]}: cannot be read as a volume ({type(error).__name__})"))
        pickle.dump(answer, answers, protocol=5)
        answers.flush()
