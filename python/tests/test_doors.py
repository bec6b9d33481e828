# SPDX-License-Identifier: MIT
"""The table of what users have, and their files of ../shared/cases where they are at hand, through all doors that take
them: info, run, report, measure, console, smartvis clip, batch, serve and Python: the same bits at each, or one true
sentence. What is no file has tests of its own: threads in test_clipper, a batch that goes on, links and little memory
in test_resume, modules in the working folder in test_process, meshes in test_cli.
Requirement: R15."""

import csv
import html
import json
import os
import shutil
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import SimpleITK as sitk
from conftest import BUILD, LONG, SOURCE, host
from makers import written
from pyigtl.messages import ImageMessage
from users import FURTHER, NAMES, PLACED, RIGHT, SAID, TOLD

import smartvis
from smartvis._files import Source
from smartvis._images import says_spacing
from smartvis._rows import folder_of
from smartvis._work import Settings
from smartvis.cli import main
from smartvis.serve import Budget, Session

sys.path.append(str(SOURCE / "tests/host_sim/console"))
from console_client import Console, Page, until  # type: ignore[import-not-found]

FEW = ("--frames", 1, "--setting", "smartvis", "--picture", 32, "--few-pictures", "--write", "depthmap", "--out")


def the_users(path: Path, _: np.ndarray) -> None:
    """A copy of a file or folder of ../shared/cases: the console follows no link that leads out of its folder."""
    case = CASES / path.name.removeprefix("the_")
    (shutil.copytree if case.is_dir() else shutil.copyfile)(case, path)
    if case.suffix == ".mhd":
        shutil.copyfile(case.with_suffix(".raw"), path.with_name(f"{case.stem}.raw"))


CASES = SOURCE / "../shared/cases"
USERS = {  # what users elsewhere have; "": the surface is where the plain file's is
    **dict.fromkeys(("the_enhanced.dcm", "the_enhanced_t.dcm", "the_folder_enh", "the_folder_time", "the_um.nrrd"), ""),
    **dict.fromkeys(("the_outside_16.mha", "the_db_nan.mha", "the_db_999.mha", "the_supra.mhd", "the_rgb.nrrd"), ""),
    **dict.fromkeys(("the_nospace.mha", "the_nospace.nrrd"), "does not say how far apart its voxels are"),
    "the_plus_reconstructed.mha": "-z is assumed",
}
NEAR_MM = 1.5  # other levels, and the scenes of sequences are not the very same volume
BITS = ("plain.mha", "beat.mhd", "probe.vol", "the_supra.mhd", "db_nan.mha")  # whose maps the console writes
ALONE = ("nothing", "slices", "packed.mha.gz")  # of which batch finds nothing to do: test_kinds has them
ALL: dict[str, tuple[Any, str]] = {
    **FURTHER,
    **{name: (make, "") for name, make in RIGHT.items() if name not in ALONE},
    **{name: (make, words) for name, (make, _, words) in SAID.items() if name not in ALONE},
    **PLACED,
    **TOLD,
    **NAMES,
    **{name: (the_users, words) for name, words in USERS.items() if CASES.is_dir()},
}
BY_HOST = (".mha", ".mhd", ".vol")  # what the machine reads, too
# Of what Python alone reads some by day, the rest by night: after its reader, which test_kinds holds, all is the same.
BY_DAY = ("enhanced.dcm", "times.dcm", "folder", "series", "flow.dcm", "far.dcm", "two.nii", "zero.nii", "left.nrrd",
          "deep.nrrd", "nospace.nrrd", "colour.nrrd", "meta.nrrd", "lfs.nrrd", "points.vtk", "pages.tif")  # fmt: skip
NIGHT = bool(os.environ.get("SV_NIGHT"))


def by_day(name: str) -> bool:
    return name.lower().endswith(BY_HOST) or name in BY_DAY or name in USERS


