# SPDX-License-Identifier: MIT
"""smartvis batch: every volume of a study, also if one is broken, one kills its worker, or a worker or
the whole batch is killed in the middle."""

import csv
import fcntl
import json
import os
import pty
import re
import signal
import struct
import subprocess
import sys
import termios
import threading
import time
from html import unescape
from pathlib import Path
from urllib.parse import unquote

import numpy as np
import pytest
import SimpleITK as sitk
from conftest import LONG, SOURCE, layers

import smartvis
from smartvis import _study
from smartvis._files import PARTS
from smartvis._found import find_files
from smartvis._products import quick_look, small_look
from smartvis._rows import BEGAN, folder_of, row_path
from smartvis._work import Settings
from smartvis.cli import main

SETTINGS = Settings(parameters={"method": "wall"}, products=("clipped",), scanned="all")
SHAPE = (40, 36, 36)


def shifted(number: int) -> np.ndarray:
    return np.roll(layers(SHAPE), number, axis=2)


@pytest.fixture(scope="module")
def client():
    links: list[str] = []
    with _study.cluster(None, 2, links.append) as made:
        assert links[0].startswith("http://127.0.0.1:") and links[0].endswith("/status")
        yield made


@pytest.fixture
def doomed():
    """Workers of one test that kills them: Dask's nannies may give up on a busy machine, and others need theirs."""
    with _study.cluster(None, 2, lambda link: None) as made:
        yield made


def write_study(folder: Path, count: int) -> list[Path]:
    files = []
    for number in range(count):
        path = folder / f"patient{number % 3}" / f"scan{number // 3}.nrrd"
        path.parent.mkdir(parents=True, exist_ok=True)
        sitk.WriteImage(sitk.GetImageFromArray(shifted(number)), str(path))
        files.append(path)
    return files


def table(out: Path) -> list[dict[str, str]]:
    with open(out / "table.csv", newline="") as file:
        return list(csv.DictReader(file))


def rows_of(out: Path) -> dict[Path, int]:
    return {p: p.stat().st_mtime_ns for p in (out / "rows").glob("[0-9a-f]*_*.json")}


def nothing_is_half(out: Path) -> None:
    assert not list(out.rglob(PARTS))


def formats_kept() -> int:
    cache = _study._worker_cache
    return len(cache._instances) if cache else 0


def test_settings_are_swept(tmp_path: Path, capsys) -> None:
    """Each value is a batch of its own; one table and one page have all, one scan's results together."""
    files, out = write_study(tmp_path / "study", 2), tmp_path / "out"
    words = [
        "batch",
        str(tmp_path / "study"),
        "--out",
        str(out),
        "--workers",
        "1",
        "--scanned",
        "all",
        "--write",
        "depth",
    ]
    for wrong in ("q=0.2,2", "q=0.2,", "q=0.2,,0.5", "quality=1,2"):
        assert main([*words, "--set", wrong]) == 2 and not out.exists()
    assert "quality" in capsys.readouterr().err
    assert main([*words, "--set", "q=0.8,0.2", "--set", "unsure=clip"]) == 0
    assert "4 results of 2 volumes clipped, 0 not" in capsys.readouterr().out
    rows = table(out)
    swept = ["q=0.8 unsure=clip", "q=0.2 unsure=clip"]
    assert [row["settings"] for row in rows] == swept * 2 and {row["method"] for row in rows} == {"wall"}
    assert [Path(row["file"]) for row in rows] == [file for file in sorted(files) for _ in swept]
    for row, q in zip(rows, (0.8, 0.2) * 2, strict=True):
        volume = shifted(files.index(Path(row["file"])))
        result = smartvis.clip(volume, (1, 1, 1), scanned="all", method="wall", q=q, unsure="clip")
        written = folder_of(out / f"q={q:g}", Path(row["file"])) / row["files"]
        assert np.array_equal(sitk.GetArrayFromImage(sitk.ReadImage(str(written)))[0], result.depth_mm)
        assert result.confidence is not None
        assert float(row["confidence"]) == pytest.approx(result.confidence[result.depth > 0].mean(), abs=1e-4)
    page = (out / "index.html").read_text()
    links = [unquote(link) for link in re.findall(r'(?:src|href)="([^"]+)"', page)]
    assert "<h1>2 volumes, each with 2 settings</h1>" in page and page.count(f"Set: {swept[0]}<") == 2
    assert len(links) == 9 and all((out / link).exists() for link in links)
    before = rows_of(out / "q=0.2")
    assert main([*words, "--set", "q=0.2,0.5", "--set", "unsure=clip"]) == 0 and rows_of(out / "q=0.2") == before


