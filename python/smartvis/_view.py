# SPDX-License-Identifier: MIT
"""The camera: how the volume that the plugin sees lies in the volume that was given.

The plugin looks along +z of what it gets, on the grid that the machine makes of every volume.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._seen import Grid, Levels

Shape = tuple[int, int, int]
Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Camera:
    """Two grids around one centre: the volume's and the camera's. Shapes are [z, y, x], spacings x, y, z."""

    source_shape: Shape
    source_spacing: Vector
    rotation: NDArray[np.float64]  #: rows: the camera's right, down and forward in the volume's x, y, z (mm)
    shape: Shape  #: slices, height, width
    spacing: Vector

    @property
    def aligned(self) -> bool:
        """True if the camera's axes are axes of the volume, in any order and direction."""
        return bool(np.all(np.isin(np.abs(self.rotation), (0.0, 1.0))))

    def _axes(self) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Of an aligned camera: the array axis of the volume for each of its own, and which to reverse."""
        along = np.abs(self.rotation).argmax(axis=1)[::-1]  # camera z, y, x: 0 is the volume's x
        signs = self.rotation.sum(axis=1)[::-1]
        return tuple(int(2 - a) for a in along), tuple(int(i) for i in np.nonzero(signs < 0)[0])

    def see(self, volume: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """A volume of bytes as the camera sees it, on the camera's grid; what lies beyond it is 0."""
        if self.aligned and self._is_own_grid():
            order, reverse = self._axes()
            return np.ascontiguousarray(np.flip(volume.transpose(order), reverse))
        levels = Levels(volume, self.source_spacing)
        return levels.look(levels.plan(self.rotation, self.shape[2]))[0]

    def fine(self) -> Camera:
        """The same camera on the volume's own grid, or on one of cubes of its smallest spacing."""
        return _own_grid(self.source_shape, self.source_spacing, self.rotation)

    def _is_own_grid(self) -> bool:
        fine = self.fine()
        return fine.shape == self.shape and bool(np.allclose(fine.spacing, self.spacing, rtol=1e-9))

    def behind(self, depth: NDArray[np.float32]) -> NDArray[np.bool_]:
        """True where a voxel of the volume does not lie before the surface."""
        levels, grid = self._machines()
        return levels.mask(grid, depth)

    def surface(
        self,
        depth: NDArray[np.float32],
        directions: Sequence[float] | None = None,
        origin: Sequence[float] = (0.0, 0.0, 0.0),
    ) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """The depthmap as vertices and triangles, in mm from the centre of the volume's first voxel, or in the world
        that an image's directions and origin say."""
        levels, grid = self._machines(directions, origin)
        return levels.surface(grid, depth)

    def _machines(
        self, directions: Sequence[float] | None = None, origin: Sequence[float] = (0.0, 0.0, 0.0)
    ) -> tuple[Levels, Grid]:
        """A volume of this place with nothing in it, as the machine has it, and this camera's grid."""
        nothing = np.zeros(self.source_shape, np.uint8)
        levels = Levels(nothing, self.source_spacing, scanned="all", directions=directions, origin=origin)
        grid = levels.plan(self.rotation, self.shape[2])
        grid.view.n[:] = self.shape[::-1]
        return levels, grid

    def to_volume_mm(self, index: NDArray[np.float64]) -> NDArray[np.float64]:
        """Where indices (x, y, z) of the camera's grid lie in the volume, in mm from the centre of its first
        voxel."""
        return self.in_volume((index - _middle(self.shape)) * np.array(self.spacing))

    def from_volume_mm(self, place: NDArray[np.float64]) -> NDArray[np.float64]:
        """Where a place in the volume lies along the camera's axes, both in mm from the centre of their first voxel."""
        return np.asarray(self.from_middle(place) + _middle(self.shape) * np.array(self.spacing))

    def in_volume(self, seen: NDArray[np.float64]) -> NDArray[np.float64]:
        """Where what lies so many mm right, down and away from the middle is in the volume, in mm from the centre of
        its first voxel."""
        r = self.rotation
        turned = seen[..., :1] * r[0] + seen[..., 1:2] * r[1] + seen[..., 2:] * r[2]
        return np.asarray(turned + _middle(self.source_shape) * np.array(self.source_spacing))

    def from_middle(self, place: NDArray[np.float64]) -> NDArray[np.float64]:
        """The way back."""
        r, off = self.rotation, place - _middle(self.source_shape) * np.array(self.source_spacing)
        return np.asarray(off[..., :1] * r[:, 0] + off[..., 1:2] * r[:, 1] + off[..., 2:] * r[:, 2])


def _middle(shape: Shape) -> NDArray[np.float64]:
    return np.asarray((np.array(shape[::-1], float) - 1.0) / 2.0)


