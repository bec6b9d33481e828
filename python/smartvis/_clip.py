# SPDX-License-Identifier: MIT
"""Clipper: volume after volume as the machine sees them; clip() is one that is used once. Plugins stay active behind
both."""

from __future__ import annotations

import atexit
import threading
from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from . import _door
from ._active import Active, told
from ._plugin import Plugin, load
from ._result import Result
from ._seen import SIDES, Grid, Levels, look_bytes
from ._view import Camera, Shape, on_grid, rotation_of
from ._volume import (
    Given,
    checked_buffer,
    checked_probe,
    checked_shape,
    checked_spacing,
    checked_window,
    given,
    question_of_axes,
    what_was_scanned,
)

_Marks = list[tuple[tuple[float, ...], bool]]


class ClipperCache:
    """Activated plugins by format and fixed parameters; the one that was not used for longest goes first. For many
    volumes of few formats. Any thread: calls are one after the other. `admit` is told bytes before they are taken, and
    may raise: those of a look (0 needed), and with them later those that the plugin's instance needs."""

    def __init__(self, most: int = 2, admit: Callable[[int, int], None] = lambda look, needed: None) -> None:
        self._most = most
        self.admit = admit
        self._ended = 0
        self._lock = threading.Lock()
        self._instances: OrderedDict[Any, Active] = OrderedDict()

    def run(
        self,
        levels: Levels,
        grid: Grid,
        camera: Camera,
        plugin: Plugin,
        parameters: dict[str, object],
        *,
        view: Any,
        frame: dict[str, Any],
    ) -> Result:
        """Clips a volume on a grid of it; the result is the caller's. The rest is that of `Active.clip`."""
        known = plugin.parameters
        fixed = {k: v for k, v in parameters.items() if k in known and known[k].fixed}
        key = (plugin.path, plugin.id, grid.shape, grid.box, levels.has_beams, tuple(sorted(fixed.items())))
        with self._lock:
            instance = self._instances.pop(key, None)
            if instance is None:
                self._make_room()
                instance = Active(plugin)
                instance.reset(parameters)
                self.admit(look_bytes(grid.shape), instance.needs(levels, grid))
            self._instances[key] = instance
            instance.reset(parameters)
            return instance.clip(levels, grid, view, frame, camera)

    def _make_room(self) -> None:
        """For one more. Now and then all end: only then the machine's device can rest, until which the runtime keeps a
        part of every instance that was."""
        self._ended += len(self._instances) >= self._most
        most = 1 if self._ended and self._ended % _door.library().svh_rests_after() == 0 else self._most
        while len(self._instances) >= most:
            self._instances.popitem(last=False)[1].close()

    def adjust(self, parameters: dict[str, object]) -> Result:
        """The volume that was clipped last, with other values of adjustable parameters; the result is the caller's."""
        with self._lock:
            return next(reversed(self._instances.values())).adjust(parameters)

    def close(self) -> None:
        """Ends all instances."""
        with self._lock:
            while self._instances:
                self._instances.popitem()[1].close()


def _marks(given: Sequence[Sequence[float]], keep: bool) -> _Marks:
    """A mark's three or four numbers, each with its kind."""
    kind = "keep" if keep else "remove"
    try:
        marks = [(*map(float, mark), 5.0)[: max(4, len(mark))] for mark in given]
    except (TypeError, ValueError):
        raise ValueError(f"{kind}={given!r}, expected a list of (x, y, z) or (x, y, z, radius) in mm") from None
    for mark in marks:
        if len(mark) != 4 or not np.isfinite(mark).all() or mark[3] <= 0:
            raise ValueError(f"{kind}={mark}, expected (x, y, z) or (x, y, z, radius above 0) in mm")
    return [(mark, keep) for mark in marks]


def _checked_lowres(lowres: Any) -> int:
    """ValueError: it is no number of pixels; the largest the machine knows."""
    if isinstance(lowres, (int, np.integer)) and lowres >= 0:
        return int(lowres)
    raise ValueError(f"lowres={lowres!r}, expected a whole number of pixels; 0: of 1 mm")


def _checked_side(probe: Any) -> Any:
    """ValueError: it was given as a volume's side, and none has this name."""
    if isinstance(probe, str) and probe not in SIDES:
        raise ValueError(f"probe='{probe}' is none of {', '.join(SIDES)}")
    return probe


def _only_itself(path: str, spacing: Any, scanned: Any, probe: Any, window: Any) -> None:
    """ValueError, as the host's, for what a Kretz file says itself."""
    given = {"spacing": spacing, "scanned": None if isinstance(scanned, str) else scanned}
    given |= {"probe": probe, "window": window}
    for name, value in given.items():
        if value is not None:
            raise ValueError(f"{path}: a Kretz file says its size, scan, probe and levels itself; {name}= was given")


_cache = ClipperCache()
atexit.register(_cache.close)