def test_a_study_with_a_sequence_and_broken_files(tmp_path: Path, client) -> None:
    files = write_study(tmp_path / "study", 4)
    series = sitk.JoinSeries([sitk.GetImageFromArray(shifted(n)) for n in range(3)])
    sitk.WriteImage(series, str(tmp_path / "study" / "beat.nii.gz"))
    (tmp_path / "study" / "bad.nrrd").write_text("no volume")
    cut = tmp_path / "study" / "cut.mha"
    sitk.WriteImage(sitk.GetImageFromArray(shifted(0)), str(cut))
    cut.write_bytes(cut.read_bytes()[:9000])
    out = tmp_path / "out"
    found = find_files([str(tmp_path / "study")])
    assert len(found) == 7
    steps: list[int] = []
    rows = _study.batch(found, SETTINGS, out, client, lambda: steps.append(1))
    assert len(steps) == len(rows) == len(table(out)) == 9
    states = {(Path(r["file"]).name, r["frame"]): r["state"] for r in rows}
    assert states.pop(("bad.nrrd", 0)) == states.pop(("cut.mha", 0)) == "input" and set(states.values()) == {"ok"}
    for number, file in enumerate(files):
        clipped = folder_of(out, file) / f"scan{number // 3}_clipped.nrrd"
        expected = smartvis.clip(shifted(number), (1, 1, 1), method="wall").apply(shifted(number))
        assert np.array_equal(sitk.GetArrayFromImage(sitk.ReadImage(str(clipped))), expected)
    assert len(list(out.rglob("beat_f000?_clipped.nrrd"))) == 3
    nothing_is_half(out)
    assert all(n == 1 for n in client.run(formats_kept).values())

    before = rows_of(out)
    again = _study.batch(found, SETTINGS, out, client, lambda: None)
    changed = {p for p, t in rows_of(out).items() if before[p] != t}
    assert len(changed) == 2 and [r["state"] for r in again] == [r["state"] for r in rows]  # the broken are tried anew
    row = row_path(out, files[0], 0)  # a volume that failed though its file can be read
    row.write_text(json.dumps({**json.loads(row.read_text()), "state": "plugin"}))
    again = _study.batch(found, SETTINGS, out, client, lambda: None)
    assert json.loads(row.read_text())["state"] == "ok" and [r["state"] for r in again] == [r["state"] for r in rows]


def test_a_worker_that_is_killed_loses_nothing(tmp_path: Path, doomed) -> None:
    files = write_study(tmp_path / "study", 24)
    out = tmp_path / "out"
    victims = list(doomed.run(os.getpid).values())
    done: list[int] = []
    half = folder_of(out, files[0]) / f".part-{victims[0]}-scan0_clipped.nrrd"
    half.parent.mkdir(parents=True)
    half.write_text("what a worker leaves that is killed while it writes")

    def step() -> None:
        done.append(1)
        if len(done) == 4:
            os.kill(victims[0], signal.SIGKILL)

    rows = _study.batch(files, SETTINGS, out, doomed, step)
    assert [r["state"] for r in rows] == ["ok"] * 24 and len({r["file"] for r in rows}) == 24
    nothing_is_half(out)
    assert len(list(out.rglob("*_clipped.nrrd"))) == 24
    doomed.wait_for_workers(2, timeout=LONG)
    assert victims[0] not in doomed.run(os.getpid).values()
    for path in out.rglob("*_clipped.nrrd"):
        assert sitk.ReadImage(str(path)).GetSize() == SHAPE[::-1]


