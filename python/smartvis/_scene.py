# SPDX-License-Identifier: MIT
"""The synthetic scenes with their truth, and the quality of a depthmap on them, both by the host."""

from __future__ import annotations

import json
import math
import tempfile
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _host, _metaimage
from ._errors import HostError
from ._result import Result
from ._view import look, on_square

CASES = ("E01", "E02", "E03", "E04", "M01", "M02", "M03", "D01", "D02")


@dataclass(frozen=True, kw_only=True)
class Scene:
    """A volume with its ground truth, synthetic or one's own. Volumes are uint8 [z, y, x], maps [y, x]."""

    name: str = ""
    size: int = 0  #: voxels per axis of a synthetic one
    seed: int = 0  #: 0: the scene's own
    frame: int = 0  #: of its motion
    spacing: tuple[float, float, float]  #: mm along x, y, z
    full: NDArray[np.uint8] = field(repr=False)  #: what the probe sees; 0 was not scanned
    truth: NDArray[np.uint8] = field(repr=False)  #: the same without what hides the fetus
    label: NDArray[np.uint8] = field(repr=False)  #: what a ray meets: 0 neither, 1 the sac, 2 the fetus
    #: Slices where the fluid before the fetus begins and ends, -1: none. Empty if nobody knows.
    near: NDArray[np.float32] = field(default_factory=lambda: np.empty((0, 0), np.float32), repr=False)
    far: NDArray[np.float32] = field(default_factory=lambda: np.empty((0, 0), np.float32), repr=False)

    @property
    def scanned(self) -> NDArray[np.bool_]:
        """What the probe scanned, for `clip`."""
        return self.full > 0

    def clip(self, **keywords: Any) -> Result:
        """`smartvis.clip` on this scene, with its spacing and what was scanned of it."""
        from ._clip import clip

        return clip(self.full, self.spacing, **({"scanned": self.scanned} | keywords))


@dataclass(frozen=True)
class Measures:
    """How well a depthmap clips a scene (docs/evaluation.md). Errors are in steps of the renderer, shares
    are 0 .. 1; None over no ray."""

    e_abs: float | None  #: mean absolute error of the depths at which rays end
    e_pos: float | None  #: of the rays that end too early: what hides the fetus is left
    e_neg: float | None  #: of the rays that end too late: the fetus is cut
    e_abs_sac: float | None
    e_pos_sac: float | None
    e_neg_sac: float | None
    e_abs_fetus: float | None
    e_pos_fetus: float | None
    e_neg_fetus: float | None
    fetus_cut: float | None  #: share of the fetus' rays that are cut by more than two steps
    occluder_left: float | None  #: share of the hidden rays on which more than two steps are left
    e_abs_outside: float | None  #: mean absolute error of the rays beside the sac, which nothing else counts


def scene(name: str = "D01", size: int = 128, seed: int = 0, frame: int = 0) -> Scene:
    """One of the nine cases (`CASES`), a hard one ("H01" and on), a random one ("R7_3": number 3 of the set with
    seed 7), or a scene file, made by host_sim. ``frame`` is a frame of its motion.

    HostError: host_sim is not there, or does not know the scene.

    >>> scene("E01", size=64).full.shape
    (64, 64, 64)
    """
    with tempfile.TemporaryDirectory() as folder:
        arguments = ["scenes", name, "--size", str(size), "--export", "--out", folder]
        arguments += ["--seed", str(seed)] if seed else []
        arguments += ["--frames", str(frame + 1)] if frame else []
        try:
            _host.run(arguments, frames="frame + 1")
        except HostError as error:
            if not str(error).startswith("host_sim scenes: ") or Path(name).exists():  # an argument, or no host
                raise
            known = f"{', '.join(CASES)}, the hard ones from H01 on, random ones such as R7_3, or a scene file"
            raise HostError(f"{error}; scenes are {known}", error.code) from None
        stem = Path(name).stem + (f"_f{frame:03d}" if frame else "")
        full, spacing = _metaimage.read(Path(folder) / f"{stem}_full.mha")
        truth, _ = _metaimage.read(Path(folder) / f"{stem}_truth.mha")
        maps = {what: _metaimage.read(Path(folder) / f"{stem}_{what}.mha")[0][0] for what in ("label", "near", "far")}
    mm = (spacing[0], spacing[1], spacing[2])
    return Scene(name=name, size=size, seed=seed, frame=frame, spacing=mm, full=full, truth=truth, **maps)


def measure(of: Scene, depth: Result | NDArray[Any] | None) -> Measures:
    """The quality of a depthmap on the volumes and labels of a scene, by the measures of the report. `depth`: a result
    of `clip`, or slices [y, x] of the volume; None: unclipped. A map of fewer pixels is square, and its slices are as
    thick as its pixels are wide.

    >>> e01 = scene("E01", size=64)
    >>> measure(e01, e01.clip()).e_abs < measure(e01, None).e_abs
    True
    """
    return measure_many(of, {"map": depth})["map"]


