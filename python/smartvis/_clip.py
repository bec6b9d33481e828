# SPDX-License-Identifier: MIT
"""clip(): one call for one volume. Clippers stay active behind it."""

from __future__ import annotations

import atexit
import os
import threading
from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _abi, _images
from ._clipper import Clipper, _checked_probe, _checked_spacing
from ._plugin import Plugin, load
from ._result import Result
from ._seen import SIDES, Levels, look_bytes
from ._view import on_grid, rotation_of
from ._volume import checked_window, what_was_scanned


class ClipperCache:
    """Clippers by format and fixed parameters; the one that was not used for longest goes first. For many
    volumes of few formats. Any thread: calls are one after the other. `admit` is told bytes before they are taken, and
    may raise: those of a look (0 needed), and with them later those that the plugin's instance needs."""

    def __init__(self, most: int = 2, admit: Callable[[int, int], None] = lambda look, needed: None) -> None:
        self._most = most
        self.admit = admit
        self._lock = threading.Lock()
        self._clippers: OrderedDict[Any, Clipper] = OrderedDict()

    def run(
        self,
        volume: NDArray[np.uint8],
        spacing: tuple[float, float, float] | None,
        scanned: NDArray[np.uint16] | None,
        plugin: Plugin,
        parameters: dict[str, object],
        *,
        gaps: bool = False,
        discontinuity: bool = True,
        probe: Any = None,
        beams: Any = None,
    ) -> Result:
        """Clips `volume`; the result is the caller's. `gaps`: between the ends of `scanned`, 0 was not scanned."""
        known = plugin.parameters
        fixed = {k: v for k, v in parameters.items() if k in known and known[k].fixed}
        key = (plugin.path, plugin.id, volume.shape, spacing, scanned is not None, gaps, tuple(sorted(fixed.items())))
        look = look_bytes(volume.shape)
        with self._lock:
            clipper = self._clippers.pop(key, None)
            if clipper is None:
                while len(self._clippers) >= self._most:
                    self._clippers.popitem(last=False)[1].close()
                how: dict[str, Any] = {"scanned": scanned is not None, "plugin": plugin} | fixed
                how["padding"] = 0 if gaps or scanned is None else None  # the machine's 0 was not scanned
                clipper = Clipper(volume.shape, spacing, admit=lambda needed: self.admit(look, needed), **how)
            self._clippers[key] = clipper
            clipper.reset(**parameters)
            return clipper(volume, scanned, discontinuity=discontinuity, probe=probe, beams=beams).copy()

    def close(self) -> None:
        """Ends all instances."""
        with self._lock:
            while self._clippers:
                self._clippers.popitem()[1].close()


def _marks(given: Sequence[Sequence[float]], keep: bool) -> list[tuple[tuple[float, ...], bool]]:
    """A mark's three or four numbers, each with its kind."""
    marks = [(*map(float, mark), 5.0)[: max(4, len(mark))] for mark in given]
    for mark in marks:
        if len(mark) != 4 or not np.isfinite(mark).all() or mark[3] <= 0:
            kind = "keep" if keep else "remove"
            raise ValueError(f"{kind}={mark}, expected (x, y, z) or (x, y, z, radius above 0) in mm")
    return [(mark, keep) for mark in marks]


def _side(probe: Any) -> str | None:
    """The volume's side, if it was given as one; ValueError: it has none of this name."""
    if isinstance(probe, str) and probe not in SIDES:
        raise ValueError(f"probe='{probe}' is none of {', '.join(SIDES)}")
    return probe if isinstance(probe, str) else None


def _only_itself(path: str, spacing: Any, scanned: Any, probe: Any, window: Any) -> None:
    """ValueError, as the host's, for what a Kretz file says itself."""
    given = {"spacing": spacing, "scanned": None if isinstance(scanned, str) else scanned}
    given |= {"probe": probe, "window": window}
    for name, value in given.items():
        if value is not None:
            raise ValueError(f"{path}: a Kretz file says its size, scan, probe and levels itself; {name}= was given")


_cache = ClipperCache()
atexit.register(_cache.close)