@pytest.mark.night
def test_workers_that_are_gone_for_good_are_replaced(tmp_path: Path, doomed) -> None:
    files = write_study(tmp_path / "study", 12)
    done: list[int] = []

    def step() -> None:
        done.append(1)
        if len(done) == 2:
            doomed.cluster.scale(0)

    rows = _study.batch(files, SETTINGS, tmp_path / "out", doomed, step)
    assert [r["state"] for r in rows] == ["ok"] * 12 and len(doomed.nthreads()) >= 1


CRASHES, HOLDS = 77, 88
TROUBLE = r"""
#include "smartvis/author.h"
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
/* Ends the Python that it was called from, which the guard stands before. */
static void end_host(void) {
    char path[64], text[4096];
    for (int pid = getppid(), end; pid > 1; pid = end) {
        snprintf(path, sizeof path, "/proc/%d/exe", pid);
        const ssize_t length = readlink(path, text, sizeof text - 1);
        text[length > 0 ? length : 0] = '\0';
        if (strstr(text, "python")) {
            kill(pid, SIGKILL);
            return;
        }
        snprintf(path, sizeof path, "/proc/%d/stat", pid);
        FILE *file = fopen(path, "r");
        if (!file || fscanf(file, "%*d (%*[^)]) %*c %d", &end) != 1) return;
        fclose(file);
    }
}
static sv_status finish(sva *a, float *depth) {
    if (sva_voxel(a, 0, 0, 0) == 77) end_host();
    if (sva_voxel(a, 0, 0, 0) == 88)
        while (access(getenv("SV_HOLD"), F_OK) == 0) usleep(1000);
    for (uint32_t i = 0; i < sva_rays(a); i++) depth[i] = 5.0f;
    return SV_OK;
}
static const sv_descriptor descriptor =
    SVA_DESCRIPTOR("org.smartvis.test.trouble", "Trouble", "tests", "1", "Crashes on one volume, stops on one.", 0);
static const sva_method method = {.descriptor = &descriptor, .finish = finish};
SVA_ENTRY(method);
"""


@pytest.fixture(scope="module")
def trouble(tmp_path_factory) -> str:
    folder = tmp_path_factory.mktemp("plugin")
    (folder / "trouble.c").write_text(TROUBLE)
    command = ["cc", "-std=gnu11", "-shared", "-fPIC", "-I", str(SOURCE / "include"), "trouble.c", "-o", "trouble.so"]
    subprocess.run(command, cwd=folder, check=True)
    return str(folder / "trouble.so")


def test_a_volume_that_kills_its_workers_is_a_row(tmp_path: Path, doomed, trouble: str) -> None:
    files = write_study(tmp_path / "study", 3)
    killer = tmp_path / "study" / "killer.nrrd"
    sitk.WriteImage(sitk.GetImageFromArray(np.full(SHAPE, CRASHES, np.uint8)), str(killer))
    settings = Settings(plugin=trouble, products=("clipped",), scanned="all")
    rows = _study.batch([killer, *files], settings, tmp_path / "out", doomed, lambda: None)
    killed = [r for r in rows if r["state"] != "ok"]
    assert len(rows) == 4 and [Path(r["file"]).name for r in killed] == ["killer.nrrd"]
    assert killed[0]["state"] == "plugin" and "worker died" in killed[0]["reason"]


@pytest.mark.night
def test_a_file_that_takes_too_long_is_a_row(tmp_path: Path, trouble: str, monkeypatch) -> None:
    files = write_study(tmp_path / "study", 3)
    stops = tmp_path / "study" / "stops.nrrd"
    sitk.WriteImage(sitk.GetImageFromArray(np.full(SHAPE, HOLDS, np.uint8)), str(stops))
    monkeypatch.setenv("SV_HOLD", str(stops))
    settings = Settings(plugin=trouble, products=("clipped",), scanned="all")
    with _study.cluster(None, 2, lambda link: None) as client:
        rows = _study.batch([stops, *files], settings, tmp_path / "out", client, lambda: None, seconds=20)
    states = {Path(r["file"]).name: r["state"] for r in rows if r["file"] != str(files[0])}
    assert len(rows) == 4 and states.pop("stops.nrrd") == "input" and set(states.values()) == {"ok"}
    assert "longer than 20 s" in next(r["reason"] for r in rows if r["file"] == str(stops))
    assert not list((tmp_path / "out").rglob(f"*{BEGAN}"))


