# SPDX-License-Identifier: MIT
"""A process of its own for what foreign libraries read and write: a file at which one dies ends nothing else, and a
locale with a comma, which its own C library knows nothing of, changes no number.

It is a Python that runs nothing of the working folder, and is bound to this process, whichever thread asks it. A
question has a limit of time, `limit`, after which the process is ended; the next question starts another."""

from __future__ import annotations

import contextlib
import os
import pickle
import re
import signal
import subprocess
import sys
import threading
from typing import Any

from . import _runtime
from ._errors import DeviceError, FileError, HostError, OutputError

limit = 600.0  #: seconds for a question
_START = (
    "import sys; sys.path[:] = {path!r}; from smartvis._reading import serve; serve({version!r}, {answers!r}, {life!r})"
)
_ENDING = 10.0  # seconds that a process which has closed its answers has to end

_lock = threading.Lock()  # one question at a time
_child: _Child | None = None
_of_others: list[_Child] = []  # by whom this process was forked


def ask(what: str, path: object, *arguments: Any) -> Any:
    """What the reader's function `what` returns for a file; FileError with its reason, or that it died or took too
    long; HostError: the reader cannot be started, and why."""
    global _child
    with _lock:
        if _child is None or not _child.serves():
            if _child is not None:
                _child.end()
            _child = None
            _child = _Child()
        good, answer = _child.ask(what, path, *arguments)
    if good:
        return answer
    kind, text = answer
    raise {"output": OutputError, "memory": MemoryError, "device": DeviceError}.get(kind, FileError)(text)


def _forget() -> None:
    """In a process that was forked: the reader is that of the other one, which may be asking it just now."""
    global _lock, _child
    _lock = threading.Lock()
    if _child is not None:
        _child.leave_to_others()
        _of_others.append(_child)
    _child = None


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget)


def _led() -> dict[str, str]:
    """What leads the reader's host and plugin."""
    ours = ("SMARTVIS_", "OCL_", "POCL_", "PATH")
    return {name: value for name, value in os.environ.items() if name.startswith(ours)}


class _Child:
    """The reader's process: questions go to its standard input, answers come on a descriptor of their own."""

    def __init__(self) -> None:
        self._led = _led()
        self._late = False
        program = python()
        _runtime.open_standard()
        answers, theirs = os.pipe()
        ends, life = os.pipe()  # nobody writes there: it closes when this process ends
        self._answers, self._life = os.fdopen(answers, "rb"), os.fdopen(life, "wb", 0)
        try:
            numbers, how = _handed_over(theirs, ends)
            home = "PYTHONHOME" in os.environ  # without it this Python may not find itself
            code = _START.format(path=_path(), version=sys.version_info[:2], answers=numbers[0], life=numbers[1])
            kept = ["-B"] * sys.dont_write_bytecode
            kept += ["-X", f"pycache_prefix={sys.pycache_prefix}"] if sys.pycache_prefix else []
            self._process = subprocess.Popen(
                [program, *(["-P", "-s"] if home else ["-I"]), *kept, "-c", code],
                stdin=subprocess.PIPE,
                stdout=2,  # what is printed is no answer
                env=_environment(),
                **how,
            )
        except OSError as error:
            self._answers.close()
            self._life.close()
            raise HostError(f"{program}, which would read files, cannot be started: {error.strerror}") from None
        finally:
            os.close(theirs)
            os.close(ends)
        self._greet(program)

    def _greet(self, program: str) -> None:
        """HostError: it is no Python that knows this package."""
        try:
            with self._limited():
                good, answer = pickle.load(self._answers)
        except (EOFError, OSError, pickle.UnpicklingError):
            good, answer = False, f"it took longer than {limit:g} s" if self._late else ""
        except BaseException:
            self.end()
            raise
        if not good:
            self.end()
            more = answer or f"it ended with code {self._process.returncode}"
            raise HostError(
                f"{program}, which would read files, does not start as a Python with this package: {more}; "
                "SMARTVIS_PYTHON names another"
            )

    def serves(self) -> bool:
        """It runs, as what leads it says now."""
        return self._process.poll() is None and self._led == _led()

    def ask(self, what: str, path: object, *arguments: Any) -> tuple[bool, Any]:
        """Its answer; FileError: it died, or had no time left."""
        assert self._process.stdin is not None
        try:
            with self._limited():
                pickle.dump((what, path, *arguments), self._process.stdin)
                self._process.stdin.flush()
                answer: tuple[bool, Any] = pickle.load(self._answers)  # from our own program
                return answer
        except (EOFError, OSError, pickle.UnpicklingError):
            raise FileError(f"{path}: {self._how_it_died()}") from None
        except BaseException:  # half of an answer would be taken for the next one's
            self.end()
            raise

    @contextlib.contextmanager
    def _limited(self) -> Any:
        """Ends the process if what is done within takes too long."""

        def end() -> None:
            self._late = True
            self._process.kill()

        timer = threading.Timer(limit, end)
        timer.daemon = True
        timer.start()
        try:
            yield
        finally:
            timer.cancel()

    def _how_it_died(self) -> str:
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(_ENDING)
        self.end()
        code = self._process.returncode
        if self._late:
            return f"it was not read or written within {limit:g} s"
        name = f"code {code}"
        if code < 0:
            with contextlib.suppress(ValueError):
                name = signal.Signals(-code).name
        if code == -9:  # SIGKILL, which Windows has no name for
            return "the program that reads it was ended, perhaps for want of memory"
        return f"the library that reads it crashes at it ({name}): the file is damaged"

    def end(self) -> None:
        """Ends the process, whatever it is at."""
        assert self._process.stdin is not None
        self._process.kill()
        self._process.wait()
        self._life.close()
        self._answers.close()
        with contextlib.suppress(OSError):  # of a question that nobody took
            self._process.stdin.close()

    def leave_to_others(self) -> None:
        """So that this process holds none of its ends. A thread that is gone may have locked the files."""
        assert self._process.stdin is not None
        nothing = os.open(os.devnull, os.O_RDWR)
        for file in (self._life, self._answers, self._process.stdin):
            if not file.closed:
                os.dup2(nothing, file.fileno(), inheritable=False)
        os.close(nothing)


