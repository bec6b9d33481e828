# SPDX-License-Identifier: MIT
"""A plugin in this process: activated once, no allocation a frame, nothing copied that need not be; wrong plugins."""

import ctypes
import gc
import logging
import pickle
import threading
import tracemalloc
from typing import Any

import numpy as np
import pytest
from conftest import BUILD

import smartvis
from smartvis import LoadError, Outcome, PluginError, _abi
from smartvis._instance import Instance

SHAPE = (64, 56, 56)


@pytest.mark.parametrize("method", ["mean", "wall"])
def test_a_volume_allocates_nothing(volume: np.ndarray, method: str) -> None:
    with Instance(SHAPE, (1, 1, 1), method=method) as instance:
        instance(volume)
        maps = [instance.result.depth.ctypes.data, instance.result.status.ctypes.data]
        gc.collect()
        tracemalloc.start()
        for _ in range(10):
            instance(volume)  # what Python and ctypes keep for themselves comes once
        before = tracemalloc.get_traced_memory()[0]
        tracemalloc.reset_peak()
        for _ in range(400):
            instance(volume)
        after, most = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        assert maps == [instance.result.depth.ctypes.data, instance.result.status.ctypes.data]
    assert after - before < 1024  # over 400 volumes
    assert most - before < 8192 < instance.result.depth.nbytes  # nowhere a copy, not even of a map


class _Record(ctypes.Structure):  # tests/base/plugins/record.h
    _fields_ = (
        ("size", ctypes.c_uint32),
        ("frames", ctypes.c_uint32),
        ("format", _abi.sv_format),
        ("frame", _abi.sv_frame),
    )


def recorded(instance: Instance) -> Any:
    """The frame as the plugin saw it last."""
    address = instance._calls.get_extension(instance._instance, b"test.record/1")
    return ctypes.cast(address, ctypes.POINTER(_Record)).contents.frame


def test_where_the_probe_is(volume: np.ndarray) -> None:
    recorder = smartvis.load(BUILD / "tests" / "plugins" / "recorder.so")
    turned = np.array([[0.0, 0, -1], [0, 1, 0], [1, 0, 0]])  # probe's z along -x
    rows: Any = [(turned, ((1, 2, -57), 23), False), ([0, 0.6, -0.8], None, True), (None, None, False)]
    with Instance(SHAPE, plugin=recorder, confidence=False) as instance:
        for (probe, beams, same), side in zip(rows, np.array([[1, 0, 0], [0, 0.6, -0.8], [0, 0, 0]]), strict=True):
            instance(volume, probe=probe, beams=beams, same_volume=same)
            frame = recorded(instance)
            assert list(frame.probe_rotation) == (turned.ravel().tolist() if probe is turned else [0] * 9)
            assert np.allclose(list(frame.probe_side), side)
            fan = ([*frame.beam_apex_mm], frame.beam_sweep_mm, frame.beams)
            assert fan == (([1, 2, -57], 23, 2) if beams else ([0, 0, 0], 0, 0))
            assert frame.flags == (_abi.SV_FRAME_SAME_VOLUME if same else 0)
        instance(volume, probe=turned, beams="parallel")
        assert frame.beams == _abi.SV_BEAMS_PARALLEL
        with pytest.raises(ValueError, match=r"probe has shape \(4,\)"):
            instance(volume, probe=[1, 0, 0, 0])
    # clip() is told in the volume's axes; the plugin refuses what is no rotation. A view along +x of a probe at slice 0
    # sees it at its own left or right.
    with pytest.raises(PluginError, match="probe_rotation is 2 0 0"):
        smartvis.clip(volume, probe=2 * np.eye(3))
    cache = smartvis.ClipperCache()
    side_on = smartvis.clip(volume, (1, 1, 1), view=(1, 0, 0), plugin=recorder, cache=cache, probe=np.eye(3))
    (instance,) = cache._instances.values()
    frame = recorded(instance)
    assert np.allclose(np.reshape(frame.probe_rotation, (3, 3)), side_on.camera.rotation)
    assert abs(frame.probe_side[2]) < 1e-6
    cache.close()