def measure_many(of: Scene, maps: Mapping[str, Result | NDArray[Any] | None]) -> dict[str, Measures]:
    """`measure` for several maps of one scene, which costs little more than for one."""
    hosts = {name: None if depth is None else _of_the_host(of, depth) for name, depth in maps.items()}
    sizes = {depth.shape[0] for depth in hosts.values() if depth is not None}
    if len(sizes) > 1:  # of different grids: each is measured on its own
        kept = {name: size.shape[0] if size is not None else max(sizes) for name, size in hosts.items()}
        parts = [measure_many(of, {n: maps[n] for n in maps if kept[n] == size}) for size in sorted(sizes)]
        return {name: next(part[name] for part in parts if name in part) for name in maps}
    with tempfile.TemporaryDirectory() as folder:
        for name in ("full", "truth", "label"):
            values = np.asarray(getattr(of, name))
            if values.dtype != np.uint8 or values.ndim != (2 if name == "label" else 3):
                raise ValueError(
                    f"{name} is {values.dtype} of shape {values.shape}, expected uint8 [z, y, x], of labels [y, x]"
                )
            _metaimage.write(Path(folder) / f"{name}.mha", values, of.spacing)
        files = []
        for number, depth in enumerate(hosts.values()):
            if depth is not None:
                _metaimage.write(Path(folder) / f"{number}.mha", depth)
            files.append("-" if depth is None else f"{number}.mha")
        lowres = sizes.pop() if sizes else max(of.full.shape[1:])
        case = ["--case", "full.mha,truth.mha,label.mha", "--lowres", str(lowres)]
        out = _host.run(["measure", *case, *files], folder)
    rows = [{k: v for k, v in row.items() if not k.startswith("map")} for row in json.loads(out)]
    return {name: Measures(**row) for name, row in zip(maps, rows, strict=True)}


def _depth(of: Scene, depth: Result | NDArray[Any]) -> NDArray[np.float32]:
    if isinstance(depth, Result):
        if depth.camera.rotation.tolist() != np.eye(3).tolist():
            raise ValueError("the depthmap is of a turned view; scenes are measured from the probe")
        return depth.depth if depth.clips else np.zeros_like(depth.depth)
    values = np.asarray(depth, np.float32)
    own = np.shape(of.full)[1:]
    if values.ndim != 2 or (values.shape != own and values.shape[0] != values.shape[1]):
        raise ValueError(f"the depthmap has shape {values.shape}, expected {own} or as many rows as columns")
    if not np.isfinite(values).all():
        raise ValueError("the depthmap has values that are not finite; 0 clips nothing")
    return values


def _of_the_host(of: Scene, given: Result | NDArray[Any]) -> NDArray[np.float32]:
    """A map of the volume's own pixels and slices as one of the host's low-resolution volume, whose pixels are a square
    and whose voxels are cubes. Results of `clip` are such maps."""
    depth = _depth(of, given)
    slices, height, width = of.full.shape
    if isinstance(given, Result) and (given.camera.shape != of.full.shape or given.camera.spacing != of.spacing):
        return depth
    x, y, z = of.spacing
    cubes = math.isclose(x, y, rel_tol=1e-6) and math.isclose(x, z, rel_tol=1e-6)
    if depth.shape != (height, width) or (width == height and cubes):
        return depth
    mm = on_square(look(of.full.shape, of.spacing), depth)
    count = max(math.floor(slices * z / (max(width * x, height * y) / len(mm)) + 0.5), 1)  # slices of the host's
    return np.where(mm > 0, mm * np.float32(count / (slices * z)) - np.float32(0.5), 0).astype(np.float32)


def rank(
    methods: Mapping[str, Callable[[Scene], Result | NDArray[Any] | None]],
    cases: Iterable[str] = CASES,
    size: int = 128,
) -> dict[str, dict[str, Measures]]:
    """Measures of methods by name and case, best mean e_abs first. A method takes a Scene and returns what
    `measure` takes."""
    results: dict[str, dict[str, Measures]] = {name: {} for name in methods}
    for case in cases:
        of = scene(case, size=size)
        for name, measures in measure_many(of, {name: method(of) for name, method in methods.items()}).items():
            results[name][case] = measures
    return dict(sorted(results.items(), key=lambda item: mean_error(item[1])))


def mean_error(of: Mapping[str, Measures]) -> float:
    """The mean e_abs over cases."""
    return float(np.mean([m.e_abs for m in of.values() if m.e_abs is not None]))
