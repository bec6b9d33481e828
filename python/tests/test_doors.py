# SPDX-License-Identifier: MIT
"""Files of many kinds through all doors that take them, run, report, measure, console, smartvis clip, batch and serve:
the same bits at each, or one true sentence."""

import csv
import html
import json
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import SimpleITK as sitk
from conftest import BUILD, LONG, SOURCE
from pyigtl.messages import ImageMessage
from test_kinds import MM, RIGHT, SAID, host, meta, nrrd, written

import smartvis
from smartvis._files import Source, stem
from smartvis._study import folder_of
from smartvis._work import Settings
from smartvis.cli import main
from smartvis.serve import Budget, Session

sys.path.append(str(SOURCE / "tests/machine/console"))
from console_client import Console, Page  # type: ignore[import-not-found]

FEW = ("--frames", 1, "--setting", "smartvis", "--picture", 32, "--few-pictures", "--write", "depthmap", "--out")


def along_y(voxels: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(voxels.transpose(1, 0, 2)[:, ::-1])


def deep(path: Path, voxels: np.ndarray) -> None:
    """The depth runs along y, reversed: the probe is at +y."""
    written(along_y(voxels), path, (1.25, 2.5, 1.25))


FURTHER = {  # name: how it is made, what is said; "": it is clipped as the plain file is
    "plain.mha": (lambda path, v: meta(path, v, MM), ""),
    "PLAIN.MHA": (lambda path, v: meta(path, v, MM), ""),
    "deep.mha": (deep, ""),
    "deep.nrrd": (deep, ""),
    "signed.mha": (lambda path, v: meta(path, np.where(v, v.astype("<i2"), -32768), MM, kind="MET_SHORT"), ""),
    "most.mha": (lambda path, v: meta(path, np.where(v, v.astype("<u2") * 8, 4095), MM, kind="MET_USHORT"), ""),
    "cm.mha": (lambda path, v: meta(path, v, "ElementSpacing = .125 .125 .25"), "its spacing in centimetres?"),
    "um.mha": (lambda path, v: meta(path, v, "ElementSpacing = 1250 1250 2500"), "its spacing in micrometres?"),
    "uneven.mha": (lambda path, v: meta(path, v, "ElementSpacing = .1 .1 2.5"), "times as long as another"),
    "zero.mha": (lambda path, v: meta(path, v, "ElementSpacing = 0 0 0"), "ElementSpacing is '0 0 0', expected"),
    "comma.mha": (lambda path, v: meta(path, v, "ElementSpacing = 1,25 1,25 2,5"), "is '1,25 1,25 2,5', expected"),
    "flow.mha": (
        lambda path, v: meta(path, np.repeat(v[..., None], 2, -1), MM, "ElementNumberOfChannels = 2"),
        "ElementNumberOfChannels is '2'"),
    "thick.nrrd": (lambda path, v: nrrd(path, v, "thicknesses: 1.25 1.25 2.5"), "does not say how far apart"),
}  # fmt: skip
ALONE = ("times.dcm", "supra.mha", "folder", "nothing", "slices", "packed.mha.gz")  # test_kinds has them
ROWS: dict[str, tuple[Any, str]] = {
    **FURTHER,
    **{name: (make, "") for name, make in RIGHT.items() if name not in ALONE},
    **{name: (make, words) for name, (make, _, words) in SAID.items() if name not in ALONE},
}


@pytest.fixture(scope="module")
def scene() -> smartvis.Scene:
    return smartvis.scene("D01", size=96)


@pytest.fixture(scope="module")
def folder(tmp_path_factory, scene: smartvis.Scene) -> Path:
    """A file of every row, and where the report can have it, its truth in a folder of its name."""
    made = tmp_path_factory.mktemp("rows")
    for name, (make, _) in ROWS.items():
        make(made / name, scene.full[::2])
    return made


@pytest.fixture(scope="module")
def on_page(folder: Path, tmp_path_factory) -> Iterator[Callable[[str], tuple[str, np.ndarray | None]]]:
    """Opens a volume in the console: what its page is told, and of the plain file the depthmap that it writes."""
    out = tmp_path_factory.mktemp("console")
    console = Console(str(BUILD), ["--out", str(out), str(folder)])
    page = Page(console, timeout=LONG)
    page.text("hello")

    def opened(name: str) -> tuple[str, np.ndarray | None]:
        frame = page.show(source={"folder": 0, "path": name, "from": "probe"})
        if name != "plain.mha":  # its files take long
            return json.dumps(frame), None
        page.say({"type": "do", "what": "write"})
        return json.dumps(frame), read(Path(page.text("written")["folder"]) / "depthmap.mha")

    yield opened
    console.end()


@pytest.fixture(scope="module")
def batched(folder: Path, tmp_path_factory) -> dict[str, tuple[str, np.ndarray | None]]:
    out = tmp_path_factory.mktemp("batch")
    main(["batch", *map(str, sorted(folder.iterdir())), "--out", str(out), "--workers", "2", "--write", "depth"])
    with open(out / "table.csv", newline="") as table:
        rows = list(csv.DictReader(table))
    maps = {row["file"]: read(folder_of(out, Path(row["file"])) / row["files"]) for row in rows if row["files"]}
    return {Path(row["file"]).name: (str(row), maps.get(row["file"])) for row in rows}


def read(path: Path) -> np.ndarray | None:
    if not path.exists():
        return None
    voxels = sitk.GetArrayFromImage(sitk.ReadImage(str(path)))
    return voxels.reshape(-1, *voxels.shape[-2:])[-1]


def run(path: Path, out: Path, *more: object) -> tuple[str, np.ndarray | None]:
    _, said = host("run", "--volume", path, *more, *FEW, out)
    return said, read(out / "depthmap.mha")


def served(path: Path) -> tuple[str, np.ndarray | None]:
    """As a message, which always says a spacing, and voxels that Python can read."""
    image = Source(path).read()
    matrix = np.diag([*image.GetSpacing(), 1.0])
    message = ImageMessage(sitk.GetArrayFromImage(image), ijk_to_world_matrix=matrix, device_name="Scan")
    answers = Session(Settings(), Budget(1 << 40, 1 << 40)).answer(message)
    return answers[-1].string, answers[1].image[0]


def reported(path: Path, make: Any, scene: smartvis.Scene, map_: np.ndarray | None, out: Path) -> dict[str, str]:
    """What `report`, its page and `measure` say; the plugin's surface and this map are the same bits."""
    out.mkdir()
    make(out / f"truth{path.suffix}", scene.truth[::2])
    written(scene.label[None].astype(np.uint8), out / "label.mha")
    case = f"{path},{out / f'truth{path.suffix}'},{out / 'label.mha'}"
    code, said = host("report", "--case", case, "--compare", "-", "--seeds", 1, "--frames", 0, "--out", out)
    if map_ is not None:
        written(map_[None], out / "map.mha")
    measured = host("measure", "--case", case, "-" if map_ is None else out / "map.mha")
    if code == 0:
        with open(out / "compare.csv", newline="") as table:
            row = next(csv.DictReader(table))
        figures = json.JSONDecoder().raw_decode(measured[1][measured[1].index("[\n") :])[0][0]
        assert figures["e_abs"] == pytest.approx(float(row["e_abs"]), rel=1e-5)
        assert map_ is None or figures["map_crc32"] == int(row["map_crc32"])
    page = (out / "index.html").read_text() if code == 0 else said  # what is doubtful stands there, too
    return {"report": said, "measure": measured[1], "page": html.unescape(page)}


@pytest.mark.parametrize("name", ROWS)
def test_every_file_at_every_door(name, folder, scene, on_page, batched, tmp_path, capsys) -> None:
    make, words = ROWS[name]
    path = folder / name
    main(["clip", str(path), "--out", str(tmp_path), "--write", "depth"])
    result = smartvis.clip(path) if ", OK," in (told := "".join(capsys.readouterr())) else None
    doors = {
        "run": run(path, tmp_path),
        "batch": batched[name],
        "clip": (told, read(tmp_path / f"{stem(path)}_depth.nrrd")),
    }
    if path.suffix.lower() == ".mha":
        text, drawn = on_page(name)  # in a box that holds all directions, so on another grid
        if drawn is not None:
            turned = run(path, tmp_path, "--turnable")[1]
            assert turned is not None and np.array_equal(drawn, turned)
        doors["console"] = (text, None)
    else:
        assert "'smartvis clip' of the Python package" in doors.pop("run")[0]
    if result is not None and result.spacing_known:
        doors["serve"] = served(path)
    if not name.startswith("deep"):
        depth = None if result is None else result.depth
        says = reported(path, make, scene, depth, tmp_path / "report")
        doors |= {door: (text, None) for door, text in says.items() if "'smartvis clip' of the" not in text}
    for door, (text, depth) in doors.items():
        assert words in text, (door, text)
        assert words or "--spacing X,Y,Z" not in text, (door, text)
        if result is not None and door not in ("report", "measure", "page", "console"):
            assert depth is not None and np.array_equal(depth, result.depth_mm), door
        assert result is not None or depth is None or not depth.any(), door