def test_volumes_in_the_buffer_are_read_in_place(volume: np.ndarray) -> None:
    with Instance(SHAPE, (1, 1, 1), method="wall", buffer=True) as instance:
        instance.buffer[:] = volume
        inside = instance(instance.buffer)
        assert inside is instance.result
        inside = inside.copy()
        other = instance(np.roll(volume, 5, axis=2), discontinuity=True).copy()
        assert np.array_equal(instance.buffer, np.roll(volume, 5, axis=2))  # from elsewhere: copied into it
    with Instance(SHAPE, (1, 1, 1)) as instance, pytest.raises(ValueError, match="buffer=True"):
        instance.buffer[:] = volume
    ring = np.stack([volume, np.roll(volume, 5, axis=2)])
    with Instance(SHAPE, (1, 1, 1), method="wall", buffer=ring) as instance:
        assert np.array_equal(instance(ring[0]).depth, inside.depth)
        assert np.array_equal(instance(ring[1], discontinuity=True).depth, other.depth)
        assert np.array_equal(ring[0], volume)
    alone = smartvis.clip(volume, (1, 1, 1), method="wall")
    assert inside.confidence is not None and alone.confidence is not None
    assert np.array_equal(inside.depth, alone.depth) and np.array_equal(inside.confidence, alone.confidence)


def test_adjust_is_a_frame_with_the_knob_turned(volume: np.ndarray) -> None:
    with Instance(SHAPE, (1, 1, 1)) as instance:
        first = instance(volume).copy()
        turned = instance.adjust(q=0.9).copy()
        instance.set(q=0.9)
        assert np.array_equal(instance(volume).depth, turned.depth)
        assert not np.array_equal(first.depth, turned.depth)
        instance.reset()
        assert np.array_equal(instance(volume).depth, first.depth)


def test_fixed_parameters_are_refused_later(volume: np.ndarray) -> None:
    with Instance(SHAPE, (1, 1, 1), method="mean") as instance:
        instance.set(method="wall")
        with pytest.raises(PluginError) as caught:
            instance(volume)
        assert caught.value.name == "SV_ERR_PARAM_FIXED" and "method" in caught.value.reason


def test_threads_have_instances_of_their_own(volume: np.ndarray) -> None:
    expected = smartvis.clip(volume, (1, 1, 1)).depth
    same: list[bool] = []

    def work() -> None:
        with Instance(SHAPE, (1, 1, 1)) as instance:
            same.extend(np.array_equal(instance(volume).depth, expected) for _ in range(5))

    threads = [threading.Thread(target=work) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert same == [True] * 15


def test_wrong_calls_are_named(volume: np.ndarray) -> None:
    with Instance(SHAPE, (1, 1, 1)) as instance:
        with pytest.raises(ValueError, match=r"shape \(64, 56, 55\), expected uint8 of shape \(64, 56, 56\)"):
            instance(volume[:, :, 1:])
        with pytest.raises(ValueError, match="float32"):
            instance(volume.astype(np.float32))
        with pytest.raises(ValueError, match="scanned=True"):
            instance(volume, np.zeros((56, 56, 2), np.uint16))
        assert instance(np.asfortranarray(volume)).clips
    with pytest.raises(ValueError, match="closed"):
        instance(volume)
    with Instance(SHAPE, (1, 1, 1), scanned=True) as instance:
        with pytest.raises(ValueError, match="missing"):
            instance(volume)
        with pytest.raises(ValueError, match=r"scanned is int64 of shape \(56, 56\)"):
            instance(volume, np.zeros((56, 56), np.int64))
    with pytest.raises(ValueError, match="each 1 .. 8192"):
        Instance((0, 1, 1))
    with pytest.raises(ValueError, match=r"shape=\(64, 48.5, 56\): expected slices, height and width"):
        Instance((64, 48.5, 56), (1, 1, 1))  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="shape=None: expected slices, height and width"):
        Instance(None)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="C-contiguous"):
        Instance(SHAPE, buffer=np.zeros(SHAPE, np.float32))


def test_messages_of_the_plugin_go_to_logging(volume: np.ndarray, caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.DEBUG, "smartvis.plugin"), pytest.raises(PluginError) as caught:
        Instance(SHAPE, (1, 1, 1), kernel=4, q=1e9)(volume)
    assert any(caught.value.reason in record.message for record in caplog.records)


def test_exceptions_travel_between_processes() -> None:
    error = pickle.loads(pickle.dumps(PluginError("end", -32, "clFinish failed")))
    assert str(error) == "clFinish failed (end: SV_ERR_OPENCL)" and error.status == -32


