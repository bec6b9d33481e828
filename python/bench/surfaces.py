# SPDX-License-Identifier: MIT
"""Speed against error of every method that starts from initial points: surfaces.py [--quick] [--size N]... [--csv FILE]
[--svg FILE].

A volume of 64 slices, because only the reconstruction counts, with 3 % of the rays points, in patches. *frame* is the
plugin's call by the wall clock, *surface* its stage reconstruct by smartvis.timing/1, medians in milliseconds. *error*
is that against the method's float64 definition (libsmartvis_definitions.so in the build folder, SV_BUILD_DIR), slices:
an approximation is compared with what it approximates. *truth* is the mean distance of ray ends from the ground truth
over scenes of 128 voxels an axis, steps. The plot needs matplotlib.
"""

import argparse
import ctypes
import os
import sys
import time
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import smartvis
from smartvis import _door, _scene
from smartvis._active import Active
from smartvis._seen import Levels
from smartvis._view import on_grid

sys.path.append(str(Path(__file__).parent / "shared"))
from tables import Row, add_outputs, save

SIZES, SCENE_SIZE, SLICES = (128, 171, 512), 128, 64
SCENES = ("D01", "E01", "M02")
FLUID = 40  # its brightest grey level: the plugin's threshold by default
WARM_UP, LEAST_FRAMES = 2, 3
# Discs of bone as the viewer sees them: x, y, radius and depth in edges of the volume.
BONES = ((0.42, 0.38, 0.58), (0.50, 0.35, 0.56), (0.58, 0.39, 0.58), (0.45, 0.50, 0.62), (0.52, 0.55, 0.63),
         (0.60, 0.60, 0.66), (0.38, 0.62, 0.70), (0.66, 0.48, 0.72))  # fmt: skip
RADIUS, THICKNESS = 0.034, 0.03

Variant = dict[str, Any]

# Parameters that approximate: the definition has none of them.
APPROXIMATE = ("precision", "spline_grid")
QUICK: list[Variant] = [
    {"method": "mean", "kernel": 11},
    {"method": "mean", "kernel": 23},
    {"method": "mean", "kernel": 55},
    {"method": "minimum", "kernel": 23},
    {"method": "spline", "merge_grid": 8, "spline_grid": 0},
    {"method": "spline", "merge_grid": 8, "spline_grid": 32},
    {"method": "spline", "merge_grid": 8, "spline_grid": 32, "precision": "float32"},
]
MORE: list[Variant] = [
    {"method": "mean", "kernel": 3},
    {"method": "minimum", "kernel": 11},
    *({"method": "spline", "merge_grid": 8, "spline_grid": cells} for cells in (8, 16, 64)),
    {"method": "spline", "merge_grid": 37, "spline_grid": 32},
    {"method": "spline", "merge_grid": 0, "spline_grid": 32},
]
ON_VOLUMES = ("wall",)  # methods that take no points


@dataclass(frozen=True)
class Points:
    """A volume and what the definitions start from: its initial points, and the depths of their surface there."""

    volume: NDArray[np.uint8]
    status: NDArray[np.uint8]
    depth: NDArray[np.float64]


def label(variant: Variant) -> str:
    """A variant as `host_sim run --set` takes it, without the names that say nothing."""
    return " ".join(
        str(value) if key in {"method", "precision"} else f"{key} {value}" for key, value in variant.items()
    )


def points(n: int, q: float) -> Points:
    """A wall, fluid, then tissue with bones, n x n rays; all layers have noise."""
    y, x = (np.mgrid[:n, :n] + 0.5) / n
    near = ((0.16 + 0.03 * np.sin(9 * x) + 0.02 * np.cos(7 * y)) * SLICES).astype(int)
    far = ((0.42 + 0.5 * ((x - 0.5) ** 2 + (y - 0.5) ** 2)) * SLICES).astype(int)
    random = np.random.default_rng(1)
    volume = random.integers(60, 151, (SLICES, n, n)).astype(np.uint8)
    z = np.arange(SLICES)[:, None, None]
    fluid = (z >= near) & (z < far)
    volume[fluid] = random.integers(1, FLUID + 1, int(fluid.sum()))
    status = np.zeros((n, n), np.uint8)
    for across, down, depth in BONES:
        disc = (x - across) ** 2 + (y - down) ** 2 <= RADIUS**2
        first = int(depth * SLICES)
        volume[first : int((depth + THICKNESS) * SLICES), disc] = 240
        status[disc] = 1
    surface = (far.astype(np.float32) + np.float32(q) * (near - far).astype(np.float32)).astype(np.float64)
    return Points(volume, status, surface)


def definition(of: Points, variant: Variant) -> NDArray[np.float64]:
    """The surface that the method means, by the definitions' library."""
    height, width = of.status.shape
    surface = np.empty((height, width))
    build = Path(os.environ.get("SV_BUILD_DIR") or Path(__file__).resolve().parents[2] / "build")
    define = ctypes.CDLL(str(build / "libsmartvis_definitions.so")).sv_define_surface
    define.restype = ctypes.c_bool
    kernel, cells = variant.get("kernel", 23), variant.get("merge_grid", 0)
    arrays = [array.ctypes.data_as(ctypes.c_void_p) for array in (of.status, of.depth)]
    numbers = [ctypes.c_uint32(number) for number in (width, height, kernel, cells)]
    if not define(variant["method"].encode(), *arrays, *numbers, surface.ctypes.data_as(ctypes.c_void_p)):
        raise MemoryError(f"there is no definition of {variant['method']}, or no memory for it")
    return surface


