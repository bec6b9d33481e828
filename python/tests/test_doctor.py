# SPDX-License-Identifier: MIT
"""smartvis doctor: Python's rows and host_sim's; a file of the package that was changed is told, and ends it with 1.
Requirement: R18."""

import base64
import hashlib
from importlib import metadata
from pathlib import Path

import pytest

from smartvis.cli import main

SUM = base64.urlsafe_b64encode(hashlib.sha256(b"as installed").digest()).decode().rstrip("=")


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """One file, of a package of one file with its sum."""
    info = tmp_path / "smartvis-1.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: smartvis\nVersion: 1\n")
    (info / "RECORD").write_text(f"one.py,sha256={SUM},12\nsmartvis-1.dist-info/RECORD,,\n")
    one = tmp_path / "one.py"
    one.write_bytes(b"as installed")
    found = metadata.PathDistribution(info)
    monkeypatch.setattr(metadata, "distribution", lambda name: found)
    return one


def test_what_is_right_holds_and_a_changed_file_does_not(installed: Path, tmp_path: Path, capfd) -> None:
    out = str(tmp_path / "out")
    assert main(["doctor", "--frames", "3", "--out", out, "--deadline", "100000"]) == 0
    said = capfd.readouterr().out
    assert "1 of 1 files are what was installed" in said
    assert "Accepted frame       holds" in said
    assert "Times of the plugin  holds" in said
    assert Path(out, "verify.html").exists()
    installed.write_bytes(b"as changed")
    assert main(["doctor", "--frames", "3", "--out", out]) == 1
    assert "1 of 1 files are not what was installed; one.py" in capfd.readouterr().out
    installed.unlink()
    assert main(["doctor", "--frames", "3", "--out", out, "--deadline", "0.001"]) == 1
    assert "the deadline is 0.001 ms" in capfd.readouterr().out
