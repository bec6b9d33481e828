# SPDX-License-Identifier: MIT
"""examples/python/: at most 30 lines each, and they do what they say. The notebook runs without an error."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import LONG, SOURCE, host_sim

EXAMPLES = SOURCE / "examples" / "python"


def run(name: str, *arguments: object) -> str:
    command = [sys.executable, "-P", str(EXAMPLES / name), *map(str, arguments)]
    return subprocess.run(command, check=True, capture_output=True, text=True, timeout=LONG).stdout


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.py")), ids=lambda p: p.name)
def test_examples_are_short(path: Path) -> None:
    assert len(path.read_text().splitlines()) <= 30


def test_there_are_three() -> None:
    assert len(list(EXAMPLES.glob("*.py"))) == 3


def test_numpy_in_and_out() -> None:
    lines = run("numpy_in_and_out.py").splitlines()
    assert lines[0].startswith("outcome OK") and lines[1].endswith("voxels of skin before, 0 after")
    before, after = (int(w) for w in lines[2].split() if w.isdigit())
    assert before == after > 40000


def test_a_file_becomes_a_mesh(tmp_path: Path) -> None:
    host_sim("scenes", "D01", "--size", 64, "--export", "--out", tmp_path)
    assert "OK" in run("file_to_mesh.py", tmp_path / "D01_full.mha", tmp_path / "d01.stl")
    raw = (tmp_path / "d01.stl").read_bytes()
    count = int(np.frombuffer(raw[80:84], "<u4")[0])
    assert len(raw) == 84 + 50 * count and count > 1000


def test_the_notebook_runs_headless(monkeypatch) -> None:
    import nbformat
    from nbclient import NotebookClient

    real = SOURCE.parent / "shared" / "data" / "fetal_head_21w.mha"  # where `make demo` looks for scans, too
    if real.exists():
        monkeypatch.setenv("SMARTVIS_VOLUME", str(real))
    notebook = nbformat.read(EXAMPLES / "smartvis.ipynb", as_version=4)
    assert not any(cell.get("outputs") for cell in notebook.cells), "the notebook is kept without its outputs"
    client = NotebookClient(notebook, timeout=LONG, startup_timeout=LONG, kernel_name="python3")
    client.execute()  # a cell that fails is an exception
    pictures = [o for c in notebook.cells for o in c.get("outputs", []) if "image/png" in o.get("data", {})]
    assert len(pictures) >= 5


def test_a_method_in_numpy_is_ranked() -> None:
    lines = run("own_method.py", 64, "D01", "E01").splitlines()
    errors = {line.split()[0]: float(line.split()[1]) for line in lines}
    assert list(errors) == sorted(errors, key=lambda name: errors[name]) and len(errors) == 5
    assert errors["cost"] < errors["longest_gap"] < errors["unclipped"]