ROWS = {name: row for name, row in ALL.items() if by_day(name) != NIGHT or name == "plain.mha"}
# The evaluation reads as `run` does, so by day it has every third file.
JUDGED = tuple(ROWS)[:: 1 if NIGHT else 3]
NOT_SENT = ("left.nrrd", "letters.mha", "two.nii", "far.dcm", *TOLD)  # what a message does not hold


@pytest.fixture(scope="module")
def scene() -> smartvis.Scene:
    return smartvis.scene("D01", size=96)


@pytest.fixture(scope="module")
def folder(tmp_path_factory, scene: smartvis.Scene) -> Path:
    """A file of every row."""
    made = tmp_path_factory.mktemp("rows")
    for name, (make, _) in ROWS.items():
        make(made / name, scene.full[::2])
    return made


@pytest.fixture(scope="module")
def plain_mm(folder: Path) -> float:
    return float(smartvis.clip(folder / "plain.mha").depth_mm.mean())


@pytest.fixture(scope="module")
def on_page(folder: Path, tmp_path_factory) -> Iterator[Callable[[str], tuple[str, np.ndarray | None]]]:
    """Opens a volume in the console: what its page is told, and of some files the depthmap that it writes."""
    out = tmp_path_factory.mktemp("console")
    console = Console(str(BUILD), ["--stay", "--out", str(out), str(folder)])

    def let_in(pages: list[Any]) -> bool:
        pages.append(Page(console, timeout=LONG))
        return bool(pages[-1].open)

    def opened(name: str) -> tuple[str, np.ndarray | None]:
        pages: list[Any] = []  # one for each file: a page that answers no ping while other doors are tried is closed
        until(lambda: let_in(pages), LONG, f"{name}: the console lets no page in")
        page = pages[-1]
        page.must("hello")
        frame = page.show(source={"folder": 0, "path": name, "from": "probe"})
        if name in BITS:
            page.say({"type": "do", "what": "write"})
        drawn = read(Path(page.must("written")["folder"]) / "depthmap.mha") if name in BITS else None
        page.close()
        return json.dumps(frame), drawn

    yield opened
    console.end()


@pytest.fixture(scope="module")
def batched(folder: Path, tmp_path_factory) -> dict[str, tuple[str, np.ndarray | None]]:
    """Of every file the first volume, and what the table says of all."""
    out = tmp_path_factory.mktemp("batch")
    main(["batch", *(str(folder / name) for name in ROWS), "--out", str(out), "--workers", "2", "--write", "depth"])
    with open(out / "table.csv", newline="") as table:
        rows = list(csv.DictReader(table))
    made: dict[str, tuple[str, np.ndarray | None]] = {}
    for row in rows:
        said, depth = made.get(name := Path(row["file"]).name, ("", None))
        if row["frame"] == "0" and row["files"]:
            depth = read(folder_of(out, Path(row["file"])) / row["files"])
        made[name] = (said + str(row), depth)
    return made


def read(path: Path) -> np.ndarray | None:
    """The map in a file, of a sequence the first."""
    if not path.exists():
        return None
    voxels = sitk.GetArrayFromImage(sitk.ReadImage(str(path)))
    return voxels.reshape(-1, *voxels.shape[-2:])[0]


def run(path: Path, out: Path, *more: object) -> tuple[str, np.ndarray | None]:
    _, said = host("run", "--volume", path, *more, *FEW, out)
    return said, read(out / "depthmap.mha")


def served(image: sitk.Image) -> tuple[str, np.ndarray | None]:
    """As a message, which always says a spacing."""
    matrix = np.eye(4)
    matrix[:3, :3] = np.reshape(image.GetDirection(), (3, 3)) * image.GetSpacing()
    message = ImageMessage(sitk.GetArrayFromImage(image), ijk_to_world_matrix=matrix, device_name="Scan")
    answers = Session(Settings(), Budget(1 << 40, 1 << 40)).answer(message)
    return answers[-1].string, answers[1].image[0]


