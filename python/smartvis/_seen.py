# SPDX-License-Identifier: MIT
"""How the machine sees a volume: levels, what was scanned, and the grid on which a plugin sees it. It is the machine's
own code, a library (host_sim/seen), so that every door gives a plugin the same bytes."""

from __future__ import annotations

import ctypes
import os
import threading
import weakref
from collections.abc import Sequence
from ctypes import POINTER, c_bool, c_char, c_double, c_float, c_int32, c_uint32, c_uint64, c_void_p
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _places, _runtime
from ._errors import DeviceError, LoadError
from ._words import in_python

SIDES = ("-z", "+z", "-y", "+y", "-x", "+x")  #: of a volume, at which the probe may be
_PADDING = {"auto": 0, "all": 1, "zeros": 2}
_lock = threading.Lock()  # the library serves one thread at a time


class _Volume(ctypes.Structure):
    _fields_ = [
        ("size", c_uint32),
        ("n", c_uint32 * 3),
        ("spacing", c_double * 3),
        ("unsaid", c_uint32),
        ("padding", c_uint32),
        ("direction", c_double * 9),
        ("probe", c_uint32),
        ("probe_said", c_uint32),
        ("apex_said", c_uint32),
        ("apex", c_double * 3),
        ("window", c_double * 2),
        ("bytes", c_void_p),
        ("values", c_void_p),
        ("mask", c_void_p),
        ("kretz", ctypes.c_char_p),
        ("number", c_uint32),
        ("mirrored", c_uint32),
        ("levels", c_void_p),
        ("low", c_double),
        ("high", c_double),
        ("outside", c_double),
        ("has_outside", c_uint32),
        ("doubt", c_char * 200),
        ("question", c_char * 160),
        ("beams", c_char * 160),
        ("has_beams", c_uint32),
        ("fitted", c_uint32),
        ("found", c_uint64 * 160),
    ]


class _View(ctypes.Structure):
    _fields_ = [
        ("size", c_uint32),
        ("turned", c_uint32),
        ("rotation", c_double * 9),
        ("lowres", c_uint32),
        ("n", c_uint32 * 3),
        ("box", c_double * 2),
        ("probe_rotation", c_float * 9),
        ("probe_side", c_float * 3),
        ("beams", c_uint32),
        ("beam_apex_mm", c_float * 3),
        ("beam_sweep_mm", c_float),
    ]


class _Mark(ctypes.Structure):
    _fields_ = [("place", c_double * 3), ("radius", c_double), ("keep", c_bool)]


@cache
def _library() -> Any:
    path = _places.find(f"smartvis_seen{_runtime.LIBRARY}")
    _runtime.use_one()
    try:
        library = ctypes.CDLL(str(path))
    except OSError as error:
        raise LoadError(f"{path}: {error}") from None
    library.hs_seen_error.restype = ctypes.c_char_p
    library.hs_seen_take.argtypes = [POINTER(_Volume)]
    library.hs_seen_drop.argtypes = [POINTER(_Volume)]
    library.hs_seen_plan.argtypes = [POINTER(_Volume), POINTER(_View)]
    library.hs_seen_look.argtypes = [POINTER(_Volume), POINTER(_View), c_void_p, c_void_p]
    library.hs_seen_reason.argtypes = [c_void_p, ctypes.c_char_p]
    library.hs_seen_mark.argtypes = [POINTER(_Volume), POINTER(_View), c_void_p, c_uint32, c_void_p]
    for name in ("take", "plan", "look", "mark", "reason"):
        getattr(library, f"hs_seen_{name}").restype = c_int32
    return library