def test_another_plugin_is_loaded_and_clips(volume: np.ndarray) -> None:
    first_edge = smartvis.load(BUILD / "examples" / "first_edge.so")
    assert first_edge.id == "org.smartvis.example.first_edge"
    assert set(smartvis.parameters(first_edge)) == {"q", "level", "gap"}
    result = smartvis.clip(volume, (1, 1, 1), plugin=first_edge, level=0.2)
    assert result.outcome is Outcome.OK and result.confidence is None
    fluid_end = 64 - (volume[::-1] == 10).argmax(axis=0)
    inner = np.s_[4:-4, 4:-4]
    assert np.abs(result.depth[inner] - (fluid_end[inner] - 0.5 - 0.25 * 0.4 * 64)).max() < 2


def test_files_that_are_no_plugins_are_refused(tmp_path) -> None:
    with pytest.raises(LoadError, match="no such file"):
        smartvis.load(tmp_path / "none.so")
    (tmp_path / "text.so").write_text("no library")
    with pytest.raises(LoadError, match="text.so"):
        smartvis.load(tmp_path / "text.so")
    for name, said in (
        ("far_default", "'depth': the default is 100000, expected"),
        ("create_fails", "gives no instance"),
    ):
        with pytest.raises(PluginError, match=f"{name}.so: 'org.smartvis.test.plane': .*{said}"):
            _ = smartvis.load(BUILD / "tests" / "plugins" / f"{name}.so").parameters
    with pytest.raises(LoadError, match="there are org.smartvis.clip"):
        smartvis.load(id="org.example.none")


WRONG_RESULTS = [
    "depth_nan", "depth_1e30", "depth_infinite", "depth_far", "map_not_written", "last_row_missing",
    "begin_77", "begin_partial", "slab_1", "end_77", "end_minus_77", "outcome_negative", "outcomes_differ",
    "depths_without_surface",
]  # fmt: skip


@pytest.mark.parametrize("fault", WRONG_RESULTS)
def test_what_a_wrong_plugin_tells_never_reaches_the_user(volume, fault: str) -> None:
    with pytest.raises(PluginError):
        smartvis.clip(volume, (1, 1, 1), plugin=smartvis.load(BUILD / "wrong" / f"{fault}.so"))


@pytest.mark.parametrize("fault", ["confidence_above", "confidence_nan"])
def test_a_wrong_confidence_is_left_out(volume, fault: str) -> None:
    plugin = smartvis.load(BUILD / "wrong" / f"{fault}.so")
    right = smartvis.clip(volume, (1, 1, 1), plugin=smartvis.load(BUILD / "wrong" / "right" / "results.so"))
    result = smartvis.clip(volume, (1, 1, 1), plugin=plugin)
    assert result.confidence is None and right.confidence is not None
    assert np.array_equal(result.depth, right.depth)


@pytest.mark.parametrize("fault", ["other_major", "short_entry", "count_zero", "no_create", "descriptor_missing",
                                   "descriptor_short", "no_instance", "short_instance", "null_function"])  # fmt: skip
def test_libraries_that_are_not_whole_are_refused(volume, fault: str) -> None:
    with pytest.raises((LoadError, PluginError)):
        smartvis.clip(volume, (1, 1, 1), plugin=smartvis.load(BUILD / "wrong" / f"{fault}.so"))


@pytest.mark.parametrize("fault", ["param_count_endless", "param_label_null", "range_nan", "step_zero",
                                   "enum_without_names", "text_without_nul", "name_not_utf8"])  # fmt: skip
def test_wrong_descriptions_hurt_nobody(volume, fault: str) -> None:
    plugin = smartvis.load(BUILD / "wrong" / f"{fault}.so")
    assert 0 < len(plugin.parameters) <= 4096 and isinstance(plugin.name, str)


@pytest.mark.parametrize(("name", "major"), [("older_major", 0), ("other_major", 2)])
def test_another_abi_is_not_called(name: str, major: int) -> None:
    with pytest.raises(LoadError, match=f"ABI {major}, this package knows 1"):
        smartvis.load(BUILD / "tests" / "plugins" / f"{name}.so")


def test_what_is_tested_is_the_installed_wheel() -> None:
    assert "site-packages" in smartvis.__file__
    assert smartvis.load().path.startswith(smartvis.__path__[0])