def between(depth: NDArray[Any], x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    """The map at any place, bilinear, as the renderer reads it; beyond its edge it continues."""
    height, width = depth.shape
    x, y = np.clip(x, 0, width - 1), np.clip(y, 0, height - 1)
    left, top = x.astype(int), y.astype(int)
    right, bottom = np.minimum(left + 1, width - 1), np.minimum(top + 1, height - 1)
    across, down = x - left, y - top
    values = np.asarray(depth, np.float64)
    above = values[top, left] + across * (values[top, right] - values[top, left])
    below = values[bottom, left] + across * (values[bottom, right] - values[bottom, left])
    return np.asarray(above + down * (below - above))


_MOST = 1024  # pixels across a map, for the host
_WIDEST = 2048  # voxels across, seen along any view


def on_square(camera: Camera, depth: NDArray[np.float32]) -> NDArray[np.float32]:
    """Depths in mm from the volume's front, on the square of the host's low-resolution volume."""
    size = np.array(camera.spacing) * camera.shape[::-1]
    side = float(max(size[:2]))
    count = min(max(math.ceil(side / min(camera.spacing[:2]) - 1e-6), 8), _MOST)
    mm = ((np.arange(count) + 0.5) / count - 0.5) * side
    x, y = (mm / camera.spacing[axis] + (camera.shape[2 - axis] - 1) / 2 for axis in (0, 1))
    across, down = np.meshgrid(x, y)
    found = between(depth, across, down)
    beside = (np.abs(mm) > size[0] / 2)[None, :] | (np.abs(mm) > size[1] / 2)[:, None]
    return np.where(beside | (found <= 0), 0, (found + 0.5) * camera.spacing[2]).astype(np.float32)


#: The camera's right, down and forward for places around the patient, along his left, back and head: as in host_sim.
_PLACES = {
    "anterior": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "posterior": ((-1, 0, 0), (0, 0, -1), (0, -1, 0)),
    "left": ((0, 1, 0), (0, 0, -1), (-1, 0, 0)),
    "right": ((0, -1, 0), (0, 0, -1), (1, 0, 0)),
    "superior": ((-1, 0, 0), (0, 1, 0), (0, 0, -1)),
    "inferior": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
}
PLACES = ("probe", *_PLACES)


def _from_place(view: str, directions: Any) -> NDArray[np.float64]:
    if view not in PLACES:
        raise ValueError(f"view='{view}' is none of {', '.join(PLACES)}")
    if view == "probe":
        return np.eye(3)
    if directions is None:
        raise ValueError(f"view='{view}': an array does not say how the patient lies; give a SimpleITK image")
    return _snapped(np.array(_PLACES[view], float) @ np.asarray(directions, float).reshape(3, 3))


def rotation_of(view: Any, directions: Any = None) -> NDArray[np.float64]:
    """A direction, a rotation matrix, a SciPy Rotation or a place around the patient as the camera's axes.

    A direction (x, y, z) is where the camera looks; from +z it is the smallest turn that leads there. The rows
    of a matrix are the picture's right, its down, and where the camera looks. `directions` are an image's: where its
    x, y and z lead in the patient (left, back, head), for the places (`PLACES`). Of left-handed ones a place is seen
    as it is, and not as a mirror image.

    >>> rotation_of((0, 0, 2)).tolist()
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    """
    if view is None:
        return np.eye(3)
    if isinstance(view, str):
        return _from_place(view, directions)
    if hasattr(view, "as_matrix"):
        view = np.asarray(view.as_matrix()).T
    view = np.asarray(view, float)
    if view.shape == (3,):
        return _snapped(_towards(view))
    if view.shape != (3, 3) or not np.allclose(view @ view.T, np.eye(3), atol=1e-6):
        raise ValueError(f"view={view.tolist()} is neither a direction (x, y, z) nor a rotation of 3 x 3 numbers")
    if np.linalg.det(view) < 0:
        raise ValueError(f"view={view.tolist()} is a mirror image: its determinant is -1")
    return _snapped(view)


def _snapped(rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    whole = np.round(rotation)
    return whole + 0.0 if np.allclose(rotation, whole, atol=1e-9) else rotation


def _towards(direction: NDArray[np.float64]) -> NDArray[np.float64]:
    length = float(np.linalg.norm(direction))
    if not np.isfinite(length) or length == 0.0:
        raise ValueError(f"view={direction.tolist()} is no direction")
    to = direction / length
    if to[2] < -1 + 1e-12:
        return np.diag([-1.0, 1.0, -1.0])  # from behind: half a turn about y
    axis = np.cross([0.0, 0.0, 1.0], to)
    skew = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.asarray((np.eye(3) + skew + skew @ skew / (1 + to[2])).T)


def look(shape: Shape, spacing: Vector, view: Any = None, directions: Any = None) -> Camera:
    """The camera for a volume on the volume's own grid; `directions` are those of a SimpleITK image. Of a turned view
    the voxels are cubes of the volume's smallest spacing, and the box is the smallest that holds the volume."""
    return _own_grid(shape, spacing, rotation_of(view, directions))


def _own_grid(shape: Shape, spacing: Vector, rotation: NDArray[np.float64]) -> Camera:
    camera = Camera(shape, spacing, rotation, shape, spacing)
    if camera.aligned:
        order, _ = camera._axes()
        seen = tuple(shape[i] for i in order)
        own = tuple(spacing[2 - i] for i in order)[::-1]
        return Camera(shape, spacing, rotation, seen, own)  # type: ignore[arg-type]
    size = np.abs(rotation) @ (np.array(shape[::-1]) * np.array(spacing))
    levels = Levels(np.zeros((1, 1, 1), np.uint8), (max(size[:2]), max(size[:2]), size[2]))
    across = math.ceil(max(size[:2]) / min(spacing) - 1e-6)
    if not 1 <= across <= _WIDEST:
        raise ValueError(f"seen along this view the volume has {across} voxels across; at most {_WIDEST} are possible")
    return on_grid(shape, spacing, levels.plan(np.eye(3), across), rotation)


def on_grid(shape: Shape, spacing: Vector, grid: Grid, rotation: NDArray[np.float64] | None = None) -> Camera:
    """The camera that sees a volume on the machine's grid."""
    slices, height, width = grid.shape
    own = (grid.box[0] / width, grid.box[0] / height, grid.box[1] / slices)
    return Camera(shape, spacing, grid.rotation if rotation is None else rotation, grid.shape, own)