def _call(name: str, *arguments: Any) -> None:
    _runtime.check_process()
    with _lock:
        library = _library()
        if not getattr(library, f"hs_seen_{name}")(*arguments):
            reason = library.hs_seen_error().decode("utf-8", "replace")
            raise DeviceError(reason + _runtime.cure(reason)) if name == "look" else ValueError(reason)


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
        kretz: tuple[str, int, bool] | None = None,
    ) -> None:
        """`apex`: where the lines meet, mm from the volume's corner, if `side` is known.
        `kretz`: what the volume is the Cartesian copy of, file, number and mirror: the machine sees that.
        ValueError: the volume cannot be taken, and why."""
        if volume.dtype.kind not in "uifb":
            raise ValueError(f"the volume holds {volume.dtype}, expected whole or floating-point numbers")
        if volume.ndim != 3 or 0 in volume.shape:
            raise ValueError(f"the volume has shape {volume.shape}, expected [z, y, x]")
        plain = volume.dtype == np.uint8
        self._voxels = np.ascontiguousarray(volume, np.uint8 if plain else np.float64)
        self._mask = None if mask is None else np.ascontiguousarray(mask, bool)
        self.levels: NDArray[np.uint8] = np.empty(volume.shape, np.uint8)
        v = self._volume = _Volume(size=ctypes.sizeof(_Volume), unsaid=spacing is None, padding=_PADDING[scanned])
        v.n[:] = volume.shape[::-1]
        v.spacing[:] = spacing or (1.0, 1.0, 1.0)
        v.direction[:] = np.eye(3).ravel() if directions is None else directions
        v.window[:] = window or (0.0, 0.0)
        v.probe, v.probe_said = (SIDES.index(side), 1) if side is not None else (0, 0)
        v.apex_said = side is not None and apex is not None
        v.apex[:] = apex if apex is not None else (0.0, 0.0, 0.0)
        setattr(v, "bytes" if plain else "values", _at(self._voxels))
        v.mask = None if self._mask is None else _at(self._mask)
        v.levels = _at(self.levels)
        if kretz is not None:
            v.kretz, v.number, v.mirrored = os.fsencode(kretz[0]), kretz[1], int(kretz[2])
        _call("take", ctypes.byref(v))
        weakref.finalize(self, _library().hs_seen_drop, v)
        self.has_beams = bool(v.has_beams)  #: it is seen in the probe's geometry: between rays' ends 0 may lie
        self._voxels = self._mask = None  # type: ignore[assignment]  # only the levels are read from here on
        v.bytes = v.values = v.mask = v.kretz = None
        self.doubt: str = in_python(v.doubt.decode())  #: what is not plausible about the size, or ""
        self.low: float = v.low  #: the value that became 0, ...
        self.high: float = v.high  #: ... and that which became 255
        self.question: str = in_python(v.question.decode())  #: what to ask of where the probe was, or ""
        self.beams: str = v.beams.decode()  #: how they ran, and how sure that is
        self.fitted = bool(v.fitted)  #: the fan was fitted anew, and was none of a scan with the same outline
        self.outside: float | None = v.outside if v.has_outside else None  #: what lies outside the scan

    def plan(self, rotation: NDArray[np.float64] | None = None, lowres: int = 0) -> Grid:
        """The machine's grid for a camera (rows), None: from the probe. `lowres`: pixels across, 0: its own."""
        view = _View(size=ctypes.sizeof(_View), turned=rotation is not None, lowres=lowres)
        if rotation is not None:
            view.rotation[:] = rotation.T.ravel()
        _call("plan", ctypes.byref(self._volume), ctypes.byref(view))
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
        _call("look", ctypes.byref(self._volume), ctypes.byref(grid.view), _at(voxels), _at(ranges))
        return voxels, ranges

    def mark(self, grid: Grid, marks: Sequence[tuple[Sequence[float], bool]], depth: NDArray[np.float32]) -> None:
        """Applies marks ((x, y, z, radius) in mm, keep) to the grid's depthmap."""
        array = (_Mark * len(marks))(*[_Mark((c_double * 3)(*at[:3]), at[3], keep) for at, keep in marks])
        _call("mark", ctypes.byref(self._volume), ctypes.byref(grid.view), array, len(marks), _at(depth))


def look_bytes(shape: Sequence[int]) -> int:
    """Of a grid's voxels, and of ranges and maps with their copies, 32 a ray."""
    slices, height, width = shape
    return (slices + 32) * height * width


def words_of(report: Any) -> str:
    """A plugin's reason in words for who holds the probe; "" if it has none."""
    out = ctypes.create_string_buffer(320)
    return out.value.decode() if _library().hs_seen_reason(ctypes.byref(report), out) else ""


def _at(array: NDArray[Any]) -> int:
    """The address of an array's first byte. numpy's `ctypes` makes objects that only the collector frees."""
    return int(array.__array_interface__["data"][0])
