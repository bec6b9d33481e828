# SPDX-License-Identifier: MIT
"""examples/python/: at most 30 lines each, and they do what they say. The notebook runs,
and what it stores is what comes out."""

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import LONG, SOURCE, host_sim

EXAMPLES = SOURCE / "examples" / "python"
REAL = SOURCE.parent / "shared" / "data" / "fetal_head_21w.mha"  # where `make demo` looks for scans, too


def run(name: str, *arguments: object) -> str:
    command = [sys.executable, "-P", str(EXAMPLES / name), *map(str, arguments)]
    return subprocess.run(command, check=True, capture_output=True, text=True, timeout=LONG).stdout


def test_there_are_three_and_they_are_short() -> None:
    assert [len(path.read_text().splitlines()) <= 30 for path in EXAMPLES.glob("*.py")] == [True] * 3


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


def told(cell: dict[str, Any]) -> tuple[int, str]:
    """How many pictures a cell has, and its text without its numbers: these change with every method."""
    outputs = cell.get("outputs", [])
    text = "".join(o["text"] for o in outputs if o["output_type"] == "stream" and o["name"] == "stdout")
    return sum("image/png" in o.get("data", {}) for o in outputs), re.sub(r"\d+(\.\d+)?", "#", text)


def run_notebook() -> tuple[Any, Any]:
    """The notebook as it is stored, and as it runs."""
    import nbformat
    from nbclient import NotebookClient

    stored = nbformat.read(EXAMPLES / "smartvis.ipynb", as_version=4)
    fresh = nbformat.read(EXAMPLES / "smartvis.ipynb", as_version=4)
    for cell in fresh.cells:
        cell.pop("outputs", None)
    NotebookClient(fresh, timeout=LONG, startup_timeout=LONG, kernel_name="python3").execute()  # a failure is raised
    return stored, fresh


def test_the_notebook_stores_what_comes_out(monkeypatch) -> None:
    monkeypatch.delenv("SMARTVIS_VOLUME", raising=False)
    stored, fresh = run_notebook()
    for number, (ours, theirs) in enumerate(zip(stored.cells, fresh.cells, strict=True)):
        assert told(ours) == told(theirs), f"cell {number}: jupyter execute --inplace examples/python/smartvis.ipynb"
    assert sum(told(cell)[0] for cell in stored.cells) == 5
    assert (EXAMPLES / "smartvis.ipynb").stat().st_size < 600_000


@pytest.mark.skipif(not REAL.exists(), reason="the scan is not part of the repository")
def test_the_notebook_takes_a_real_scan(monkeypatch) -> None:
    monkeypatch.setenv("SMARTVIS_VOLUME", str(REAL))
    _, fresh = run_notebook()
    assert any(REAL.name in told_.get("text", "") for cell in fresh.cells for told_ in cell.get("outputs", []))


def test_a_method_in_numpy_is_ranked() -> None:
    lines = run("own_method.py", 64, "D01", "E01").splitlines()
    errors = {line.split()[0]: float(line.split()[1]) for line in lines}
    assert list(errors) == sorted(errors, key=lambda name: errors[name]) and len(errors) == 4
    assert errors["wall"] < errors["longest_gap"] < errors["unclipped"]
