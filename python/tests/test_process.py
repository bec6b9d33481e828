# SPDX-License-Identifier: MIT
"""The reader's process: what it must not run, what it outlives, what it is ended for, and where there is no Python."""

import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
import SimpleITK as sitk
from conftest import LONG, layers

from smartvis import _process
from smartvis._errors import FileError, HostError
from smartvis._files import Source

PROGRAM = str(Path(sys.executable).with_name("smartvis"))
SHAPE = (24, 20, 20)


@pytest.fixture
def scan(tmp_path: Path) -> str:
    path = tmp_path / "study" / "scan.nrrd"
    path.parent.mkdir()
    sitk.WriteImage(sitk.GetImageFromArray(layers(SHAPE)), str(path))
    return str(path)


@pytest.fixture
def anew(monkeypatch: pytest.MonkeyPatch):
    """The next question starts a process, and the one after this test as well."""
    monkeypatch.setenv("SMARTVIS_TEST", "another")
    return monkeypatch


def program(path: Path, text: str) -> str:
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)
    return str(path)


def pid() -> int:
    assert _process._child is not None
    return _process._child._process.pid


def is_gone(number: int) -> bool:
    end = time.monotonic() + LONG
    while time.monotonic() < end:
        try:
            os.kill(number, 0)
        except ProcessLookupError:
            return True
        time.sleep(0.01)
    return False


@pytest.mark.parametrize("command", [["clip", "scan.nrrd"], ["batch", ".", "--workers", "1"]])
def test_nothing_of_the_working_folder_is_run(scan: str, command: list[str]) -> None:
    """A file there for every module that Python and this package may ask for."""
    folder = Path(scan).parent
    names = {*sys.stdlib_module_names, "sitecustomize", "usercustomize", "smartvis", "numpy", "SimpleITK", "pydicom",
             "gdcm", "PIL", "tifffile", "imagecodecs", "zarr", "tqdm", "skimage", "dask", "distributed"}  # fmt: skip
    for name in names:
        (folder / f"{name}.py").write_text(f"open({str(folder / 'ran.txt')!r}, 'a').write('{name} ')\n")
    ended = subprocess.run(
        [PROGRAM, *command, "--out", "out", "--write", "depth"], cwd=folder, capture_output=True, text=True,
        timeout=LONG, check=False,
    )  # fmt: skip
    assert ended.returncode == 0, ended.stderr
    assert not (folder / "ran.txt").exists(), (folder / "ran.txt").read_text()
    assert list(folder.glob("out/**/scan_depth.nrrd"))


def test_what_is_printed_at_the_start_is_no_answer(tmp_path: Path, scan: str, anew) -> None:
    """As a cluster's sitecustomize does."""
    text = f'echo "module load: done"; exec {sys.executable} "$@"'
    anew.setenv("SMARTVIS_PYTHON", program(tmp_path / "python", text))
    assert Source(scan).read().GetSize() == SHAPE[::-1]


def test_a_question_has_a_limit_of_time(scan: str, anew) -> None:
    assert Source(scan).count == 1
    stopped = pid()
    os.kill(stopped, signal.SIGSTOP)
    anew.setattr(_process, "limit", 0.5)
    with pytest.raises(FileError, match=r"scan.nrrd: it was not read or written within 0.5 s"):
        Source(scan)
    assert is_gone(stopped)
    anew.setattr(_process, "limit", float(LONG))
    assert Source(scan).count == 1 and pid() != stopped


def test_a_file_that_is_never_read_holds_no_command_up(tmp_path: Path, scan: str) -> None:
    """Neither while a batch is planned nor later."""
    slow = {"SMARTVIS_PYTHON": program(tmp_path / "python", "exec sleep 999")}
    for command in (["clip", scan], ["batch", scan, "--workers", "1"]):
        ended = subprocess.run(
            [PROGRAM, *command, "--out", str(tmp_path / "out"), "--seconds", "1"], env=os.environ | slow,
            capture_output=True, text=True, timeout=LONG, check=False,
        )  # fmt: skip
        assert ended.returncode == 3 and "it took longer than 1 s" in ended.stderr, ended.stderr


