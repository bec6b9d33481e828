# SPDX-License-Identifier: MIT
"""One activated plugin: it takes voxels as they lie on its grid. What makes them of a volume is `_clip`."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from . import _abi
from ._errors import PluginError
from ._plugin import Plugin, load, log
from ._result import Outcome, Result, Statistics
from ._seen import _at, words_of
from ._view import Shape, look
from ._volume import checked_spacing

_FARTHEST = 2.0  # volumes: a depth beyond it is none (the host's rule, host_sim/loop/confidence_map.h)


class Instance:
    """A plugin that is activated once; a frame allocates nothing.

    Frames are uint8 arrays [z, y, x], C-contiguous (others are copied first). They are handed over as they
    lie in memory; with ``buffer`` the plugin also reads them in place, where its device can.

    A call returns the instance's own `result`, whose maps the next call overwrites: ``result.copy()`` keeps
    one. An instance serves one thread at a time; while the plugin works, other threads of Python run.
    """

    def __init__(
        self,
        shape: Sequence[int],
        spacing: Sequence[float] | None = None,
        *,
        scanned: bool = False,
        padding: int | None = None,
        buffer: NDArray[np.uint8] | bool = False,
        confidence: bool = True,
        plugin: Plugin | None = None,
        admit: Callable[[int], None] | None = None,
        **parameters: object,
    ) -> None:
        """`shape`: slices, height, width. `spacing`: mm along x, y, z; None: unknown. `scanned`: every call
        brings the scanned ranges. `padding`: this grey value was not scanned. `buffer`: True: volumes lie in
        the array `self.buffer`, or an array of uint8 of yours in which they will lie. `admit` is told the bytes
        that the plugin says it needs, before it takes them, and may raise. `parameters`: those of
        the plugin by key; the rest keep their defaults.

        PluginError: the plugin refuses, with its reason. ValueError: an unknown parameter, an impossible shape.
        """
        self._plugin = plugin or load()
        self._instance: Any = None
        self._shape = checked_shape(shape)
        self._bytes = int(np.prod(self._shape))
        if not self._plugin.queues & _abi.SV_QUEUE_OWN:
            raise PluginError("activate", _abi.SV_ERR_FORMAT, f"{self._plugin.id} needs the host's OpenCL queue")
        self._buffer = np.zeros(self._shape, np.uint8) if buffer is True else checked_buffer(buffer)
        self._ids = self._plugin.encode(parameters)
        self._values = _value_list(self._ids)
        self._make_result(None if spacing is None else checked_spacing(spacing))
        self._instance = self._plugin.create()
        self._calls = self._instance.contents
        self._frame_index = 0
        try:
            made = self._format(scanned, padding)
            if admit is not None:
                admit(self._needed(made))
            self._check("activate", self._calls.activate(self._instance, ctypes.byref(made)))
        except BaseException:
            self._calls.destroy(self._instance)
            self._instance = None
            raise
        self._extensions(confidence)
        self._structs()

    # ------------------------------------------------------------------------------------ what it is made of

    def _make_result(self, spacing: tuple[float, float, float] | None) -> None:
        _, height, width = self._shape
        self._spacing = spacing
        self._stats = _abi.sized(_abi.sv_stats)
        camera = look(self._shape, spacing or (1.0, 1.0, 1.0))
        self.result = Result(
            depth=np.zeros((height, width), np.float32),
            status=np.zeros((height, width), np.uint8),
            confidence=None,
            outcome=Outcome.NO_SURFACE,
            statistics=Statistics(rays=height * width),
            camera=camera,
            spacing_known=spacing is not None,
        )

    def _format(self, scanned: bool, padding: int | None) -> Any:
        slices, height, width = self._shape
        made = _abi.sized(
            _abi.sv_format,
            width=width,
            height=height,
            slices=slices,
            max_slab_slices=slices,
            voxel_type=_abi.SV_VOXEL_U8,
            carrier=_abi.SV_CARRIER_HOST,
            padding_value=_abi.SV_NO_PADDING if padding is None else padding,
            tiles_x=1,
            tile_w=width,
            tile_h=height,
            row_pitch=width,
            spacing_mm=(ctypes.c_float * 3)(*(self._spacing or (0.0, 0.0, 0.0))),
            flags=_abi.SV_FORMAT_SCANNED if scanned else 0,
        )
        fixed = {p.id for p in self._plugin.parameters.values() if p.fixed}
        at_activate = _value_list({i: v for i, v in self._ids.items() if i in fixed})
        made.values, made.value_count = at_activate, len(at_activate)
        if self._buffer is not None:
            made.host_memory, made.host_memory_bytes = _at(self._buffer), self._buffer.nbytes
        self._takes_ranges = scanned
        return made

    def _extensions(self, confidence: bool) -> None:
        self._confidence = self._extension(_abi.SV_EXT_CONFIDENCE, _abi.sv_ext_confidence) if confidence else None
        if self._confidence is not None and not self._confidence.offered(self._instance):
            self._confidence = None
        if self._confidence is not None:
            self._confidence_map = np.zeros(self._shape[1:], np.float32)
            self._confidence_at = _at(self._confidence_map)
            self._read_confidence = self._confidence.read
        self._points = self._extension(_abi.SV_EXT_POINTS, _abi.sv_ext_points)
        if self._points is not None:
            self._write_points = self._points.write
        self._confidence_report = _abi.sized(_abi.sv_confidence_report)
        self._points_report = _abi.sized(_abi.sv_points_report)

    def _needed(self, made: Any) -> int:
        """Bytes by smartvis.needs/1; of a plugin that does not tell, what any needs: a volume and its maps."""
        needs = _abi.sized(_abi.sv_needs)
        device = _abi.sized(_abi.sv_needs_device, flags=_abi.SV_NEEDS_CPU | _abi.SV_NEEDS_UNIFIED, compute_units=16)
        table = self._extension(_abi.SV_EXT_NEEDS, _abi.sv_ext_needs)
        if table is None:
            return 2 * self._bytes
        arguments = (ctypes.byref(made), self._values, len(self._values), ctypes.byref(device), ctypes.byref(needs))
        self._check("needs", table.of(self._instance, *arguments))
        return int(needs.device_bytes + needs.host_bytes)

    def _extension(self, name: str, table: type[ctypes.Structure]) -> Any:
        address = self._calls.get_extension(self._instance, name.encode())
        return ctypes.cast(address, ctypes.POINTER(table)).contents if address else None

    def _structs(self) -> None:
        """The structs and functions of a frame, made once; a call only changes fields."""
        self._begin, self._take, self._end = self._calls.begin, self._calls.slab, self._calls.end
        self._frame = _abi.sized(_abi.sv_frame, values=self._values, value_count=len(self._values))
        self._probe_told = False
        self._heeds_probe = bool(self._plugin.features & _abi.SV_FEATURE_PROBE)
        self._slab = _abi.sized(_abi.sv_slab, slice_count=self._shape[0], bytes=self._bytes)
        self._out = _abi.sized(
            _abi.sv_result,
            depth=_at(self.result.depth),
            status=_at(self.result.status),
            stats=ctypes.pointer(self._stats),
        )

    # --------------------------------------------------------------------------------------------- calls

    def __call__(
        self,
        volume: NDArray[np.uint8],
        scanned: NDArray[np.uint16] | None = None,
        *,
        time_ns: int = 0,
        discontinuity: bool = False,
        same_volume: bool = False,
        probe: Any = None,
        beams: Any = None,
    ) -> Result:
        """Clips one volume. `scanned`: [y, x, 2], first scanned slice and the first behind the scan, uint16; for
        those made with ``scanned=True``. `time_ns`: when it was acquired, 0: unknown. `discontinuity`: it does
        not continue the volume before. `probe`: the rotation [3, 3] from the probe's axes (z away from it) to the
        volume's x, y, z; or three numbers, the unit vector to the probe alone; None: unknown. `same_volume`: the one
        before, by another camera or with other values. `beams`: how they run, with the rotation of `probe`: "parallel",
        or a fan: its apex (x, y, z, mm from the centre of voxel [0, 0, 0]), and mm from there to the sweep's axis."""
        address = self._address(volume)
        ranges = self._ranges(scanned)
        frame, slab, instance = self._frame, self._slab, self._active()
        self._tell_probe(probe, beams)
        self.result.source = volume
        frame.index = self._frame_index
        frame.time_ns = time_ns
        frame.flags = _abi.SV_FRAME_DISCONTINUITY if discontinuity else 0
        frame.flags |= _abi.SV_FRAME_SAME_VOLUME if same_volume and self._heeds_probe else 0
        frame.scanned = None if ranges is None else _at(ranges)
        slab.memory = address
        self._frame_index += 1
        self.result.depth.fill(np.nan)
        self._check("begin", self._begin(instance, ctypes.byref(frame)), plain=True)
        self._check("slab", self._take(instance, ctypes.byref(slab)), plain=True)
        return self._finish("end", self._end(instance, ctypes.byref(self._out)))

    def adjust(self, **parameters: object) -> Result:
        """The last volume again with other values of adjustable parameters, such as the surface position."""
        values = _value_list(self._plugin.encode(parameters))
        self.result.depth.fill(np.nan)
        instance = self._active()
        return self._finish("adjust", self._calls.adjust(instance, values, len(values), ctypes.byref(self._out)))

    def set(self, **parameters: object) -> None:
        """Other values from the next volume on. The plugin refuses those that are read at activation."""
        self._ids |= self._plugin.encode(parameters)
        self._values = _value_list(self._ids)
        self._frame.values, self._frame.value_count = self._values, len(self._values)

    def reset(self, **parameters: object) -> None:
        """These values from the next volume on, and the default for every other parameter."""
        self._ids = {}
        self.set(**parameters)

    def close(self) -> None:
        """Ends the instance. A closed one refuses every call; its result stays."""
        if self._instance is not None:
            self._calls.deactivate(self._instance)
            self._calls.destroy(self._instance)
            self._instance = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        if getattr(self, "_instance", None) is not None:
            self.close()

    @property
    def shape(self) -> Shape:
        """Slices, height, width."""
        return self._shape

    @property
    def buffer(self) -> NDArray[np.uint8]:
        """The array in which volumes lie; ValueError if it was made without."""
        if self._buffer is None:
            raise ValueError("there is no buffer: make it with buffer=True, or with an array")
        return self._buffer

    # -------------------------------------------------------------------------------------------- details

    def _active(self) -> Any:
        if self._instance is None:
            raise ValueError("the clipper is closed")
        return self._instance

    def _address(self, volume: NDArray[np.uint8]) -> int:
        if volume.dtype != np.uint8 or volume.shape != self._shape:
            raise ValueError(
                f"the volume is {volume.dtype} of shape {volume.shape}, expected uint8 of shape {self._shape}"
            )
        if not volume.flags.c_contiguous:
            volume = np.ascontiguousarray(volume)
        if self._buffer is not None:
            first = _at(self._buffer)
            if not first <= _at(volume) <= first + self._buffer.nbytes - self._bytes:
                own = self._buffer.reshape(-1)[: self._bytes].reshape(self._shape)
                np.copyto(own, volume)
                volume = own
        self._volume = volume  # adjust reads it again, so it must live
        return _at(volume)

    def _ranges(self, scanned: NDArray[np.uint16] | None) -> NDArray[np.uint16] | None:
        if (scanned is not None) != self._takes_ranges:
            raise ValueError(
                "scanned ranges are missing: it was made with scanned=True"
                if self._takes_ranges
                else "scanned ranges were given: make it with scanned=True"
            )
        if scanned is None:
            return None
        if scanned.dtype != np.uint16 or scanned.shape != (*self._shape[1:], 2):
            raise ValueError(
                f"scanned is {scanned.dtype} of shape {scanned.shape}, expected uint16 of shape {(*self._shape[1:], 2)}"
            )
        self._scanned = np.ascontiguousarray(scanned)
        return self._scanned

    def _tell_probe(self, probe: Any, beams: Any) -> None:
        """What the frame says of it; the plugin checks the numbers."""
        if probe is None and beams is None and not self._probe_told:
            return
        fan = beams is not None and beams != "parallel"
        apex, sweep = (tuple(map(float, beams[0])), float(beams[1])) if fan else ((0.0, 0.0, 0.0), 0.0)
        self._frame.beams = _abi.SV_BEAMS_FAN if fan else _abi.SV_BEAMS_PARALLEL if beams else _abi.SV_BEAMS_UNKNOWN
        self._frame.beam_apex_mm[:] = apex
        self._frame.beam_sweep_mm = sweep
        told = np.zeros(3) if probe is None else checked_probe(probe)
        whole = told.ndim == 2
        self._frame.probe_rotation[:] = told.ravel().tolist() if whole else [0.0] * 9
        self._frame.probe_side[:] = (-told[:, 2] if whole else told).tolist()
        self._probe_told = probe is not None or beams is not None

    def _check(self, call: str, status: int, plain: bool = False) -> None:
        """`plain`: the call knows no success but SV_OK."""
        if status < 0:
            raise PluginError(call, status, (self._calls.last_error(self._instance) or b"").decode("utf-8", "replace"))
        if plain and status != _abi.SV_OK:
            raise PluginError(call, status, "the plugin returned a status that this call does not have")

    def _finish(self, call: str, status: int) -> Result:
        self._check(call, status)
        result, stats = self.result, self._stats
        try:
            result.outcome = Outcome(status)
        except ValueError:
            raise PluginError(call, status, "the plugin returned a status that the header does not name") from None
        if stats.outcome != status:
            raise PluginError(call, status, f"the statistics tell another outcome, {stats.outcome}")
        # A depth that was not written is still NaN, and a NaN survives both min and max.
        nearest, farthest = float(result.depth.min()), float(result.depth.max())
        limit = _FARTHEST * self._shape[0] if result.clips else 0.0
        if not (-limit <= nearest and farthest <= limit):
            raise PluginError(call, status, f"depths of {nearest} .. {farthest} slices: not written, or absurd")
        result.statistics.points = stats.points
        result.statistics.unfilled = stats.unfilled
        self._read_extensions()
        return result

    def _read_extensions(self) -> None:
        statistics = self.result.statistics
        if self._confidence is not None:
            sure = self._confidence_map
            status = self._read_confidence(self._instance, self._confidence_at, ctypes.byref(self._confidence_report))
            self._check("confidence", status)
            # As the host does it: a wrong confidence costs the result its confidence, not its surface.
            self.result.confidence = sure if sure.min() >= 0.0 and sure.max() <= 1.0 else None
            if self.result.confidence is None:
                log.warning("%s: confidences outside of 0 .. 1 are left out", self._plugin.id)
            statistics.fluid_threshold = self._confidence_report.fluid_threshold
            statistics.open_rays = self._confidence_report.open_rays
            self.result.why = words_of(self._confidence_report)
            self.result.try_this = self._try_this()
        elif self._points is not None and self._stats.points > 0:
            self._check("points", self._write_points(self._instance, ctypes.byref(self._points_report)))
            statistics.bone_threshold = self._points_report.bone_threshold
            statistics.volume_max = self._points_report.volume_max
            statistics.passes = self._points_report.passes

    def _try_this(self) -> dict[str, str]:
        report = self._confidence_report
        for key, p in self._plugin.parameters.items():
            if report.try_id and p.id == report.try_id:
                named = dict(zip(p.numbers, p.choices, strict=False))
                return {key: named.get(report.try_value, f"{report.try_value:g}")}
        return {}


