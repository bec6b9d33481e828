# SPDX-License-Identifier: MIT
"""A plugin that stays activated: volumes as the machine sees them go in, results come out."""

from __future__ import annotations

import ctypes
import weakref
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _door
from ._plugin import Plugin, blame, open_clipper
from ._result import Outcome, Result, Statistics
from ._seen import Grid, Levels
from ._view import Camera


def _array(address: int | None, of: Any, shape: tuple[int, int]) -> NDArray[Any]:
    """A copy of a map of the door's."""
    own: Any = (np.ctypeslib.as_ctypes_type(of) * (shape[0] * shape[1])).from_address(address)
    return np.frombuffer(own, of).reshape(shape).copy()


def told(view: Any, probe: NDArray[np.float64] | None, beams: Any) -> Any:
    """The view with what a caller says of the probe, and of its beams, along the camera's axes."""
    fan = beams is not None and beams != "parallel"
    apex, sweep = (tuple(map(float, beams[0])), float(beams[1])) if fan else ((0.0, 0.0, 0.0), 0.0)
    given = type(view).from_buffer_copy(view)
    given.beams = 2 if fan else 1 if beams else 0  # sv_frame.beams
    given.beam_apex_mm[:] = apex
    given.beam_sweep_mm = sweep
    axes = np.zeros(3) if probe is None else probe
    whole = axes.ndim == 2
    given.probe_rotation[:] = axes.ravel().tolist() if whole else [0.0] * 9
    given.probe_side[:] = (-axes[:, 2] if whole else axes).tolist()
    return given


class Active:
    """One at a time may use it. PluginError has the plugin's reason."""

    def __init__(self, plugin: Plugin) -> None:
        self._plugin = plugin
        self._handle = open_clipper(plugin.path, plugin.id)
        self.close = weakref.finalize(self, _door.free, "svh_clipper_free", self._handle)

    def reset(self, parameters: dict[str, object]) -> None:
        """These values from the next volume on, and the default for every other parameter."""
        _door.library().svh_reset(self._handle)
        for number, value in self._plugin.encode(parameters).items():
            _door.call("svh_set_number", self._handle, number, value)

    def needs(self, levels: Levels, grid: Grid) -> int:
        """Bytes that the plugin will take."""
        found = ctypes.c_uint64()
        self._call("svh_needs", levels.handle, ctypes.byref(grid.view), ctypes.byref(found))
        return found.value

    def clip(self, levels: Levels, grid: Grid, view: Any, frame: dict[str, Any], camera: Camera) -> Result:
        """Clips a volume. `view`: the grid's, or `told`; `frame`: fields of svh_frame."""
        given, out = _door.sized("svh_frame", **frame), _door.sized("svh_result")
        self._call("svh_clip", levels.handle, ctypes.byref(view), ctypes.byref(given), ctypes.byref(out))
        self._camera = camera
        self.reconstruct_ms: float = out.reconstruct_ms  #: by the plugin's clock, if it was asked for
        return self._result(out)

    def adjust(self, parameters: dict[str, object]) -> Result:
        """The last volume again with other values of adjustable parameters."""
        values = self._plugin.encode(parameters)
        ids = (ctypes.c_uint32 * len(values))(*values)
        numbers = (ctypes.c_double * len(values))(*values.values())
        out = _door.sized("svh_result")
        self._call("svh_adjust", ctypes.byref(ids), ctypes.byref(numbers), len(values), ctypes.byref(out))
        return self._result(out)

    def _call(self, name: str, *arguments: Any) -> None:
        try:
            _door.call(name, self._handle, *arguments)
        except _door.Failed as failed:
            raise blame(failed, {"svh_adjust": "adjust", "svh_needs": "needs"}.get(name, "end")) from None

    def _result(self, out: Any) -> Result:
        shape = (out.n[1], out.n[0])
        statistics = Statistics(rays=shape[0] * shape[1], points=out.points, unfilled=out.unfilled)
        if out.knows_fluid:
            statistics.fluid_threshold, statistics.open_rays = out.fluid_threshold, out.open_rays
        elif out.knows_points:
            statistics.bone_threshold, statistics.volume_max = out.bone_threshold, out.volume_max
            statistics.passes = out.passes
        return Result(
            depth=_array(out.depth, np.float32, shape),
            status=_array(out.status, np.uint8, shape),
            confidence=_array(out.confidence, np.float32, shape) if out.confidence else None,
            outcome=Outcome(out.outcome),
            statistics=statistics,
            camera=self._camera,
            why=out.why.decode("utf-8", "replace"),
            try_this=self._try_this(out),
        )

    def _try_this(self, out: Any) -> dict[str, str]:
        for key, p in self._plugin.parameters.items():
            if out.try_id and p.id == out.try_id:
                named = dict(zip(p.numbers, p.choices, strict=False))
                return {key: named.get(out.try_value, f"{out.try_value:g}")}
        return {}
