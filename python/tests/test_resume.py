# SPDX-License-Identifier: MIT
"""A batch goes on with what is as it was, and does anew what is not; what is a study, and what is not."""

import csv
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import SimpleITK as sitk
from conftest import BUILD, LONG, layers, write_dicom

from smartvis import _study
from smartvis._found import find_files, state_of
from smartvis._page import write_page
from smartvis._rows import folder_of, locked, row_path
from smartvis._work import Row, Settings
from smartvis.cli import main

SHAPE = (40, 36, 36)
SETTINGS = Settings(parameters={"method": "wall"}, products=("clipped",), scanned="all")


@pytest.fixture(scope="module")
def client():
    with _study.cluster(None, 1, lambda link: None) as made:
        yield made


def written(path: Path, shift: int = 0, spacing: float = 1.0) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    image = sitk.GetImageFromArray(np.roll(layers(SHAPE), shift, axis=2))
    image.SetSpacing([spacing] * 3)
    sitk.WriteImage(image, str(path))
    return path


def study(folder: Path) -> list[Path]:
    """One file of bytes as they are, a header with its data beside it, and one more."""
    return [written(folder / name) for name in ("a/scan.nrrd", "b/scan.mhd", "c/my scan.nii.gz")]


def replaced(path: Path) -> None:
    """Another scan of as many bytes, and as old."""
    before = path.stat()
    data = bytearray(path.read_bytes())
    data[-1000:] = bytes(1000)
    path.unlink()
    path.write_bytes(data)
    os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))


CHANGES: dict[str, tuple[Callable[[Path, Path], object], str, int]] = {
    "nothing": (lambda study, out: None, "", 0),
    "a file": (lambda study, out: replaced(study / "a" / "scan.nrrd"), "file", 1),
    "a header's data": (lambda study, out: replaced(study / "b" / "scan.raw"), "file", 1),
    "a result is gone": (lambda study, out: next(out.rglob("my scan_clipped.nrrd")).unlink(), "results", 1),
    "a picture is gone": (lambda study, out: next(out.glob("b-*/scan_small.png")).unlink(), "results", 1),
    "a result is another": (lambda study, out: next(out.glob("a-*/scan_clipped.nrrd")).write_bytes(b"x"), "results", 1),
}


@pytest.mark.parametrize("change", CHANGES)
def test_what_has_changed_is_done_anew(tmp_path: Path, client, change: str) -> None:
    files, out = study(tmp_path / "study"), tmp_path / "out"
    rows = _study.batch(files, SETTINGS, out, client, lambda: None)
    assert [row["state"] for row in rows] == ["ok"] * 3
    results = {path: path.read_bytes() for path in out.rglob("*_clipped.nrrd")}
    before = {file: row_path(out, file, 0).stat().st_mtime_ns for file in files}
    make, what, count = CHANGES[change]
    make(tmp_path / "study", out)
    told: list[str] = []
    again = _study.batch(files, SETTINGS, out, client, lambda: None, tell=told.append)
    anew = [file for file in files if row_path(out, file, 0).stat().st_mtime_ns != before[file]]
    assert len(anew) == count and [row["state"] for row in again] == ["ok"] * 3
    assert told == ([f"1 of the volumes that were done are done anew; changed: {what}"] if count else [])
    differ = [path for path, data in results.items() if path.read_bytes() != data]
    assert len(differ) == (what == "file")


def test_another_plugin_or_setting_does_all_anew(tmp_path: Path) -> None:
    """The plugin's file has the name of the one before; the workers are others."""
    files, out, plugin = study(tmp_path / "study"), tmp_path / "out", tmp_path / "plugin.so"
    depths: list[list[str]] = []
    for library, write, anew in (
        ("examples/first_edge.so", "clipped,depth", ""),
        ("smartvis.so", "clipped,depth", "plugin"),
        ("smartvis.so", "clipped", "settings"),
    ):
        shutil.copy(BUILD / library, tmp_path / "new.so")
        os.replace(tmp_path / "new.so", plugin)
        command = [sys.executable, "-P", "-m", "smartvis", "batch", *map(str, files), "--out", str(out)]
        command += ["--plugin", str(plugin), "--workers", "1", "--write", write]
        ended = subprocess.run(command, capture_output=True, text=True, timeout=LONG, check=False)
        assert ended.returncode == 0 and "3 volumes clipped" in ended.stdout, ended.stderr
        assert (f"3 of the volumes that were done are done anew; changed: {anew}" in ended.stderr) == bool(anew)
        with open(out / "table.csv", newline="") as file:
            depths.append([row["depth_mm"] for row in csv.DictReader(file)])
    assert depths[0] != depths[1] == depths[2]
    assert not list(out.rglob("*_depth.nrrd")) and len(list(out.rglob("*_clipped.nrrd"))) == 3


def test_workers_that_have_another_plugin_say_so(tmp_path: Path, client) -> None:
    files, plugin = study(tmp_path / "study")[:1], tmp_path / "plugin.so"
    for library, state in (("smartvis.so", "ok"), ("examples/first_edge.so", "plugin")):
        shutil.copy(BUILD / library, tmp_path / "new.so")
        os.replace(tmp_path / "new.so", plugin)
        settings = Settings(plugin=str(plugin), products=("clipped",))
        (row,) = _study.batch(files, settings, tmp_path / "out", client, lambda: None)
        assert row["state"] == state
    assert "plugin.so: it has changed since this worker loaded it" in row["reason"]