def python() -> str:
    """A Python for the reader; HostError: this process is none, and names none. A program that has Python inside is
    never started: it would be a copy of itself."""
    told = os.environ.get("SMARTVIS_PYTHON")
    own = "" if getattr(sys, "frozen", False) else sys.executable or ""
    near = "python.exe" if _runtime.WINDOWS else f"bin/python{sys.version_info[0]}.{sys.version_info[1]}"
    if told or re.search(r"python|pypy", os.path.basename(own), re.IGNORECASE):
        return told or own
    for folder in (sys.prefix, sys.exec_prefix, sys.base_exec_prefix):
        if os.access(path := os.path.join(folder, near), os.X_OK):
            return path
    raise HostError(
        f"files are read by a Python of their own, and there is none: this program is '{sys.executable or ''}'; "
        "SMARTVIS_PYTHON names one, or hand volumes over as arrays"
    )


def _path() -> list[str]:
    """Where the reader finds modules: as this process, but not in the folder where the user stands."""
    own = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    try:
        here = os.path.realpath(os.getcwd())
    except OSError:  # it was deleted
        here = ""
    folders = [folder for folder in sys.path if os.path.isabs(folder) and os.path.realpath(folder) != here]
    return folders if own in folders else [*folders, own]


def _environment() -> dict[str, str]:
    """This process', without what leads Python elsewhere, and with a point for a decimal mark."""
    python = [name for name in os.environ if name.startswith("PYTHON") and name != "PYTHONHOME"]
    environment = {k: v for k, v in os.environ.items() if not k.startswith("LC_") and k not in python}
    return environment | {"LC_ALL": "C.UTF-8"}


def _handed_over(*descriptors: int) -> tuple[list[int], dict[str, Any]]:
    """What the process finds them by, and how Popen is told of them."""
    if sys.platform == "win32":
        import msvcrt

        handles = [msvcrt.get_osfhandle(number) for number in descriptors]
        for handle in handles:
            os.set_handle_inheritable(handle, True)
        return handles, {"startupinfo": subprocess.STARTUPINFO(lpAttributeList={"handle_list": handles})}
    return list(descriptors), {"pass_fds": descriptors}