@dataclass(frozen=True)
class _Look:
    """How the machine saw a volume."""

    of: Given
    levels: Levels
    grid: Grid
    camera: Camera
    known: bool  #: its spacing
    beams: str  #: how they ran, and how sure that is; "" if the probe's axes were given


class Clipper:
    """Clips volume after volume of one shape, each as `clip` does; the plugin stays activated between them.

    >>> with Clipper((32, 24, 16), spacing=(1, 1, 1)) as clipper:
    ...     result = clipper(np.zeros((32, 24, 16), np.uint8))
    >>> result.outcome
    <Outcome.NO_SURFACE: 1>

    Any thread may call it: calls are one after the other, and a result is the caller's own.
    """

    def __init__(
        self,
        shape: Sequence[int],
        spacing: Sequence[float] | None = None,
        *,
        view: Any = None,
        scanned: Any = "auto",
        padding: float | None = None,
        probe: Any = None,
        beams: Any = None,
        method: str | None = None,
        window: tuple[float, float] | None = None,
        lowres: int = 0,
        keep: Sequence[Sequence[float]] = (),
        remove: Sequence[Sequence[float]] = (),
        buffer: NDArray[np.uint8] | bool = False,
        plugin: Plugin | None = None,
        cache: ClipperCache | None = None,
        **parameters: object,
    ) -> None:
        """`shape`: slices, height, width. `padding`: what was not scanned has this value, instead of `scanned`.
        `buffer`: True: `self.buffer` is an array for volumes, or an array of uint8 of yours. `beams`: how they run,
        with the rotation of `probe`: "parallel", or a fan: its apex (x, y, z, mm from the centre of voxel (0, 0, 0)),
        and mm from there to the sweep's axis. The rest is `clip`'s.

        ValueError: an unknown parameter, an impossible shape. The plugin is activated by the first volume, of whose
        scan its grid depends.
        """
        self._plugin = plugin or load()
        self._shape = checked_shape(shape)
        self._spacing = None if spacing is None else checked_spacing(spacing)
        self._view, self._scanned, self._padding = view, scanned, padding
        self._probe, self._beams = _checked_side(probe), beams
        self._window = checked_window(window)
        self._lowres = _checked_lowres(lowres)
        self._marks = _marks(remove, False) + _marks(keep, True)
        self._buffer = np.zeros(self._shape, np.uint8) if buffer is True else checked_buffer(buffer)
        self._parameters = ({} if method is None else {"method": method}) | parameters
        self._plugin.encode(self._parameters)
        self._own_cache = cache is None
        self._cache = ClipperCache(most=1) if cache is None else cache
        self._lock = threading.Lock()
        self._last: _Look | None = None
        self._closed = False

    def __call__(
        self,
        volume: Any,
        scanned: Any = None,
        *,
        view: Any = None,
        probe: Any = None,
        beams: Any = None,
        time_ns: int = 0,
        discontinuity: bool = True,
        same_volume: bool = False,
    ) -> Result:
        """Clips one volume: an array, a SimpleITK image or a file's name. `scanned`, `view`, `probe` and `beams` stand
        instead of the clipper's own. `time_ns`: when it was acquired, 0: unknown. `discontinuity`: False: it continues
        the volume before, as those of a probe that is held on, and what that taught still holds. `same_volume`: it is
        the one before, by another camera or with other values."""
        of = given(volume)
        if of.voxels.shape != self._shape:
            raise ValueError(f"the volume has shape {of.voxels.shape}, expected {self._shape}")
        flag = "SVH_SAME_VOLUME" if same_volume else "" if discontinuity else "SVH_CONTINUES"
        frame = {"time_ns": time_ns, "flags": _door.NUMBERS.get(flag, 0)}
        stated = self._probe if probe is None else probe
        probe = of.said.side if stated is None else _checked_side(stated)
        with self._lock:
            self._check_open()
            look = self._look(of, scanned, self._view if view is None else view, probe)
            self._cache.admit(look_bytes(look.grid.shape), 0)
            view = self._told(look, probe, self._beams if beams is None else beams)
            how = {"view": view, "frame": frame}
            parameters = dict(self._parameters)
            return self._finish(
                look, self._cache.run(look.levels, look.grid, look.camera, self._plugin, parameters, **how)
            )

    def adjust(self, **parameters: object) -> Result:
        """The last volume again with other values of adjustable parameters, such as the surface position."""
        with self._lock:
            self._check_open()
            if self._last is None:
                raise ValueError("there is no volume to adjust yet")
            return self._finish(self._last, self._cache.adjust(parameters))

    def set(self, **parameters: object) -> None:
        """Other values from the next volume on."""
        self._plugin.encode(parameters)
        self._parameters = self._parameters | parameters

    def reset(self, **parameters: object) -> None:
        """These values from the next volume on, and the default for every other parameter."""
        self._plugin.encode(parameters)
        self._parameters = dict(parameters)

    def close(self) -> None:
        """Ends the plugin's instance. A closed clipper refuses every call; its results stay."""
        with self._lock:
            self._closed, self._last = True, None
            if self._own_cache:
                self._cache.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def shape(self) -> Shape:
        """Slices, height, width."""
        return self._shape

    @property
    def buffer(self) -> NDArray[np.uint8]:
        """The array for volumes; ValueError if the clipper was made without."""
        if self._buffer is None:
            raise ValueError("there is no buffer: make the clipper with buffer=True, or with an array")
        return self._buffer

    # -------------------------------------------------------------------------------------------- details

    def _check_open(self) -> None:
        if self._closed:
            raise ValueError("the clipper is closed")

    def _look(self, of: Given, scanned: Any, view: Any, probe: Any) -> _Look:
        if scanned is None:
            scanned = self._scanned if self._padding is None else of.voxels != self._padding
        if of.kretz is not None:
            _only_itself(of.kretz[0], self._spacing, scanned, probe, self._window)
        how, mask = what_was_scanned(self._shape, scanned)
        if of.mask is not None:
            mask = of.mask if mask is None else mask & of.mask
        spacing = of.spacing if self._spacing is None else self._spacing
        levels = Levels(
            of.voxels,
            spacing,
            scanned=how,
            mask=mask,
            window=self._window,
            directions=of.directions,
            side=probe if isinstance(probe, str) else None,
            apex=of.said.apex if isinstance(probe, str) and probe == of.said.side else None,
            kretz=of.kretz,
        )
        from_probe = view is None or (isinstance(view, str) and view == "probe")
        grid = levels.plan(None if from_probe else rotation_of(view, of.directions), self._lowres)
        camera = on_grid(self._shape, spacing or (1.0, 1.0, 1.0), grid)
        beams = levels.beams if probe is None or isinstance(probe, str) else ""
        return _Look(of, levels, grid, camera, spacing is not None, beams)

    def _told(self, look: _Look, probe: Any, beams: Any) -> Any:
        """The view with what the caller says of the probe and its beams, along the camera's axes."""
        measured = probe is not None and not isinstance(probe, str)
        if not measured and beams is None:
            return look.grid.view
        axes = look.camera.rotation @ checked_probe(probe) if measured else look.grid.probe
        if beams is not None and not isinstance(beams, str):
            apex, sweep = _checked_fan(beams)
            beams = (tuple(look.camera.from_volume_mm(apex)), sweep)
        elif beams not in (None, "parallel"):
            raise ValueError(f"beams='{beams}', expected 'parallel', or a fan's (apex, sweep)")
        return told(look.grid.view, axes, beams)

    def _finish(self, look: _Look, result: Result) -> Result:
        self._last = look
        levels = look.levels
        if result.clips and self._marks:
            levels.mark(look.grid, self._marks, result.depth)
        why, doubt = result.why, result.doubt
        if levels.doubt:  # of a size that no scan has nothing else is the reason
            why, doubt = levels.doubt if look.known and not result.clips else why, levels.doubt
        doubt = " ".join(filter(None, (doubt, levels.question, look.of.said.told, question_of_axes(look.of.voxels))))
        known = {"camera": look.camera, "spacing_known": look.known, "source": look.of.source, "window": self._window}
        return replace(result, why=why, doubt=doubt, beams=look.beams, **known)