def test_links_and_names_of_dicom_are_a_study(tmp_path: Path) -> None:
    folder, real = tmp_path / "study", tmp_path / "real"
    written(folder / "sub-02" / "scan.nrrd")
    written(real / "scan.nrrd")
    (folder / "sub-01").symlink_to(real)
    (folder / "sub-03").mkdir()
    (folder / "sub-03" / "scan.nrrd").symlink_to(real / "scan.nrrd")
    (real / "back").symlink_to(folder)
    (folder / "notes").write_text("no volume" * 40)
    os.mkfifo(folder / "pipe")
    (folder / "DICOMDIR").write_bytes(bytes(128) + b"DICM")
    image = sitk.GetImageFromArray(layers(SHAPE))
    for number, file in enumerate(write_dicom(folder / "sub-04", image)):
        file.rename(file.with_name(f"IM_{number:04d}" if number else "1.2.840.7"))
    found = find_files([str(folder)])
    assert [path.relative_to(folder) for path in found] == [
        Path("sub-01/scan.nrrd"), Path("sub-02/scan.nrrd"), Path("sub-03/scan.nrrd"), Path("sub-04")]  # fmt: skip
    out = tmp_path / "out"
    assert len({folder_of(out, path) for path in found}) == len({row_path(out, path, 0) for path in found}) == 4
    assert folder_of(out, found[2]).name.startswith("sub-03-scan-")
    state = state_of(found[3])
    (folder / "sub-04" / "IM_0007").write_bytes(b"another slice")
    assert state and state_of(found[3]) != state


def test_results_within_the_study_are_no_study(tmp_path: Path, client) -> None:
    files = study(tmp_path / "study")
    for out in ("out", "second"):
        told: list[str] = []
        found = find_files([str(tmp_path / "study")], tmp_path / "study" / out, told.append)
        assert found == files
        assert told == ([f"{tmp_path}/study/out: holds results of a batch, which are left out"] if out != "out" else [])
        _study.batch(found, SETTINGS, tmp_path / "study" / out, client, lambda: None)
    assert find_files([str(tmp_path / "study")], tmp_path / "study" / "out", told.append) == files


def test_one_batch_at_a_time_writes_to_a_folder(tmp_path: Path, capsys) -> None:
    written(tmp_path / "study" / "scan.nrrd")
    command = ["batch", str(tmp_path / "study"), "--out", str(tmp_path / "out"), "--workers", "1"]
    with locked(tmp_path / "out", SETTINGS):
        assert main(command) == 6
        assert "out: another batch writes there; wait for it, or choose another --out" in capsys.readouterr().err
    assert main(command) == 0


def test_only_its_own_leftovers_are_removed(tmp_path: Path, client) -> None:
    files, out = study(tmp_path / "study")[:1], tmp_path / "out"
    own = folder_of(out, files[0]) / ".part-77-scan_clipped.nrrd"
    others = [
        out / ".part-notes",
        out / "kept" / ".part-77-thing",
        own.parent / "x.part-77-y",
        out / "kept" / "a.began",
    ]
    for path in (own, *others):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("")
    _study.batch(files, SETTINGS, out, client, lambda: None)
    assert not own.exists() and all(path.exists() for path in others)


@pytest.mark.parametrize("name", ["胎" * 60, "胎" * 80, "a" * 250, "é" * 122])
def test_long_names_have_results(tmp_path: Path, client, name: str) -> None:
    """File systems take 255 bytes."""
    image = written(tmp_path / "scan.nrrd")
    folder = tmp_path / "study" / ("a" * 255)
    folder.mkdir(parents=True)
    path = folder / f"{name}.nrrd"
    os.replace(image, path)
    (row,) = _study.batch([path], SETTINGS, tmp_path / "out", client, lambda: None)
    assert row["state"] == "ok", row["reason"]
    assert main(["clip", str(path), "--out", str(tmp_path / "one"), "--write", "depth"]) == 0
    assert len(list((tmp_path / "one").iterdir())) == 1


def test_the_page_says_all_that_clip_says(tmp_path: Path) -> None:
    row = Row(str(tmp_path / "scan.nrrd"), 0, outcome="OK", why="Too little.", try_this="--set unsure=clip",
              doubt="Odd size.", clipped_share=0.5, depth_mm=7, unit="voxels", picture="p.png")  # fmt: skip
    page = write_page(tmp_path / "index.html", [(row, tmp_path / "scan")]).read_text()
    assert "50 % of the rays, 7.0 voxels on average" in page and " mm" not in page
    assert all(f"<span>{told}</span>" in page for told in ("Too little.", "Try: --set unsure=clip", "Odd size."))


@pytest.mark.night
@pytest.mark.parametrize(("kib", "rows"), [(680_000, "ok"), (500_000, "memory")])
def test_little_memory_is_enough_or_told(tmp_path: Path, kib: int, rows: str) -> None:
    """Dask takes this limit for the machine's memory. Two workers need some 290 MB each: of the first they take more
    than 80 %, where Dask would have them wait for others, of the second they have too little."""
    for number in range(3):
        written(tmp_path / "study" / f"{number}.nrrd")
    command = f'ulimit -m {kib}; exec "$0" "$@"'
    words = [sys.executable, "-P", "-m", "smartvis", "batch", str(tmp_path / "study"), "--out", str(tmp_path / "out")]
    began = time.monotonic()
    ended = subprocess.run(
        ["bash", "-c", command, *words, "--workers", "2"], capture_output=True, text=True, timeout=LONG, check=False
    )
    assert time.monotonic() - began < LONG
    told = ended.stdout + ended.stderr
    assert "3 volumes clipped" in told if rows == "ok" else "perhaps for want of memory: each has 2" in told, told