def measure(of: Points, variant: Variant, q: float, frames: int, seconds: float) -> dict[str, float]:
    """Times of one variant, and how far its map is from the definition's. RuntimeError: it sees other points."""
    levels = Levels(of.volume, scanned="all")
    grid = levels.plan()
    camera = on_grid(of.volume.shape, (1.0, 1.0, 1.0), grid)
    active = Active(smartvis.load())
    active.reset({"q": q, **variant})
    result = active.clip(levels, grid, grid.view, {}, camera)
    if not result.clips or ((result.status > 0) != (of.status > 0)).any():
        raise RuntimeError(f"{label(variant)}: {result.outcome}, or other initial points than the definition has")
    wall, stage = list[float](), list[float]()
    begin = time.perf_counter()
    for frame in range(WARM_UP + frames):
        if len(wall) >= LEAST_FRAMES and time.perf_counter() - begin > seconds:
            break
        start = time.perf_counter()
        active.clip(levels, grid, grid.view, {}, camera)
        if frame >= WARM_UP or time.perf_counter() - start > seconds / frames:
            wall.append(1e3 * (time.perf_counter() - start))
        # Apart from the others: events cost time.
        active.clip(levels, grid, grid.view, {"flags": _door.NUMBERS["SVH_TIMED"]}, camera)
        stage.append(active.reconstruct_ms)
    active.close()
    off = np.abs(result.depth - definition(of, variant))
    return {
        "frame": float(np.median(wall)),
        "frame_min": min(wall),
        "surface": float(np.median(stage)),
        "error": float(off.max()),
        "error_mean": float(off.mean()),
    }


def truths(variants: list[Variant]) -> dict[str, float]:
    """The mean e_abs of the variants over the scenes."""
    methods = {label(v): lambda of, v=v: of.clip(**v) for v in variants} | {"unclipped": lambda of: None}
    ranked = smartvis.rank(methods, SCENES, SCENE_SIZE)
    return {name: _scene.mean_error(cases) for name, cases in ranked.items()}


def front(rows: Iterable[Row], error: str) -> list[Row]:
    """The rows that no other beats in time and error, from the fastest on."""
    best: list[Row] = []
    for row in sorted(rows, key=lambda row: (row["surface"], row[error])):
        if not best or row[error] < best[-1][error]:
            best.append(row)
    return best


def plot(rows: list[Row], path: str) -> None:
    """Time against both errors: a mark a row, hollow for an approximation; a front a size, with its names."""
    from matplotlib.figure import Figure

    figure = Figure((13, 6), layout="constrained")
    colours = {method: f"C{n}" for n, method in enumerate(sorted({row["method"] for row in rows}))}
    panels = (("error", "against the float64 definition, slices"), ("truth", "against the scenes' truth, steps"))
    for axes, (error, title) in zip(figure.subplots(1, 2), panels, strict=True):
        for method, colour in colours.items():
            axes.plot([], [], "o", color=colour, label=method)
        for size, mark in zip(SIZES, "os^", strict=True):
            some = [row | {error: max(row[error], 1e-7)} for row in rows if row["size"] == size and row[error] != ""]
            for row in some:
                face = "none" if row["approximates"] else colours[row["method"]]
                axes.plot(row["surface"], row[error], mark, color=colours[row["method"]], mfc=face)
            best = front(some, error)
            for row in best:
                place = (row["surface"], row[error])
                axes.annotate(row["variant"], place, (5, 5), textcoords="offset points", fontsize=7)
            if best:
                x, y = zip(*((row["surface"], row[error]) for row in best), strict=True)
                axes.step(x, y, where="post", color="0.5", lw=1, marker=mark, mfc="none", label=f"{size}², front")
        axes.set(xscale="log", yscale="log", xlabel="reconstruction, median, ms", ylabel=f"error {title}")
        axes.legend()
    figure.suptitle("Surface reconstruction: speed against error; hollow: a setting trades one for the other")
    figure.savefig(path)


def main() -> None:
    parse = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parse.add_argument("--quick", action="store_true", help="fewer variants, 10 frames, 0.3 seconds")
    parse.add_argument("--size", type=int, action="append", choices=SIZES, help="maps of N x N pixels only")
    parse.add_argument("--no-truth", action="store_true", help="without the scenes")
    add_outputs(parse)
    given = parse.parse_args()
    listed = QUICK if given.quick else QUICK + MORE
    known = smartvis.load().parameters["method"].choices
    variants = listed + [{"method": m} for m in known if m not in {*ON_VOLUMES, *(v["method"] for v in listed)}]
    q, rows, far = 0.5, list[Row](), {} if given.no_truth else truths(variants)
    print(f"{smartvis.load()}\n{'variant':48} {'size':>4} | frame (min) surface ms | error (mean) | truth", flush=True)
    for size in given.size or SIZES:
        of = points(size, q)
        for variant in variants:
            row = measure(of, variant, q, *((10, 0.3) if given.quick else (30, 2.0)))
            truth = far.get(label(variant), "") if size == SCENE_SIZE else ""
            rows.append({"variant": label(variant), "method": variant["method"], "size": size, **row, "truth": truth,
                         "approximates": any(variant.get(key) for key in APPROXIMATE)})  # fmt: skip
            times = "{frame:.3f} ({frame_min:.3f}) {surface:.3f}".format(**row)
            off = "{error:.2g} ({error_mean:.2g})".format(**row)
            print(f"{label(variant):48} {size:4} | {times} | {off} | {truth!s:.4}", flush=True)
    if far:
        print(f"nothing clipped: {far['unclipped']:.1f} steps")
    save(rows, given, plot)


if __name__ == "__main__":
    main()
