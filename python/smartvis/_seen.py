# SPDX-License-Identifier: MIT
"""How the machine sees a volume: levels, what was scanned, and the grid on which a plugin sees it. It is the machine's
own code, a library, so that every door gives a plugin the same bytes."""

from __future__ import annotations

import ctypes
import os
import weakref
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _door
from ._words import in_python

SIDES = ("-z", "+z", "-y", "+y", "-x", "+x")  #: of a volume, at which the probe may be
_PADDING = {"auto": 0, "all": 1, "zeros": 2}


@dataclass
class Grid:
    """Where a camera's voxels lie: shape slices, height, width; `box` is mm across, and deep; `rotation` has the
    camera's right, down and forward as rows."""

    shape: tuple[int, int, int]
    box: tuple[float, float]
    rotation: NDArray[np.float64]
    probe: NDArray[np.float64] | None  #: the rotation from its axes to the camera's, if its side is known
    beams: Any  #: how they run, as a Clipper takes it
    view: Any


class Levels:
    """A volume as the machine takes it. `levels` are bytes [z, y, x]; 0 was not scanned."""

    def __init__(
        self,
        volume: NDArray[Any],
        spacing: Sequence[float] | None = None,
        *,
        scanned: str = "zeros",
        mask: NDArray[np.bool_] | None = None,
        window: tuple[float, float] | None = None,
        directions: Sequence[float] | None = None,
        side: str | None = None,
        apex: Sequence[float] | None = None,
        origin: Sequence[float] = (0.0, 0.0, 0.0),
        kretz: tuple[str, int, bool] | None = None,
    ) -> None:
        """`apex`: where the lines meet, mm from the volume's corner, if `side` is known. `origin`: where the centre of
        the first voxel lies, in mm of the world that `directions` lead in.
        `kretz`: what the volume is the Cartesian copy of, file, number and mirror: the machine sees that.
        ValueError: the volume cannot be taken, and why."""
        if volume.dtype.kind not in "uifb":
            raise ValueError(f"the volume holds {volume.dtype}, expected whole or floating-point numbers")
        if volume.ndim != 3 or 0 in volume.shape:
            raise ValueError(f"the volume has shape {volume.shape}, expected [z, y, x]")
        plain = volume.dtype == np.uint8
        voxels = np.ascontiguousarray(volume, np.uint8 if plain else np.float64)
        masked = None if mask is None else np.ascontiguousarray(mask, bool)
        v = _door.sized("svh_voxels", unsaid=spacing is None, scanned=_PADDING[scanned])
        v.n[:] = volume.shape[::-1]
        v.spacing[:] = spacing or (1.0, 1.0, 1.0)
        v.direction[:] = (0.0,) * 9 if directions is None else directions
        v.origin[:] = origin
        v.window[:] = window or (0.0, 0.0)
        v.probe, v.probe_said = (SIDES.index(side), 1) if side is not None else (0, 0)
        v.apex_said = side is not None and apex is not None
        v.apex[:] = apex if apex is not None else (0.0, 0.0, 0.0)
        setattr(v, "bytes" if plain else "values", _at(voxels))
        v.mask = None if masked is None else _at(masked)
        if kretz is not None:
            v.kretz, v.number, v.mirrored = os.fsencode(kretz[0]), kretz[1], int(kretz[2])
        self.handle = ctypes.c_void_p()
        _door.call("svh_volume_take", _door.host(), ctypes.byref(v), ctypes.byref(self.handle))
        weakref.finalize(self, _door.free, "svh_volume_free", self.handle)
        self._tell(volume.shape)

    def _tell(self, shape: tuple[int, ...]) -> None:
        """What is known of the volume."""
        about = _door.sized("svh_about")
        _door.call("svh_volume_about", self.handle, ctypes.byref(about))
        self._shape = shape
        self._address: int = about.levels
        self.has_beams = bool(about.has_beams)  #: it is seen in the probe's geometry: between rays' ends 0 may lie
        self.doubt: str = in_python(about.doubt.decode())  #: what is not plausible about the size, or ""
        self.low: float = about.low  #: the value that became 0, ...
        self.high: float = about.high  #: ... and that which became 255
        self.question: str = in_python(about.question.decode())  #: what to ask of where the probe was, or ""
        self.beams: str = about.beams.decode()  #: how they ran, and how sure that is
        self.fitted = bool(about.fitted)  #: the fan was fitted anew, and was none of a scan with the same outline
        self.outside: float | None = about.outside if about.has_outside else None  #: what lies outside the scan

    @property
    def levels(self) -> NDArray[np.uint8]:
        """Bytes [z, y, x]; 0 was not scanned."""
        count = int(np.prod(self._shape))
        own: Any = (ctypes.c_uint8 * count).from_address(self._address)
        own.of = self  # the memory is there as long as the array
        levels: NDArray[np.uint8] = np.frombuffer(own, np.uint8).reshape(self._shape)
        return levels

    def plan(
        self,
        rotation: NDArray[np.float64] | None = None,
        lowres: int = 0,
        around: bool = False,
        turn: tuple[float, float] = (0.0, 0.0),
    ) -> Grid:
        """The machine's grid for a camera (rows), None: from the probe, turned by yaw and pitch in degrees. `lowres`:
        pixels across, 0: its own. `around`: of a box that holds the volume from every direction."""
        view = _door.sized("svh_view", turned=rotation is not None, lowres=lowres, around=around)
        view.yaw, view.pitch = turn
        if rotation is not None:
            view.rotation[:] = rotation.T.ravel()
        _door.call("svh_plan", self.handle, ctypes.byref(view))
        width, height, slices = view.n
        probe = np.array(view.probe_rotation, np.float64).reshape(3, 3)
        rows = np.array(view.rotation).reshape(3, 3).T + 0.0
        beams = (None, "parallel", (tuple(view.beam_apex_mm), view.beam_sweep_mm))[view.beams]
        told = probe if probe.any() else None
        return Grid((slices, height, width), (view.box[0], view.box[1]), rows, told, beams, view)

    def look(self, grid: Grid) -> tuple[NDArray[np.uint8], NDArray[np.uint16]]:
        """The grid's voxels, and of every ray the first scanned slice and the first behind. DeviceError: OpenCL
        fails."""
        voxels = np.empty(grid.shape, np.uint8)
        ranges = np.empty((*grid.shape[1:], 2), np.uint16)
        _door.call("svh_convert", self.handle, ctypes.byref(grid.view), _at(voxels), _at(ranges))
        return voxels, ranges

    def mark(self, grid: Grid, marks: Sequence[tuple[Sequence[float], bool]], depth: NDArray[np.float32]) -> None:
        """Applies marks ((x, y, z, radius) in mm, keep) to the grid's depthmap."""
        array = (_door.STRUCTS["svh_mark"] * len(marks))()
        for own, (at, keep) in zip(array, marks, strict=True):
            own.place[:], own.radius, own.keep = at[:3], at[3], keep
        count = len(marks)
        _door.call("svh_mark_depth", self.handle, ctypes.byref(grid.view), ctypes.byref(array), count, _at(depth))

    def mask(self, grid: Grid, depth: NDArray[np.float32]) -> NDArray[np.bool_]:
        """True where a voxel does not lie before the grid's depthmap."""
        kept = np.empty(self._shape, np.uint8)
        own = np.ascontiguousarray(depth, np.float32)
        _door.call("svh_mask", self.handle, ctypes.byref(grid.view), _at(own), _at(kept))
        return kept.view(np.bool_)

    def surface(self, grid: Grid, depth: NDArray[np.float32]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Vertices in mm of the world, and triangles, whose front is towards the camera."""
        own = np.ascontiguousarray(depth, np.float32)
        mesh = _door.sized("svh_mesh")
        _door.call("svh_surface", self.handle, ctypes.byref(grid.view), _at(own), ctypes.byref(mesh))
        vertices = _copied(mesh.vertices, ctypes.c_float, mesh.vertex_count, np.float64)
        triangles = _copied(mesh.triangles, ctypes.c_int32, mesh.triangle_count, np.int64)
        _door.library().svh_mesh_free(ctypes.byref(mesh))
        return vertices, triangles


def _copied(address: int, kind: Any, count: int, into: Any) -> NDArray[Any]:
    """An array [count, 3] of C's numbers there."""
    if not count:
        return np.empty((0, 3), into)
    own: Any = (kind * (3 * count)).from_address(address)
    return np.frombuffer(own, kind).astype(into).reshape(-1, 3)


def look_bytes(shape: Sequence[int]) -> int:
    """Of a grid's voxels, and of ranges and maps with their copies, 32 a ray."""
    slices, height, width = shape
    return (slices + 32) * height * width


def _at(array: NDArray[Any]) -> int:
    """The address of an array's first byte. numpy's `ctypes` makes objects that only the collector frees."""
    return int(array.__array_interface__["data"][0])