def clip(
    volume: Any,
    spacing: Sequence[float] | None = None,
    *,
    view: Any = None,
    scanned: Any = "auto",
    probe: Any = None,
    method: str | None = None,
    window: tuple[float, float] | None = None,
    lowres: int = 0,
    keep: Sequence[Sequence[float]] = (),
    remove: Sequence[Sequence[float]] = (),
    plugin: Plugin | None = None,
    cache: ClipperCache | None = None,
    **parameters: object,
) -> Result:
    """Finds the clipping surface of one volume.

    `volume`
        an array [z, y, x]: x the fastest axis, slice 0 the nearest to the probe; uint8 as it is, other types
        as ``window`` says. NaN and what a numpy mask hides was not scanned. Or a SimpleITK image, which brings its
        spacing; or a file's name, as `smartvis clip` reads it.
    `spacing`
        mm between voxels along x, y, z. None: unknown, see SV_ASSUMED_EXTENT_MM in smartvis_plugin.h.
    `view`
        where the camera looks: a direction (x, y, z) in the volume's axes, a rotation matrix whose rows are the
        picture's right, its down and its depth, or a SciPy Rotation. None: from the probe's side.
    `scanned`
        what the probe scanned: "auto": all but the zeros, or the other constant, that lie outside a fan; "zeros": all
        but zeros; "all": everything; a mask [z, y, x]; or a pair of maps (first, end) [y, x] of slices.
    `probe`
        where the probe was: "-z" (slice 0), "+z", "-y", "+y", "-x" or "+x"; the rotation [3, 3] from its axes (z away
        from it) to the volume's x, y, z; or three numbers, the unit vector to the probe alone. None: unknown.
    `method`, `parameters`
        those of the plugin, see `parameters()`.
    `window`
        values that become 0 and 255. None: uint8 as it is, other types from the range of what was scanned.
    `keep`, `remove`
        a user's marks, each (x, y, z) or (x, y, z, radius) in mm from the centre of voxel (0, 0, 0); radius 5. They
        change a surface that there is: remove takes away what is seen at the mark, down to the next tissue behind
        fluid, and then keep brings back what was cut there.
    `lowres`
        pixels across the grid on which the plugin sees the volume. 0: of 1 mm, as `host_sim run` has it, no finer than
        the volume and no coarser than three of its voxels.

    PluginError has the plugin's reason, ValueError names what does not fit.

    >>> volume = np.full((64, 48, 48), 200, np.uint8)
    >>> volume[:40] = 10
    >>> volume[:12] = 100
    >>> result = clip(volume, spacing=(1, 1, 1))
    >>> result.clips, bool(12 <= result.depth[24, 24] <= 40)
    (True, True)
    >>> int(result.apply(volume)[5, 24, 24]), int(result.apply(volume)[50, 24, 24])
    (0, 200)
    """
    plugin = plugin or load()
    if method is not None:
        parameters["method"] = method
    if isinstance(volume, (str, os.PathLike)):
        from ._files import Source

        volume = Source(volume).only()
    source, directions, mask, kretz = volume, None, None, None
    if _images.is_image(volume):
        kretz = _images.kretz(volume)
        if kretz is not None:
            _only_itself(kretz[0], spacing, scanned, probe, window)
        probe = _images.probe(volume) if probe is None else probe
        spacing = volume.GetSpacing() if spacing is None and _images.says_spacing(volume) else spacing
        directions = volume.GetDirection()
        volume = _images.array(volume)
    if isinstance(volume, np.ma.MaskedArray):
        mask = ~np.ma.getmaskarray(volume) if np.ma.is_masked(volume) else None
        volume = volume.filled(volume.max())  # which is nowhere taken for what lies outside
    marks = _marks(remove, False) + _marks(keep, True)
    volume = np.asarray(volume)
    if volume.ndim != 3 or 0 in volume.shape:
        raise ValueError(f"the volume has shape {volume.shape}, expected [z, y, x]")
    mm = None if spacing is None else _checked_spacing(spacing)
    how, given = what_was_scanned(volume.shape, scanned)
    if mask is not None:
        given = mask if given is None else mask & given
    side = _side(probe)
    levels = Levels(
        volume,
        mm,
        scanned=how,
        mask=given,
        window=checked_window(window),
        directions=directions,
        side=side,
        kretz=kretz,
    )
    turned = None if view is None or (isinstance(view, str) and view == "probe") else rotation_of(view, directions)
    grid = levels.plan(turned, lowres)
    camera = on_grid(volume.shape, mm or (1.0, 1.0, 1.0), grid)
    cache = cache or _cache
    cache.admit(look_bytes(grid.shape), 0)
    seen, ranges = levels.look(grid)
    given_probe = probe is not None and side is None
    told = camera.rotation @ _checked_probe(probe) if given_probe else grid.probe
    beams = None if given_probe else grid.beams
    takes = bool(plugin.features & _abi.SV_FEATURE_SCANNED)
    known = None if mm is None else camera.spacing
    gaps = takes and levels.has_beams
    result = cache.run(seen, known, ranges if takes else None, plugin, parameters, gaps=gaps, probe=told, beams=beams)
    if result.clips and marks:
        levels.mark(grid, marks, result.depth)
    if levels.doubt:  # of a size that no scan has nothing else is the reason
        why = levels.doubt if mm is not None and not result.clips else result.why
        result = replace(result, why=why, doubt=levels.doubt)
    if levels.question:
        result = replace(result, doubt=f"{result.doubt} {levels.question}".strip())
    return replace(result, camera=camera, spacing_known=mm is not None, source=source, window=window)
