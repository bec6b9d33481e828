# SPDX-License-Identifier: MIT
"""clip(): one call for one volume. Clippers stay active behind it."""

from __future__ import annotations

import atexit
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
from ._view import Camera, look
from ._volume import fan, ranges, to_uint8


class ClipperCache:
    """Clippers by format and fixed parameters; the one that was not used for longest goes first. For many
    volumes of few formats. Any thread: calls are one after the other."""

    def __init__(self, most: int = 2, admit: Callable[[int], None] | None = None) -> None:
        self._most = most
        self._admit = admit
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
        discontinuity: bool = True,
        probe: Any = None,
    ) -> Result:
        """Clips `volume`; the result is the caller's."""
        known = plugin.parameters
        fixed = {k: v for k, v in parameters.items() if k in known and known[k].fixed}
        key = (plugin.path, plugin.id, volume.shape, spacing, scanned is not None, tuple(sorted(fixed.items())))
        with self._lock:
            clipper = self._clippers.pop(key, None)
            if clipper is None:
                while len(self._clippers) >= self._most:
                    self._clippers.popitem(last=False)[1].close()
                fixed_values: dict[str, Any] = fixed
                clipper = Clipper(
                    volume.shape, spacing, scanned=scanned is not None, plugin=plugin, admit=self._admit, **fixed_values
                )
            self._clippers[key] = clipper
            clipper.reset(**parameters)
            return clipper(volume, scanned, discontinuity=discontinuity, probe=probe).copy()

    def close(self) -> None:
        """Ends all instances."""
        with self._lock:
            while self._clippers:
                self._clippers.popitem()[1].close()


_cache = ClipperCache()
atexit.register(_cache.close)


def clip(
    volume: Any,
    spacing: Sequence[float] | None = None,
    *,
    view: Any = None,
    scanned: Any = None,
    probe: Any = None,
    method: str | None = None,
    window: tuple[float, float] | None = None,
    resample: str | None = None,
    plugin: Plugin | None = None,
    cache: ClipperCache | None = None,
    **parameters: object,
) -> Result:
    """Finds the clipping surface of one volume.

    `volume`
        an array [z, y, x]: x the fastest axis, slice 0 the nearest to the probe; uint8 as it is, other types
        as ``window`` says. Or a SimpleITK image, which brings its spacing.
    `spacing`
        mm between voxels along x, y, z. None: unknown, see SV_ASSUMED_EXTENT_MM in smartvis_plugin.h.
    `view`
        where the camera looks: a direction (x, y, z) in the volume's axes, a rotation matrix whose rows are the
        picture's right, its down and its depth, or a SciPy Rotation. None: along +z. Views that are not along
        an axis are resampled by ``resample``: "scipy" or "simpleitk".
    `scanned`
        what the probe scanned: None: everything; "auto": all but the zeros that touch the border (needs SciPy);
        "rays": on every ray all from the first voxel that is not 0 to the last, which is faster; a mask [z, y, x];
        or a pair of maps (first, end) [y, x] of slices.
    `probe`
        where the probe was: the rotation [3, 3] from its axes (z away from it) to the volume's x, y, z, so that the
        identity is a probe at slice 0; or three numbers, the unit vector to the probe alone. None: unknown.
    `method`, `parameters`
        those of the plugin, see `parameters()`.
    `window`
        values that become 0 and 255. None: uint8 as it is, other types from their own range.

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
    source, directions = volume, None
    if _images.is_image(volume):
        spacing = volume.GetSpacing() if spacing is None else spacing
        directions = volume.GetDirection()
        volume = _images.array(volume)
    volume = np.asarray(volume)
    if volume.ndim != 3 or 0 in volume.shape:
        raise ValueError(f"the volume has shape {volume.shape}, expected [z, y, x]")
    mm = None if spacing is None else _checked_spacing(spacing)
    voxels, mask = _what_was_scanned(to_uint8(volume, window), scanned)
    camera = look(voxels.shape, mm or (1.0, 1.0, 1.0), view, directions)
    seen, found = _seen(camera, voxels, mask, resample, plugin)
    known = None if mm is None else camera.spacing
    turned = None if probe is None else camera.rotation @ _checked_probe(probe)
    result = (cache or _cache).run(seen, known, found, plugin, parameters, probe=turned)
    return replace(result, camera=camera, spacing_known=mm is not None, source=source, window=window)


def _what_was_scanned(voxels: NDArray[np.uint8], scanned: Any) -> tuple[NDArray[np.uint8], NDArray[np.bool_] | None]:
    if scanned is None:
        return voxels, None
    if isinstance(scanned, str):
        if scanned not in ("auto", "rays"):
            raise ValueError(f"scanned='{scanned}', expected 'auto', 'rays', a mask or two maps")
        return fan(voxels) if scanned == "auto" else (voxels, voxels != 0)
    if isinstance(scanned, (tuple, list)) and len(scanned) == 2:
        first, end = (_finite(m) for m in scanned)
        if first.shape != voxels.shape[1:] or end.shape != voxels.shape[1:]:
            raise ValueError(f"scanned maps of {first.shape} and {end.shape}, expected {voxels.shape[1:]} [y, x]")
        z = np.arange(voxels.shape[0])[:, None, None]
        return voxels, (first <= z) & (z < end)
    mask = _finite(scanned)
    if mask.shape != voxels.shape:
        raise ValueError(f"scanned has shape {mask.shape}, the volume {voxels.shape}")
    return voxels, mask.astype(bool)


def _finite(values: Any) -> NDArray[Any]:
    """What was scanned, as an array; ValueError: some of it is no number, and would be nowhere without a word."""
    array = np.asarray(values)
    if array.dtype.kind == "f" and not np.isfinite(array).all():
        at = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        raise ValueError(f"scanned is {array[at]} at {list(at)}, expected finite numbers")
    return array


def _seen(
    camera: Camera, voxels: NDArray[np.uint8], mask: NDArray[np.bool_] | None, resample: str | None, plugin: Plugin
) -> tuple[NDArray[np.uint8], NDArray[np.uint16] | None]:
    """The volume and the scanned ranges as the camera sees them. A turned box has corners outside of the volume,
    which were not scanned either."""
    if mask is None and not camera.aligned:
        mask = np.ones(voxels.shape, bool)
    seen = np.ascontiguousarray(camera.see(voxels, resample))
    if mask is None:
        return seen, None
    if not plugin.features & _abi.SV_FEATURE_SCANNED:
        raise ValueError(f"{plugin.id} takes no scanned ranges")
    return seen, ranges(camera.see(mask.view(np.uint8), resample, nearest=True).view(np.bool_))
