# SPDX-License-Identifier: MIT
"""What can be made of a result: a depthmap as an image, a mesh of the clipped volume, a quick look."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _images
from ._errors import extra_module
from ._result import Result, smallest
from ._seen import Levels

_WIDEST = 4  # times its height, of a panel


def depth_image(image: Any, result: Result) -> Any:
    """The depthmap in mm as an image of one slice that lies on the front of the volume, in its world; as host_sim
    writes it."""
    sitk = _images.sitk()
    camera = result.camera
    made = sitk.GetImageFromArray(result.depth_mm[None])
    made.SetSpacing([float(s) for s in camera.spacing])
    direction = np.array(image.GetDirection()).reshape(3, 3)
    made.SetDirection((direction @ camera.rotation.T).ravel().tolist())
    first = camera.to_volume_mm(np.zeros(3))
    made.SetOrigin((np.array(image.GetOrigin()) + direction @ first).tolist())
    if not result.spacing_known:
        made.SetMetaData(_images.NOT_SAID, "1")
    return made


def mesh(image: Any, result: Result, level: float | None = None) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """The surface of what is left, by scikit-image's marching cubes: vertices in the image's world (mm), faces.

    `level`: where tissue begins; None: Otsu's threshold of the volume. Both are empty if nothing is that bright.
    """
    threshold_otsu = extra_module("skimage.filters", "scikit-image", "files", "a mesh").threshold_otsu
    marching_cubes = extra_module("skimage.measure", "scikit-image", "files", "a mesh").marching_cubes
    if level is not None and not math.isfinite(level):
        raise ValueError(f"level={level}, expected a finite grey value")
    volume = _images.array(image)
    if level is None:
        level = _tissue(volume, result, threshold_otsu)
    clipped = result.apply(volume)
    if clipped.dtype.kind == "f":
        clipped = np.where(np.isfinite(clipped), clipped, smallest(clipped))
    # A shell of nothing around it closes the mesh at the volume's faces.
    clipped = np.pad(clipped.astype(np.float32), 1, constant_values=min(float(clipped.min()), level - 1))
    if not clipped.min() < level < clipped.max():
        return np.empty((0, 3)), np.empty((0, 3), np.int64)
    vertices, faces, _, _ = marching_cubes(clipped, level)
    index = vertices[:, ::-1].astype(np.float64) - 1.0
    direction = np.array(image.GetDirection()).reshape(3, 3)
    world = (index * np.array(image.GetSpacing())) @ direction.T + np.array(image.GetOrigin())
    return world, faces.astype(np.int64)


def _tissue(volume: NDArray[Any], result: Result, threshold_otsu: Any) -> float:
    """Where tissue begins, by the levels that the plugin saw: 256 of them, whatever values the file has."""
    levels = Levels(volume, window=result.window, scanned="auto")
    counts = np.bincount(levels.levels.ravel(), minlength=256)[1:]
    if np.count_nonzero(counts) < 2:
        return math.inf
    at = float(threshold_otsu(hist=(counts, np.arange(1, 256))))
    return levels.low + (at + 0.5) / 255.0 * (levels.high - levels.low)


def quick_look(volume: NDArray[np.uint8], result: Result) -> NDArray[np.uint8]:
    """Three panels [y, x, rgb] as the camera sees them: the volume's brightest voxels, what is left shaded by its
    first tissue, and a cut down the middle with the surface on it. A voxel is a pixel."""
    panels = _panels(volume, result)
    return np.concatenate([_to_height(panel, len(panels[0])) for panel in panels], axis=1)


def small_look(volume: NDArray[np.uint8], result: Result, height: int = 128) -> NDArray[np.uint8]:
    """`quick_look` with so many rows, in which millimetres are as long across as down."""
    x, y, z = result.camera.spacing
    small = []
    for panel, across in zip(_panels(volume, result), (x, x, z), strict=True):
        width = round(height * panel.shape[1] * across / (panel.shape[0] * y))
        small.append(_resized(panel, height, min(max(width, 1), _WIDEST * height)))
    return np.concatenate([_to_height(panel, height) for panel in small], axis=1)


def _panels(volume: NDArray[np.uint8], result: Result) -> list[NDArray[np.uint8]]:
    seen = result.camera.see(volume)
    tissue = int(seen.mean() + seen.std()) + 1
    z = np.arange(seen.shape[0], dtype=np.float32)[:, None, None]
    left = np.where(z >= (result.depth if result.clips else 0), seen, 0)
    hit = left >= tissue
    first = np.where(hit.any(axis=0), hit.argmax(axis=0), seen.shape[0]).astype(np.float32)
    slope_y, slope_x = np.gradient(first)
    light = (1.0 + 0.4 * slope_x + 0.4 * slope_y) / np.sqrt(1.0 + slope_x**2 + slope_y**2)
    shaded = np.where(first < seen.shape[0], np.clip(60 + 150 * light, 20, 255), 0)
    return [_grey(seen.max(axis=0)), _grey(shaded), _cut(seen, result, seen.shape[1])]


def _resized(picture: NDArray[np.uint8], height: int, width: int) -> NDArray[np.uint8]:
    """The mean over the area that a pixel covers."""
    values = picture.astype(np.float64)
    for axis, count in ((0, height), (1, width)):
        old = values.shape[axis]
        sums = np.insert(np.cumsum(values, axis), 0, 0, axis)
        at = np.linspace(0, old, count + 1)
        whole = np.minimum(at.astype(int), old - 1)
        part = np.expand_dims(at - whole, [a for a in range(3) if a != axis])
        values = np.diff(sums.take(whole, axis) + part * values.take(whole, axis), axis=axis) * (count / old)
    return np.round(values).astype(np.uint8)


def _cut(seen: NDArray[np.uint8], result: Result, height: int) -> NDArray[np.uint8]:
    """The slice x = middle, depth to the right; what is clipped is dark, the surface is drawn."""
    x = seen.shape[2] // 2
    depth = result.depth[:, x] if result.clips else np.zeros(height, np.float32)
    cut = seen[:, :, x].T.astype(np.float32)
    cut[np.arange(seen.shape[0]) < depth[:, None]] *= 0.35
    picture = _grey(cut)
    rows = np.nonzero((depth > 0) & (depth < seen.shape[0]))[0]
    picture[rows, depth[rows].astype(int)] = (255, 160, 40)
    return picture


def _grey(values: NDArray[Any]) -> NDArray[np.uint8]:
    return np.repeat(values.astype(np.uint8)[..., None], 3, axis=2)


def _to_height(panel: NDArray[np.uint8], height: int) -> NDArray[np.uint8]:
    return np.pad(panel, ((0, height - panel.shape[0]), (0, 2), (0, 0)))
