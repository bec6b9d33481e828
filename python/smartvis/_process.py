# SPDX-License-Identifier: MIT
"""A process of its own for what foreign libraries read and write: a file at which one dies ends nothing else, and a
locale with a comma, which its own C library knows nothing of, changes no number."""

from __future__ import annotations

import contextlib
import os
import pickle
import signal
import subprocess
import sys
import threading
from typing import Any

from ._errors import FileError, OutputError

_lock = threading.Lock()  # one question at a time
_child: subprocess.Popen[bytes] | None = None
_owner: tuple[int, dict[str, str]] = (0, {})  # the process that started it, and what led its host and plugin then


def _now() -> tuple[int, dict[str, str]]:
    ours = ("SMARTVIS_", "OCL_", "POCL_", "PATH")
    return os.getpid(), {name: value for name, value in os.environ.items() if name.startswith(ours)}


def _start() -> subprocess.Popen[bytes]:
    global _child, _owner  # one of them serves the process
    if _child is None or _child.poll() is not None or _owner != _now():
        if _child is not None and _owner[0] == os.getpid() and _child.stdin is not None:
            _child.stdin.close()
            _child.wait()
        environment = {k: v for k, v in os.environ.items() if not k.startswith("LC_")} | {"LC_ALL": "C.UTF-8"}
        paths = [os.path.dirname(os.path.dirname(os.path.abspath(__file__))), *sys.path]
        code = f"import sys; sys.path[:0] = {paths[:1]!r}; from smartvis._reading import serve; serve()"
        _child = subprocess.Popen(
            [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=environment
        )
        _owner = _now()
    return _child


def ask(what: str, path: object, *arguments: Any) -> Any:
    """What the reader's function `what` returns for a file; FileError with its reason, or that it died."""
    with _lock:
        child = _start()
        assert child.stdin is not None and child.stdout is not None
        try:
            pickle.dump((what, path, *arguments), child.stdin)
            child.stdin.flush()
            good, answer = pickle.load(child.stdout)  # from our own program
        except (EOFError, BrokenPipeError, pickle.UnpicklingError):
            raise FileError(f"{path}: {_how_it_died(child)}") from None
        except BaseException:  # half of an answer would be taken for the next one's
            child.kill()
            raise
    if good:
        return answer
    kind, text = answer
    raise {"output": OutputError, "memory": MemoryError}.get(kind, FileError)(text)


def _how_it_died(child: subprocess.Popen[bytes]) -> str:
    code = child.wait()
    name = f"code {code}"
    if code < 0:
        with contextlib.suppress(ValueError):
            name = signal.Signals(-code).name
    if code == -9:  # SIGKILL, which Windows has no name for
        return "the program that reads it was ended, perhaps for want of memory"
    return f"the library that reads it crashes at it ({name}): the file is damaged"
