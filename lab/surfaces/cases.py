# SPDX-License-Identifier: MIT
"""A volume with its ground truth, to judge surfaces on: from files, a folder or a scene."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import rays
from numpy.typing import NDArray
from seen import Seen

from smartvis import _host, _metaimage
from smartvis._errors import FileError
from smartvis._seen import Levels
from smartvis._volume import Given, given

SIDE = 128  # voxels an axis of a scene
NEITHER, SAC, FETUS = 0, 1, 2  # what a ray meets


@dataclass(frozen=True)
class Told:
    """What a frame tells of the probe, as `Clipper` takes it."""

    probe: NDArray[np.float64] | None = None  #: the rotation from its axes to the volume's
    beams: Any = None

    def limited(self, how: str) -> Told:
        """So much of it: "beams" (all), "pose" or "nothing"."""
        return self if how == "beams" else Told(self.probe) if how == "pose" else Told()


@dataclass
class Case:
    """Volumes are [z, y, x], maps [y, x]."""

    name: str
    spacing: tuple[float, float, float]  #: mm along x, y, z
    full: NDArray[np.uint8]
    first: NDArray[np.uint16]  #: scanned slices of each ray
    end: NDArray[np.uint16]
    label: NDArray[np.uint8]
    truth: NDArray[np.float32]  #: the slice at which a ray ends in the ground truth
    clean: NDArray[np.uint8]  #: the ground truth: `full` without what hides
    near: NDArray[np.float32] | None = None  #: the admissible clipping depths of labelled rays, slices
    far: NDArray[np.float32] | None = None
    told: Told = Told()

    @property
    def slices(self) -> int:
        """How many."""
        return len(self.full)

    @property
    def labelled(self) -> NDArray[np.bool_]:
        """The rays of sac and fetus."""
        return self.label != NEITHER

    @property
    def scanned(self) -> NDArray[np.bool_]:
        """The voxels between the ends of each ray's scan."""
        z = np.arange(self.slices)[:, None, None]
        return (self.first <= z) & (z < self.end)

    @cached_property
    def seen(self) -> Seen:
        """As the machine sees it along its rays: scanned voxels that are 0 are 1."""
        slices, height, width = self.full.shape
        levels = Levels(self.full, self.spacing, mask=self.scanned, side="-z")
        grid = levels.plan(np.eye(3), width)
        if not np.allclose((width * self.spacing[0], height * self.spacing[1]), grid.box[0], rtol=1e-6):
            raise FileError(f"{self.name}: its map is not square")
        grid.shape, grid.view.n[:] = (slices, height, width), (width, height, slices)
        return Seen(levels, grid, self.spacing)


def ranges_of(full: NDArray[np.uint8]) -> tuple[NDArray[np.uint16], NDArray[np.uint16]]:
    """First scanned slice and the one behind the last of each ray: the zeros at its ends were not scanned."""
    there = full != 0
    first = there.argmax(axis=0)
    end = np.where(there.any(axis=0), len(full) - there[::-1].argmax(axis=0), 0)
    return first.astype(np.uint16), end.astype(np.uint16)


def make(name: str, spacing: Any, full: NDArray[np.uint8], clean: NDArray[np.uint8] | None = None,
         label: NDArray[np.uint8] | None = None, **more: Any) -> Case:  # fmt: skip
    """A case; without `clean` nothing of it is labelled."""
    first, end = ranges_of(full)
    label = np.zeros(full.shape[1:], np.uint8) if label is None else label
    truth = np.zeros(full.shape[1:], np.float32) if clean is None else rays.ends(clean)
    return Case(name, spacing, full, first, end, label, truth, full if clean is None else clean, **more)


# ------------------------------------------------------------------------------------------------- files


def levels_of(of: Given, mask: NDArray[np.bool_] | None = None) -> Levels:
    """A file as the machine takes it; `mask` stands for what it finds out of what was scanned."""
    said: dict[str, Any] = {"directions": of.directions, "side": of.said.side, "apex": of.said.apex, "kretz": of.kretz}
    return Levels(of.voxels, of.spacing, scanned="auto" if mask is None else "zeros", mask=mask, **said)


def told_of(levels: Levels, shape: tuple[int, ...], spacing: tuple[float, float, float]) -> Told:
    """What is known of probe and beams, along the volume's axes and from its first voxel."""
    count, mm = np.array(shape[::-1]), np.array(spacing)
    across = 0 if count[0] * mm[0] >= count[1] * mm[1] else 1
    grid = levels.plan(np.eye(3), int(count[across]))
    if not isinstance(grid.beams, tuple):
        return Told(grid.probe, grid.beams)
    box = np.array([grid.box[0], grid.box[0], grid.box[1]])  # around the volume's middle
    shift = 0.5 * (count * mm - box) + 0.5 * (box / grid.shape[::-1] - mm)
    apex = np.array(grid.beams[0], np.float32)
    apex = np.where(abs(shift) < 1e-9, apex, (apex + shift).astype(np.float32))
    return Told(grid.probe, (tuple(map(float, apex)), grid.beams[1]))