def test_one_line_a_file_and_nothing_is_overwritten(tmp_path: Path, capsys) -> None:
    """Files of one name in one folder; a pipe; a sequence of which no volume can be clipped."""
    folder = tmp_path / "study" / "anna"
    folder.mkdir(parents=True)
    for number, name in enumerate(("scan.nrrd", "scan.nii.gz")):
        sitk.WriteImage(sitk.GetImageFromArray(shifted(number)), str(folder / name))
    empty = sitk.JoinSeries([sitk.GetImageFromArray(np.zeros(SHAPE, np.float32)) for _ in range(5)])
    sitk.WriteImage(empty, str(folder / "empty.nrrd"))
    os.mkfifo(folder / "pipe.nrrd")
    out = tmp_path / "out"
    assert main(["batch", str(tmp_path / "study"), "--out", str(out), "--workers", "1", "--write", "clipped"]) == 1
    said = capsys.readouterr()
    assert "2 volumes clipped, 6 not" in said.out and len(table(out)) == 8
    assert said.err.count("empty.nrrd") == 1 and "5 of its volumes failed" in said.err
    assert said.err.count("pipe.nrrd: not a regular file") == 1
    written = sorted(p.parent.name for p in out.rglob("scan_clipped.nrrd"))
    assert len(written) == 2 and all(name.startswith("anna-scan-") for name in written)
    assert main(["clip", str(folder / "empty.nrrd"), "--out", str(tmp_path / "one")]) == 3
    assert capsys.readouterr().out.count("empty.nrrd") == 1


def test_the_page_has_a_picture_of_every_volume(tmp_path: Path, client) -> None:
    folder = tmp_path / "study" / "<b>anna #1?"
    folder.mkdir(parents=True)
    scan = sitk.GetImageFromArray(shifted(1))
    scan.SetSpacing((0.5, 1.0, 2.0))  # 18 x 36 x 80 mm, seen in a box of 36 x 36 x 80
    sitk.WriteImage(scan, str(folder / "a&b.nrrd"))
    sitk.WriteImage(sitk.GetImageFromArray(np.full(SHAPE, 150, np.uint8)), str(folder / "bare.nrrd"))
    sitk.WriteImage(sitk.JoinSeries([scan, scan]), str(folder / "beat.nii.gz"))
    (folder / "bad.nrrd").write_text("no volume")
    (folder / os.fsdecode(b"lat\xe9in.nrrd")).write_bytes((folder / "bare.nrrd").read_bytes())
    out = tmp_path / "out"
    rows = _study.batch(find_files([str(folder)]), SETTINGS, out, client, lambda: None)
    page = (out / "index.html").read_text()
    assert "<b>" not in page and "<h1>6 volumes</h1>" in page and "3 were clipped. In 1 the plugin found" in page
    pictures = {unescape(alt): unquote(src) for src, alt in re.findall(r'<img src="([^"]*)" alt="([^"]*)"', page)}
    names = [f"<b>anna #1?/{name}" for name in ("a&b.nrrd", "beat.nii.gz [0]", "beat.nii.gz [1]", "bare.nrrd")]
    said = dict.fromkeys(names[:3], "clipped") | {names[3]: "nothing was clipped"}
    assert set(pictures) == {f"{name}, {what}" for name, what in said.items()}
    sizes = {alt: sitk.ReadImage(str(out / src)).GetSize() for alt, src in pictures.items()}
    wide = 128 * 2 + round(128 * 80 / 36) + 6
    assert sizes[f"{names[0]}, clipped"] == (wide, 128)
    failed = [unescape(line) for line in re.findall("<li>(.*)</li>", page)]
    assert len(failed) == 2 and any("lat\\udce9in.nrrd': the name is not UTF-8" in line for line in failed)
    assert len(table(out)) == len(rows) == 6