def _checked_fan(beams: Any) -> tuple[NDArray[np.float64], float]:
    """The apex, and mm from there to the sweep's axis; ValueError: it is neither."""
    try:
        apex, sweep = np.array(beams[0], np.float64), float(beams[1])
    except (TypeError, ValueError, IndexError):
        apex, sweep = np.empty(0), 0.0
    if apex.shape != (3,) or not np.isfinite(apex).all() or not np.isfinite(sweep):
        raise ValueError(f"beams={beams}, expected 'parallel', or a fan's ((x, y, z), mm to the sweep's axis)")
    return apex, sweep


def clip(
    volume: Any,
    spacing: Sequence[float] | None = None,
    *,
    view: Any = None,
    scanned: Any = "auto",
    probe: Any = None,
    beams: Any = None,
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
    `beams`
        how they run, with the rotation of `probe`: "parallel", or a fan: its apex (x, y, z, mm from the centre of voxel
        (0, 0, 0)), and mm from there to the sweep's axis. None: as the outline of the scan shows.
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
    how: dict[str, Any] = {"view": view, "scanned": scanned, "probe": probe, "beams": beams, "method": method}
    how |= {"window": window, "lowres": lowres, "keep": keep, "remove": remove, "plugin": plugin}
    of = given(volume)
    with Clipper(of.voxels.shape, spacing, cache=cache or _cache, **(how | parameters)) as clipper:
        return clipper(of)