def volume(path: str) -> Case:
    """A volume without a truth."""
    of = given(path)
    levels, spacing = levels_of(of), of.spacing or (1.0, 1.0, 1.0)
    told = told_of(levels, levels.levels.shape, spacing)
    return make(Path(path).name, spacing, levels.levels, told=told)


def map_of(path: str, shape: tuple[int, ...]) -> NDArray[Any]:
    """One slice of `shape` (y, x)."""
    try:
        values, _ = _metaimage.read(Path(path))
    except OSError as error:
        raise FileError(f"{path}: {error.strerror}") from None
    if values.shape != (1, *shape):
        size = " ".join(map(str, values.shape[::-1]))
        raise FileError(f"{path}: DimSize is {size}, expected {shape[1]} {shape[0]} 1")
    return values[0]


def _label(path: str, shape: tuple[int, ...]) -> NDArray[np.uint8]:
    label = map_of(path, shape)
    if label.dtype != np.uint8 or label.max() > FETUS:
        raise FileError(f"{path}: label {label.max()}, expected bytes of 0 (neither), 1 (sac) or 2 (fetus)")
    return label


def _scan(paths: list[str], shape: tuple[int, ...], label: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """What two maps say was scanned. A label promises that something can be seen there."""
    first, end = (map_of(path, shape[1:]).astype(np.float64) for path in paths)
    for path, values in zip(paths, (first, end), strict=True):
        wrong = (values < 0) | (values > shape[0]) | (values != np.floor(values))
        _refuse(path, wrong, values, f"a slice of the volume, a whole number 0 .. {shape[0]}")
    _refuse(paths[0], first > end, first, f"no more than {paths[1]} has")
    _refuse(paths[0], (first == end) & (label != NEITHER), first, f"less than {paths[1]} has, since it has a label")
    z = np.arange(shape[0])[:, None, None]
    return (first <= z) & (z < end)


def _refuse(path: str, wrong: NDArray[np.bool_], values: NDArray[Any], expected: str) -> None:
    if wrong.any():
        y, x = np.argwhere(wrong)[0]
        raise FileError(f"{path}: pixel ({x}, {y}) is {values[y, x]:g}, expected {expected}")


def files(text: str) -> Case:
    """FULL,TRUTH,LABEL[,FIRST,END] as `host_sim report --case` takes them; black fluid is 1."""
    paths = text.split(",")
    if len(paths) not in (3, 5) or not all(paths):
        raise ValueError(f"'{text}': expected FULL,TRUTH,LABEL[,FIRST,END]")
    of, clean = given(paths[0]), given(paths[1])
    for what in ("shape", "spacing"):
        one, other = (getattr(v.voxels, what, None) or v.spacing for v in (of, clean))
        if one != other:
            raise FileError(f"{paths[1]}: {what} {other}, the volume has {one}")
    label = _label(paths[2], of.voxels.shape[1:])
    mask = _scan(paths[3:], of.voxels.shape, label) if len(paths) > 3 else None
    levels, spacing = levels_of(of, mask), of.spacing or (1.0, 1.0, 1.0)
    told = told_of(levels, of.voxels.shape, spacing)
    name = Path(paths[0]).stem
    name = name.split("_full")[0] or name
    return make(name, spacing, levels.levels, levels_of(clean, mask).levels, label, told=told)


def in_folder(folder: Path, name: str) -> Case:
    """NAME_full.mha, NAME_truth.mha, NAME_label.mha, NAME_first.mha and NAME_end.mha of a folder; scan_first.mha and
    scan_end.mha in place of the last two. NAME_near.mha and NAME_far.mha, if there, are the admissible depths."""
    scan = name if (folder / f"{name}_first.mha").exists() else "scan"
    parts = (f"{name}_full", f"{name}_truth", f"{name}_label", f"{scan}_first", f"{scan}_end")
    case = files(",".join(f"{folder}/{part}.mha" for part in parts))
    depths = [folder / f"{name}_{end}.mha" for end in ("near", "far")]
    if all(path.exists() for path in depths):
        case.near, case.far = (map_of(str(path), case.label.shape).astype(np.float32) for path in depths)
    return case


# ------------------------------------------------------------------------------------------------- scenes


def _turn(degrees: list[float]) -> NDArray[np.float64]:
    """The probe's axes in those of a scene's turned camera: hs_rotation of host_sim/scene."""
    angles = np.array(degrees, np.float32).astype(float) * np.pi / 180
    (sx, sy, sz), (cx, cy, cz) = np.sin(angles), np.cos(angles)
    rows = [[cy * cz, cy * sz, -sy], [sx * sy * cz - cx * sz, sx * sy * sz + cx * cz, sx * cy],
            [cx * sy * cz + sx * sz, cx * sy * sz - sx * cz, cx * cy]]  # fmt: skip
    return np.array(rows, np.float32).astype(np.float64)


def scene(name: str, seed: int = 0, pose: int = 0, frames: int = 1, real: str = "") -> Iterator[Case]:
    """The frames of a scene of 128^3 voxels. `pose` 0: as its file has it; else fetus, limbs, occluders and sac are
    shifted (by up to 4 mm), turned (8 degrees) and scaled (4 %), by numbers that `pose` seeds. `real`: the volume of
    the scene of that name, which has no admissible depths. Beams run along z."""
    with tempfile.TemporaryDirectory() as folder:
        what = name
        if pose:
            what = f"{folder}/posed.json"
            Path(what).write_text(json.dumps(_posed(name, pose)))
        arguments = ["scenes", what, "--size", str(SIDE), "--export", "--out", f"{folder}/out", "--frames", str(frames)]
        _host.run(arguments + (["--seed", str(seed)] if seed else []) + (["--real", real] if real else []))
        (facts,) = Path(folder, "out").glob("*.json")
        degrees = json.loads(facts.read_text()).get("camera_deg", [0, 0, 0])
        told = Told(_turn(degrees) if any(degrees) else np.eye(3), "parallel")
        for path in sorted(Path(folder, "out").glob("*_full.mha")):
            full, spacing = _metaimage.read(path)
            parts = {part: _metaimage.read(Path(str(path).replace("_full.mha", f"_{part}.mha")))[0]
                     for part in ("truth", "label", "near", "far")}  # fmt: skip
            near, far = (np.where(parts[end][0] < 0, np.float32(np.nan), parts[end][0]) for end in ("near", "far"))
            depths = {} if real else {"near": near, "far": far}
            yield make(name, spacing, full, parts["truth"], parts["label"][0], told=told, **depths)


class _Random:
    """-1 .. 1, the same on every machine."""

    def __init__(self, state: int) -> None:
        self._state = state
        for _ in range(5):
            self()

    def __call__(self) -> float:
        self._state = (self._state * 6364136223846793005 + 1442695040888963407) % (1 << 64)
        return (self._state >> 11) / 9007199254740992.0 * 2.0 - 1.0


_JOINTS = [f"{side}_{joint}" for part in (("elbow", "hand"), ("knee", "ankle")) for side in ("right", "left")
           for joint in part]  # fmt: skip


def _shift(of: dict[str, Any], key: str, amount: float, random: _Random) -> None:
    """Shifts the numbers of a list, or scales a single number, by up to `amount`."""
    if isinstance(of.get(key), list):
        of[key] = [value + amount * random() for value in of[key]]
    elif key in of:
        of[key] *= 1.0 + amount * random()


def _posed(name: str, pose: int) -> Any:
    """The scene of a name in another pose."""
    root = json.loads((Path(__file__).parents[2] / "data/scenes" / f"{name}.json").read_text())
    random = _Random(pose * 7919 + ord(name[0]) * 31 + ord(name[2]))
    _shift(root["sac"], "centre_mm", 2.0, random)
    for part in root["structures"]:
        if part["type"] == "fetus":
            amounts = {"position_mm": 4.0, "rotation_deg": 8.0, "scale": 0.04} | dict.fromkeys(_JOINTS, 3.0)
        else:
            amounts = {"centre_mm": 4.0} | ({"radii_mm": 2.0} if part["type"] == "occluder" else {})
        for key, amount in amounts.items():
            _shift(part, key, amount, random)
    return root


# ------------------------------------------------------------------------------------------------- changes


def _grey(level: NDArray[np.floating[Any]]) -> NDArray[np.uint8]:
    return np.clip(level + 0.5, 0.0, 255.0).astype(np.uint8)


def changed(case: Case, gain: float = 1.0, gamma: float = 1.0, black: float = 0.0) -> Case:
    """Grey levels become 255 (level / 255)^gamma * gain + black, at scanned voxels only."""
    table = np.array([255.0 * (level / 255.0) ** gamma * gain + black for level in range(256)])
    return replace(case, full=np.where(case.scanned, _grey(table)[case.full], case.full))


def changed_near(case: Case, slices: int, gain: float, black: float) -> Case:
    """The first scanned slices of every ray become level * gain + black: gel, a dead zone, a skin line."""
    near = case.scanned & (np.arange(case.slices)[:, None, None] < case.first.astype(int) + slices)
    return replace(case, full=np.where(near, _grey(np.arange(256) * gain + black)[case.full], case.full))