def test_a_small_look_is_the_quick_look(volume: np.ndarray) -> None:
    result = smartvis.clip(volume, (1, 1, 1), method="wall")
    look = quick_look(volume, result)
    assert np.array_equal(small_look(volume, result, len(look)), look)
    half = small_look(volume, result, len(look) // 2)
    panel = look[:, : volume.shape[2]].astype(float)
    mean = (panel[::2, ::2] + panel[1::2, ::2] + panel[::2, 1::2] + panel[1::2, 1::2]) / 4
    assert np.abs(half[:, : volume.shape[2] // 2] - mean).max() <= 0.5


def test_a_terminal_sees_how_many_are_done(tmp_path: Path) -> None:
    write_study(tmp_path / "study", 3)
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
    command = [sys.executable, "-P", "-m", "smartvis", "batch", str(tmp_path / "study"), "--out", str(tmp_path / "out")]
    command += ["--workers", "1", "--write", "depth", "--method", "wall"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=theirs, timeout=LONG)
    os.set_blocking(ours, False)
    said = os.read(ours, 1 << 16).decode()
    assert "batch: 100%" in said and " 3/3 " in said, said


def test_the_table_is_written_however_a_batch_ends(tmp_path: Path, client) -> None:
    def stop() -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        _study.batch(write_study(tmp_path / "study", 2), SETTINGS, tmp_path / "out", client, stop)
    assert len(table(tmp_path / "out")) == 1 and "<h1>1 volume<" in (tmp_path / "out" / "index.html").read_text()


@pytest.mark.night
def test_a_batch_that_is_killed_goes_on(tmp_path: Path, trouble: str, monkeypatch) -> None:
    """Its one worker stops at the fifth volume of seven, as long as the file `hold` is there."""
    write_study(tmp_path / "study", 6)
    stops = tmp_path / "study" / "patient1" / "scan1a.nrrd"
    sitk.WriteImage(sitk.GetImageFromArray(np.full(SHAPE, HOLDS, np.uint8)), str(stops))
    hold, out = tmp_path / "hold", tmp_path / "out"
    hold.write_text("")
    monkeypatch.setenv("SV_HOLD", str(hold))
    command = [sys.executable, "-P", "-m", "smartvis", "batch", str(tmp_path / "study"), "--out", str(out)]
    command += ["--workers", "1", "--write", "clipped", "--scanned", "all", "--plugin", trouble]
    first = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
    end = time.monotonic() + LONG
    while len(rows_of(out)) < 4 and time.monotonic() < end and first.poll() is None:
        time.sleep(0.02)
    os.killpg(first.pid, signal.SIGKILL)  # the batch and its workers, wherever they are
    first.wait()
    before = rows_of(out)
    assert len(before) == 4, "the batch was to be killed in its middle"
    hold.unlink()
    done = subprocess.run(command, capture_output=True, text=True, timeout=LONG, check=False)
    assert done.returncode == 0 and "7 volumes clipped, 0 not" in done.stdout, done.stderr
    assert "dashboard at http://127.0.0.1:" in done.stderr
    after = rows_of(out)
    assert len(after) == 7 and all(after[p] == t for p, t in before.items())
    nothing_is_half(out)


@pytest.mark.night
def test_a_scheduler_elsewhere_is_used(tmp_path: Path, client) -> None:
    write_study(tmp_path / "study", 3)
    address = client.scheduler.address
    codes: list[int] = []
    arguments = ["batch", str(tmp_path / "study"), "--out", str(tmp_path / "out"), "--scheduler", address]
    thread = threading.Thread(target=lambda: codes.append(main(arguments)))
    thread.start()
    thread.join(LONG)
    assert codes == [0] and len(table(tmp_path / "out")) == 3


def test_wrong_calls(tmp_path: Path, capsys) -> None:
    assert main(["batch", str(tmp_path / "nowhere")]) == 3 and "nowhere" in capsys.readouterr().err
    (tmp_path / "empty").mkdir()
    assert main(["batch", str(tmp_path / "empty")]) == 3 and "there is no volume" in capsys.readouterr().err
    write_study(tmp_path / "study", 1)
    arguments = ["batch", str(tmp_path / "study"), "--scheduler", "nonsense://x"]
    assert main([*arguments, "--out", str(tmp_path / "out")]) == 2 and "nonsense" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        main(["batch", str(tmp_path / "study"), "--workers", "0"])
