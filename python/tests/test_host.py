# SPDX-License-Identifier: MIT
"""Which host_sim is taken, what it gets, and what its failures say. The programs are stand-ins; the one of the wheel is
tried by tests/python/wheel.sh and scripts/try_wheel.sh."""

import json
import sys
from pathlib import Path

import pytest

from smartvis import HostError, _host, _runtime


def program(path: Path, code: str = "") -> str:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!{sys.executable}\n{code}\n")
    path.chmod(0o755)
    return str(path)


@pytest.fixture(autouse=True)
def nowhere(tmp_path: Path, monkeypatch) -> Path:
    """A package without a host, on a machine that has none either, and no runtime of its own."""
    monkeypatch.delenv("SMARTVIS_HOST_SIM")
    for name in ("OCL_ICD_VENDORS", "OCL_ICD_FILENAMES", "FONTCONFIG_FILE", "FONTCONFIG_PATH"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("PATH", str(tmp_path / "path"))
    monkeypatch.setattr(_host, "_OWN", tmp_path / "plugin" / "host_sim")
    monkeypatch.setattr(_host, "_CLONE", tmp_path / "build" / "host_sim")
    monkeypatch.setattr(_runtime, "_VENDORS", tmp_path / "vendors")
    monkeypatch.setattr(_runtime, "find", lambda: None)
    return tmp_path


def test_the_nearest_is_taken(nowhere: Path, monkeypatch) -> None:
    with pytest.raises(HostError, match="host_sim is not there: install the wheel of 'make wheel'.*SMARTVIS_HOST_SIM"):
        _host.find()
    for place in ("build", "path", "plugin"):
        nearer = program(nowhere / place / "host_sim")
        assert _host.find() == nearer
    named = program(nowhere / "elsewhere" / "mine")
    monkeypatch.setenv("SMARTVIS_HOST_SIM", named)
    assert _host.find() == named


def test_what_is_no_program_is_passed_over(nowhere: Path) -> None:
    on_path = program(nowhere / "path" / "host_sim")
    Path(program(nowhere / "plugin" / "host_sim")).chmod(0o644)
    assert _host.find() == on_path


TELL = "import json, os; print(json.dumps(dict(os.environ)))"


def test_it_gets_the_runtime_of_the_plugin(nowhere: Path, monkeypatch) -> None:
    program(nowhere / "plugin" / "host_sim", TELL)
    assert "OCL_ICD_VENDORS" not in json.loads(_host.run([]))
    monkeypatch.setattr(_runtime, "find", lambda: "/packages/libintelocl.so")
    told = json.loads(_host.run([]))
    assert told["OCL_ICD_VENDORS"] == told["OCL_ICD_FILENAMES"] == "/packages/libintelocl.so"
    monkeypatch.setenv("OCL_ICD_VENDORS", "/mine")
    told = json.loads(_host.run([]))
    assert told["OCL_ICD_VENDORS"] == "/mine" and "OCL_ICD_FILENAMES" not in told


def test_only_the_one_of_the_wheel_gets_the_fonts_of_the_wheel(nowhere: Path, monkeypatch) -> None:
    on_path, own = program(nowhere / "path" / "host_sim", TELL), program(nowhere / "plugin" / "host_sim", TELL)
    assert "FONTCONFIG_FILE" not in json.loads(_host.run([]))  # a wheel without them
    fonts = nowhere / "plugin" / "share" / "fonts" / "fonts.conf"
    fonts.parent.mkdir(parents=True)
    fonts.touch()
    assert json.loads(_host.run([]))["FONTCONFIG_FILE"] == str(fonts)
    monkeypatch.setenv("FONTCONFIG_FILE", "/mine")
    assert json.loads(_host.run([]))["FONTCONFIG_FILE"] == "/mine"
    monkeypatch.delenv("FONTCONFIG_FILE")
    Path(own).unlink()
    assert _host.find() == on_path and "FONTCONFIG_FILE" not in json.loads(_host.run([]))


def failure(folder: Path, code: int, said: str) -> str:
    program(folder / "plugin" / "host_sim", f"import sys; print({said!r}, file=sys.stderr); sys.exit({code})")
    with pytest.raises(HostError) as told:
        _host.run([])
    assert told.value.code == code
    return str(told.value)


def test_the_first_line_is_its_own(nowhere: Path) -> None:
    assert failure(nowhere, 6, "Fontconfig error: No writable cache directories\nmine\nmore") == "mine"
    assert failure(nowhere, 7, "") == "ended with code 7 and said nothing"


def test_what_helps_is_told_where_there_is_no_opencl(nowhere: Path, monkeypatch) -> None:
    line = "host_sim run: no OpenCL platform (clGetPlatformIDs: -1001)"
    assert failure(nowhere, 5, f"{line}\nmore") == f"{line} (a runtime for the processor: {_runtime._INTEL})"
    program(nowhere / "path" / "ld")
    assert failure(nowhere, 5, line) == f"{line} (a runtime for the processor: {_runtime._POCL})"
    old = "host_sim run: OpenCL: the host's kernels do not build on a processor (-11):"
    said = failure(nowhere, 5, f"{old}\nerror: unknown target CPU 'generic'")
    assert said == f"{old} (this PoCL is older than the processor: {_runtime._INTEL})"
    assert failure(nowhere, 5, old) == old
    assert failure(nowhere, 3, "host_sim info: no OpenCL here") == "host_sim info: no OpenCL here"
    monkeypatch.setattr(_runtime, "find", lambda: "/packages/libintelocl.so")
    assert failure(nowhere, 5, line) == line  # it was told of that one
    monkeypatch.setenv("OCL_ICD_VENDORS", "/mine")
    assert failure(nowhere, 5, line) == f"{line} (the one from PyPI: export OCL_ICD_VENDORS=/packages/libintelocl.so)"