def test_a_process_that_stops_is_no_hindrance_to_the_next(scan: str, anew) -> None:
    """It is ended, not waited for, when what leads it is another."""
    assert Source(scan).count == 1
    stopped = pid()
    os.kill(stopped, signal.SIGSTOP)
    anew.setenv("SMARTVIS_TEST", "one more")
    assert Source(scan).count == 1 and is_gone(stopped)


def test_the_thread_that_asked_first_may_end(scan: str, anew) -> None:
    counts: list[int] = []
    for _ in range(3):
        thread = threading.Thread(target=lambda: counts.append(Source(scan).count))
        thread.start()
        thread.join(LONG)
        first = pid()
        time.sleep(0.05)
        assert Source(scan).count == 1 and pid() == first
    assert counts == [1, 1, 1]


def test_it_ends_with_the_process_that_asks(tmp_path: Path, scan: str) -> None:
    """However that ends, and whatever it is at."""
    code = f"""
import os, signal
from smartvis import _process
from smartvis._files import Source
Source({scan!r})
number = _process._child._process.pid
os.kill(number, signal.SIGSTOP)
print(number, flush=True)
os.kill(os.getpid(), signal.SIGKILL)
"""
    ended = subprocess.run([sys.executable, "-P", "-c", code], capture_output=True, text=True, check=False)
    assert ended.returncode == -signal.SIGKILL and is_gone(int(ended.stdout)), ended.stderr


def in_a_fork(scan: str, answers) -> None:
    answers.put((Source(scan).count, pid()))


def test_a_forked_process_has_its_own(scan: str, anew) -> None:
    assert Source(scan).count == 1
    ways = multiprocessing.get_context("fork")
    answers = ways.Queue()
    with _process._lock:  # as if another thread were asking
        forked = ways.Process(target=in_a_fork, args=(scan, answers))
        forked.start()
        count, number = answers.get(timeout=LONG)
        forked.join(LONG)
    assert count == 1 and number != pid() and Source(scan).count == 1


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("exit 7", "it ended with code 7"),
        ("kill -9 $$", "it ended with code -9"),
        ("", "it is Python 2.7"),
    ],
)
def test_what_is_no_python_with_this_package_is_told(tmp_path: Path, scan: str, anew, text: str, why: str) -> None:
    other = "import sys; sys.version_info = (2, 7); exec(sys.argv[-1])"
    text = f"exec {sys.executable} -c '{other}' \"$@\"" if "2.7" in why else text
    anew.setenv("SMARTVIS_PYTHON", program(tmp_path / "other", text))
    with pytest.raises(HostError, match=f"other, which would read files, does not start as a Python.*: {why}"):
        Source(scan)
    anew.setenv("SMARTVIS_PYTHON", str(tmp_path / "none"))
    with pytest.raises(HostError, match=r"none, which would read files, cannot be started: No such file"):
        Source(scan)


@pytest.mark.parametrize("frozen", [False, True])
def test_a_program_that_has_python_inside_starts_no_copy_of_itself(
    tmp_path: Path, scan: str, anew, frozen: bool
) -> None:
    name = "python-app" if frozen else "viewer"
    anew.setattr(sys, "executable", program(tmp_path / name, f"touch {tmp_path}/started"))
    if frozen:
        anew.setattr(sys, "frozen", True, raising=False)
    assert Source(scan).count == 1  # by the Python of its installation
    for prefix in ("prefix", "exec_prefix", "base_exec_prefix"):
        anew.setattr(sys, prefix, str(tmp_path))
    anew.setenv("SMARTVIS_TEST", "one more")
    with pytest.raises(HostError, match=f"there is none: this program is '.*{name}'; SMARTVIS_PYTHON names one"):
        Source(scan)
    assert not (tmp_path / "started").exists()


def test_closed_descriptors_stay_out_of_it(scan: str, tmp_path: Path) -> None:
    """A daemon has none of 0 to 2."""
    for closed in ("0<&-", "1>&-", "2>&-", "0<&- 1>&- 2>&-"):
        out = tmp_path / closed.replace(" ", "")
        ended = subprocess.run(["sh", "-c", f'exec "$0" "$@" {closed}', PROGRAM, "clip", scan, "--out", str(out)],
                               capture_output=True, text=True, timeout=LONG, check=False)  # fmt: skip
        assert ended.returncode == 0 and "Traceback" not in ended.stderr, ended.stderr
        assert sitk.ReadImage(str(out / "scan_depth.nrrd")).GetSize()[2] == 1
