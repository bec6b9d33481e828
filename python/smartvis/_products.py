# SPDX-License-Identifier: MIT
"""What can be made of a result: a depthmap as an image, a mesh of the clipped volume, a quick look."""

from __future__ import annotations

import base64
import math
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _images
from ._errors import HostError, extra_module
from ._files import whole, write_image, write_ply
from ._picture import png_of
from ._result import Result, smallest
from ._seen import Levels
from ._volume import given, to_uint8

PRODUCTS = ("clipped", "depth", "mesh", "look")  #: what is written unless somebody says
WRITABLE = (*PRODUCTS, "mask")
_WIDEST = 4  # times its height, of a panel


def image_of(image: Any, result: Result, product: str) -> Any:
    """The product that is an image, in the world of the volume; None: it is none. The mask is 1 where a voxel is
    kept, as host_sim's."""
    if product == "depth":
        return depth_image(image, result)
    if product == "mask":
        return _images.like(image, result.mask())
    return result.apply(image) if product == "clipped" else None


def depth_image(image: Any, result: Result) -> Any:
    """The depthmap in mm as an image of one slice that lies on the front of the volume, in its world; as host_sim
    writes it."""
    sitk = _images.sitk()
    camera = result.camera
    made = sitk.GetImageFromArray(result.depth_mm[None])
    made.SetSpacing([float(s) for s in camera.spacing])
    made.SetDirection((_images.axes(image) @ camera.rotation.T).ravel().tolist())
    made.SetOrigin(_images.in_world(image, camera.to_volume_mm(np.zeros(3))).tolist())
    if not result.spacing_known:
        made.SetMetaData(_images.NOT_SAID, "1")
    return _images.says_no_more(made, image)


def mesh(image: Any, result: Result, level: float | None = None) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """The surface of what is left, by scikit-image's marching cubes: vertices in the image's world (mm), faces whose
    front is outside.

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
    outwards = 1 if np.linalg.det(_images.axes(image)) > 0 else -1  # left-handed axes turn every face round
    return _images.in_world(image, index * np.array(image.GetSpacing())), faces[:, ::outwards].astype(np.int64)


def _tissue(volume: NDArray[Any], result: Result, threshold_otsu: Any) -> float:
    """Where tissue begins, by the levels that the plugin saw: 256 of them, whatever values the file has."""
    levels = Levels(volume, window=result.window, scanned="auto")
    counts = np.bincount(levels.levels.ravel(), minlength=256)[1:]
    if np.count_nonzero(counts) < 2:
        return math.inf
    at = float(threshold_otsu(hist=(counts, np.arange(1, 256))))
    return levels.low + (at + 0.5) / 255.0 * (levels.high - levels.low)


def quick_look(volume: Any, result: Result) -> NDArray[np.uint8]:
    """Three panels [y, x, rgb] as the camera sees them: the volume's brightest voxels, what is left shaded by its
    first tissue, and a cut down the middle with the surface on it. A voxel is a pixel. `volume`: whatever `clip` takes,
    of the shape that was clipped; None: what was clipped."""
    panels = _panels(volume, result)
    return np.concatenate([_to_height(panel, len(panels[0])) for panel in panels], axis=1)


def small_look(volume: Any, result: Result, height: int = 128) -> NDArray[np.uint8]:
    """`quick_look` with so many rows, in which millimetres are as long across as down."""
    x, y, z = result.camera.spacing
    small = []
    for panel, across in zip(_panels(volume, result), (x, x, z), strict=True):
        width = round(height * panel.shape[1] * across / (panel.shape[0] * y))
        small.append(_resized(panel, height, min(max(width, 1), _WIDEST * height)))
    return np.concatenate([_to_height(panel, height) for panel in small], axis=1)


def file_of(name: str, product: str, suffix: str) -> str:
    """What a product's file is called, of a volume's name."""
    own = {"mesh": ".ply", "look": ".png", "small": ".png"}.get(product, suffix)
    return f"{name}_{product}{own}"


def write(
    image: Any, result: Result, prefix: Path, product: str, suffix: str = ".nrrd", level: float | None = None
) -> Path:
    """One of WRITABLE, or the "small" look, beside `prefix`. `suffix` is of volumes, `level` the mesh's."""
    return write_as(image, result, prefix.with_name(file_of(prefix.name, product, suffix)), product, level)


def write_as(image: Any, result: Result, path: Path, product: str, level: float | None = None) -> Path:
    """The same under this name, whose suffix says a volume's format."""
    if product == "mesh":
        return write_ply(path, *mesh(image, result, level), mm=result.spacing_known)
    if (made := image_of(image, result, product)) is not None:
        return write_image(path, made)
    look = (small_look if product == "small" else quick_look)(image, result)
    return whole(path, lambda part: part.write_bytes(png_of(look)))


def save(result: Result, path: Path) -> list[Path]:
    """The files that a name stands for, see Result.save."""
    suffix = path.suffix.lower()
    if suffix == ".npz":
        maps = {name: getattr(result, name) for name in ("depth", "depth_mm", "status", "confidence")}
        known = {name: values for name, values in maps.items() if values is not None}
        return [whole(path, lambda part: _save_maps(part, known))]
    if suffix == ".png":
        return [write_as(result.source, result, path, "look")]
    image = result.source
    if not _images.is_image(image):
        image = _images.of(given(image).voxels, result.camera.source_spacing if result.spacing_known else None)
    if not suffix:
        return [write(image, result, path / "result", product) for product in PRODUCTS]
    return [write_as(image, result, path, "mesh" if suffix == ".ply" else "clipped")]


def _save_maps(path: Path, maps: dict[str, NDArray[Any]]) -> None:
    with open(path, "wb") as file:  # numpy would add a suffix to a name
        np.savez_compressed(file, **maps)  # type: ignore[arg-type]


def figure_of(result: Result) -> str:
    """HTML: the picture, by the host where there is one, and what came of it."""
    try:
        png = result.picture(size=256).png
    except HostError:
        png = png_of(quick_look(None, result))
    said = repr(result)[1:-1].removeprefix("Result ")
    picture = f'<img src="data:image/png;base64,{base64.b64encode(png).decode()}" alt="full volume and result">'
    return f"<figure>{picture}<figcaption>{escape(said)}</figcaption></figure>"


def _panels(volume: Any, result: Result) -> list[NDArray[np.uint8]]:
    voxels = to_uint8(given(result.source if volume is None else volume).voxels, result.window)
    if voxels.shape != result.camera.source_shape:
        raise ValueError(f"volume has shape {voxels.shape}, what was clipped had {result.camera.source_shape}")
    seen = result.camera.see(voxels)
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
