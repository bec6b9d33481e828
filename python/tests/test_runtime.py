# SPDX-License-Identifier: MIT
"""OpenCL from PyPI: a runtime that pip installed is used where the system has none, and where there is none at all the
message names the command that brings one. The installed runtime is a stand-in: its library is the system's own."""

import importlib
import os
import subprocess
import sys
from pathlib import Path

import pytest

from smartvis import PluginError, _abi, _runtime

CLIP = """
import os, sys
from pathlib import Path
import numpy as np
import smartvis
from smartvis import _runtime
_runtime._VENDORS = Path(sys.argv[1])
volume = np.full((32, 32, 32), 200, np.uint8); volume[:20] = 10; volume[:6] = 100
try:
    print(smartvis.clip(volume, (1, 1, 1)).outcome.name, os.environ.get("OCL_ICD_VENDORS"))
except smartvis.SmartVisError as error:
    print(error)
"""


def run(vendors: Path, **environment: str) -> str:
    clean = {k: v for k, v in os.environ.items() if not k.startswith("OCL_ICD")} | environment
    command = [sys.executable, "-P", "-c", CLIP, str(vendors)]
    return subprocess.run(command, check=True, capture_output=True, text=True, env=clean).stdout.strip()


@pytest.fixture
def installed(tmp_path: Path) -> tuple[Path, str]:
    """A folder of packages with one that is called as PoCL's is, and its library: that of the system's PoCL."""
    names = [icd.read_text().strip() for icd in Path("/etc/OpenCL/vendors").glob("pocl*.icd")]
    if not names:
        pytest.skip("the system has no PoCL that could stand in")
    facts = tmp_path / "packages" / "pocl_binary_distribution-3.0.dist-info"
    facts.mkdir(parents=True)
    library = next(p for p in Path("/usr/lib").glob(f"**/{Path(names[0]).name}") if p.exists())
    (facts / "METADATA").write_text("Metadata-Version: 2.1\nName: pocl-binary-distribution\nVersion: 3.0\n")
    (facts / "RECORD").write_text(f"pocl.icd,,\n{os.path.relpath(library, facts.parent)},,\n")
    return facts.parent, str(library)


def test_a_runtime_of_pip_is_used_where_the_system_has_none(installed: tuple[Path, str], tmp_path: Path) -> None:
    folder, library = installed
    packages = os.pathsep.join([str(folder), os.environ.get("PYTHONPATH", "")])
    assert run(tmp_path / "none", PYTHONPATH=packages) == f"OK {library}"
    assert run(Path("/etc/OpenCL/vendors"), PYTHONPATH=packages) == "OK None"  # the system's own goes first
    chosen = run(tmp_path / "none", PYTHONPATH=packages, OCL_ICD_VENDORS="/nowhere")
    assert f"export OCL_ICD_VENDORS={library}" in chosen and "no OpenCL platform" in chosen


def test_pocl_is_left_alone_where_there_is_no_linker(installed: tuple[Path, str], tmp_path: Path, monkeypatch) -> None:
    """It calls one for every kernel, and ends the process if there is none."""
    packages = os.pathsep.join([str(installed[0]), os.environ.get("PYTHONPATH", "")])
    said = run(tmp_path / "none", PYTHONPATH=packages, OCL_ICD_VENDORS="/nowhere", PATH="/nowhere")
    assert "(PoCL needs a linker, which is missing: pip install intel-opencl-rt intel-cmplr-lib-rt)" in said
    monkeypatch.syspath_prepend(str(installed[0]))
    monkeypatch.setattr(_runtime, "_VENDORS", tmp_path / "none")
    monkeypatch.setattr(os, "environ", {k: v for k, v in os.environ.items() if not k.startswith("OCL_ICD")})
    for path, used in (("/nowhere", None), (os.environ["PATH"], installed[1])):
        os.environ["PATH"] = path
        _runtime.use_one()
        assert os.environ.get("OCL_ICD_VENDORS") == used


def test_a_processor_that_pocl_does_not_know_has_another_command() -> None:
    said = str(PluginError("activate", _abi.SV_ERR_BUILD, "the kernels do not build: unknown target CPU 'generic'"))
    assert "pip install intel-opencl-rt intel-cmplr-lib-rt" in said
    assert "pip" not in str(PluginError("activate", _abi.SV_ERR_BUILD, "the kernels do not build: out of memory"))


def test_intels_goes_first_where_both_are_there(installed: tuple[Path, str], monkeypatch) -> None:
    packages, library = installed
    monkeypatch.syspath_prepend(str(packages))
    assert _runtime.find() == library
    facts = packages / "intel_opencl_rt-2026.2.dist-info"
    facts.mkdir()
    (facts / "METADATA").write_text("Metadata-Version: 2.1\nName: intel-opencl-rt\nVersion: 2026.2\n")
    (facts / "RECORD").write_text("../libintelocl.so-gdb.py,,\n../libintelocl.so.2026.22,,\n")
    # From Python 3.12 on, files that are missing do not count.
    for name in ("libintelocl.so-gdb.py", "libintelocl.so.2026.22"):
        (packages.parent / name).touch()
    importlib.invalidate_caches()  # the folder may have changed within one tick of its file system's clock
    assert str(_runtime.find()).endswith("libintelocl.so.2026.22")