def reported(path: Path, truth: Path, scene: smartvis.Scene, shape: Any, result: Any, out: Path) -> dict[str, str]:
    """What `report`, its page and `measure` say; the plugin's surface and the result's are the same bits."""
    written(np.resize(scene.label, (1, *shape)).astype(np.uint8), out / "label.mha")
    case = f"{path},{truth},{out / 'label.mha'}"
    code, said = host("report", "--case", case, "--compare", "-", "--seeds", 1, "--frames", 0, "--out", out)
    if result is not None:
        written(result.depth[None], out / "map.mha")
    measured = host("measure", "--case", case, "-" if result is None else out / "map.mha")
    if code == 0:
        with open(out / "compare.csv", newline="") as table:
            row = next(csv.DictReader(table))
        figures = json.JSONDecoder().raw_decode(measured[1][measured[1].index("[\n") :])[0][0]
        assert figures["e_abs"] == pytest.approx(float(row["e_abs"]), rel=1e-5)
        assert result is None or figures["map_crc32"] == int(row["map_crc32"])
    page = (out / "index.html").read_text() if code == 0 else said  # what is doubtful stands there, too
    return {"report": said, "measure": measured[1], "page": html.unescape(page)}


@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.night if NIGHT else ()) for name in ROWS])
def test_every_file_at_every_door(name, folder, scene, plain_mm, on_page, batched, tmp_path, capsys) -> None:
    make, words = ROWS[name]
    path = folder / name
    main(["clip", str(path), "--out", str(tmp_path), "--write", "depth"])
    told = "".join(capsys.readouterr())
    maps = [read(one) for one in sorted(tmp_path.glob("*_depth.nrrd"))]
    image = Source(path).read() if maps else None
    result = smartvis.clip(image) if ", OK," in told else None
    doors = {
        "clip": (told, maps[0] if maps else None),
        "batch": batched[name],
        "run": run(path, tmp_path / "run"),
        "info": (host("info", path)[1], None),
    }
    if name.lower().endswith(BY_HOST):
        text, drawn = on_page(name)  # in a box that holds all directions, so on another grid
        if drawn is not None:
            turned = run(path, tmp_path / "turned", "--turnable")[1]
            assert turned is not None and np.array_equal(drawn, turned)
        doors["console"] = (text, None)
    else:
        for door in ("run", "info"):  # what is MetaImage by its content is read there
            text = doors.pop(door)[0]
            assert "'smartvis clip' of the Python package" in text or name in NAMES, text
    if image is not None and says_spacing(image) and name not in ("probe.vol", *NOT_SENT):
        doors["serve"] = served(image)
    if name in JUDGED and not name.startswith(("deep", "probe", "meta.nrrd")):
        truth = path if name in USERS else tmp_path / ("truth" + "".join(path.suffixes))
        if truth != path:
            make(truth, scene.truth[::2])
        shape = image.GetSize()[1::-1] if image else scene.label.shape
        says = reported(path, truth, scene, shape, result, tmp_path)
        refused = ("'smartvis clip' of the", "volumes, expected one")
        doors |= {door: (text, None) for door, text in says.items() if not any(part in text for part in refused)}
    for door, (text, depth) in doors.items():
        said = words in text or (name in NAMES and "MetaImage" in text)  # the machine has words of its own
        assert said, (door, text)
        assert words or "--spacing X,Y,Z" not in text, (door, text)
        if result is not None and door not in ("report", "measure", "page", "console", "info"):
            assert depth is not None and np.array_equal(depth, result.depth_mm), door
        assert result is not None or depth is None or not depth.any(), door
    if name in USERS and not words:
        several = {"the_enhanced_t.dcm": 3, "the_folder_enh": 3, "the_folder_time": 3, "the_supra.mhd": 3}
        means = [float(depth.mean()) for depth in maps if depth is not None]
        assert means == pytest.approx([plain_mm] * several.get(name, 1), abs=NEAR_MM)