def _value_list(values: dict[int, float]) -> Any:
    return (_abi.sv_param_value * len(values))(*(_abi.sv_param_value(i, 0, v) for i, v in values.items()))


def checked_shape(shape: Sequence[int]) -> Shape:
    if not isinstance(shape, (Sequence, np.ndarray)):
        raise TypeError(f"shape={shape!r}: expected slices, height and width, each 1 .. 8192")
    if len(shape) != 3 or not all(1 <= n <= 8192 and n == int(n) for n in shape):
        raise ValueError(f"shape={tuple(shape)}: expected slices, height and width, each 1 .. 8192")
    return int(shape[0]), int(shape[1]), int(shape[2])


def checked_probe(probe: Any) -> NDArray[np.float64]:
    told = np.asarray(probe, np.float64)
    if told.shape not in ((3, 3), (3,)):
        raise ValueError(f"probe has shape {told.shape}, expected a rotation (3, 3) or a direction (3,)")
    return told


def checked_buffer(buffer: NDArray[np.uint8] | bool) -> NDArray[np.uint8] | None:
    if isinstance(buffer, bool):
        return None
    if buffer.dtype != np.uint8 or not buffer.flags.c_contiguous:
        raise ValueError(f"buffer is {buffer.dtype}, expected a C-contiguous array of uint8")
    return buffer
