# SPDX-License-Identifier: MIT
"""Plugins as the package has them: messages, faults, other threads, what a frame tells them; and wrong ones."""

import logging
import pickle
import threading
from typing import Any

import numpy as np
import pytest
from conftest import BUILD

import smartvis
from smartvis import LoadError, Outcome, PluginError
from smartvis._active import told
from smartvis._seen import Levels

SHAPE = (64, 56, 56)


def test_where_the_probe_is(volume: np.ndarray) -> None:
    turned = np.array([[0.0, 0, -1], [0, 1, 0], [1, 0, 0]])  # probe's z along -x
    view = Levels(volume, (1, 1, 1)).plan().view
    rows: Any = [(turned, ((1, 2, -57), 23)), (np.array([0, 0.6, -0.8]), None), (None, None)]
    for (probe, beams), side in zip(rows, np.array([[1, 0, 0], [0, 0.6, -0.8], [0, 0, 0]]), strict=True):
        given = told(view, probe, beams)
        assert list(given.probe_rotation) == (turned.ravel().tolist() if probe is turned else [0] * 9)
        assert np.allclose(list(given.probe_side), side)
        fan = ([*given.beam_apex_mm], given.beam_sweep_mm, given.beams)
        assert fan == (([1, 2, -57], 23, 2) if beams else ([0, 0, 0], 0, 0))
        assert list(given.n) == list(view.n)
    assert told(view, turned, "parallel").beams == 1
    with pytest.raises(ValueError, match=r"probe has shape \(4,\)"):
        smartvis.clip(volume, (1, 1, 1), probe=[1, 0, 0, 0])
    # clip() is told in the volume's axes; the plugin refuses what is no rotation.
    with pytest.raises(PluginError, match="probe_rotation is 2 0 0"):
        smartvis.clip(volume, probe=2 * np.eye(3))


def test_threads_have_instances_of_their_own(volume: np.ndarray) -> None:
    expected = smartvis.clip(volume, (1, 1, 1)).depth
    same: list[bool] = []

    def work() -> None:
        with smartvis.Clipper(SHAPE, (1, 1, 1)) as clipper:
            same.extend(np.array_equal(clipper(volume).depth, expected) for _ in range(5))

    threads = [threading.Thread(target=work) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert same == [True] * 15


def test_wrong_calls_are_named(volume: np.ndarray) -> None:
    with pytest.raises(ValueError, match="each 1 .. 8192"):
        smartvis.Clipper((0, 1, 1))
    with pytest.raises(ValueError, match=r"shape=\(64, 48.5, 56\): expected slices, height and width"):
        smartvis.Clipper((64, 48.5, 56), (1, 1, 1))  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="shape=None: expected slices, height and width"):
        smartvis.Clipper(None)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="C-contiguous"):
        smartvis.Clipper(SHAPE, buffer=np.zeros(SHAPE, np.float32))


def test_messages_of_the_plugin_go_to_logging(volume: np.ndarray, caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.DEBUG, "smartvis.plugin"), pytest.raises(PluginError) as caught:
        smartvis.clip(volume, (1, 1, 1), kernel=4, q=1e9)
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
        ("create_fails", "SV_ERR_NO_MEMORY"),
    ):
        with pytest.raises(PluginError, match=f"{name}.so: 'org.smartvis.test.plane': .*{said}"):
            _ = smartvis.load(BUILD / "tests" / "plugins" / f"{name}.so").parameters
    with pytest.raises(LoadError, match="there are: org.smartvis.clip"):
        smartvis.load(id="org.example.none")


WRONG_RESULTS = [
    "depth_nan", "depth_1e30", "depth_infinite", "depth_far", "map_not_written", "last_row_missing",
    "begin_77", "end_77", "end_minus_77", "outcome_negative",
]  # fmt: skip


@pytest.mark.parametrize("fault", WRONG_RESULTS)
def test_what_a_wrong_plugin_tells_never_reaches_the_user(volume, fault: str) -> None:
    with pytest.raises(PluginError):
        smartvis.clip(volume, (1, 1, 1), plugin=smartvis.load(BUILD / "wrong" / f"{fault}.so"))


@pytest.mark.parametrize("fault", ["crash_in_slab", "exit_in_end", "abort_in_slab"])
def test_a_plugin_that_ends_its_process_costs_a_call(volume, fault: str) -> None:
    plugin = smartvis.load(BUILD / "wrong" / f"{fault}.so")
    assert plugin.guarded and not smartvis.load().guarded
    with pytest.raises(PluginError, match="crashed: SIG|left by exit|aborted"):
        smartvis.clip(volume, (1, 1, 1), plugin=plugin)


def test_a_map_without_a_surface_is_not_taken(volume) -> None:
    result = smartvis.clip(volume, (1, 1, 1), plugin=smartvis.load(BUILD / "wrong" / "depths_without_surface.so"))
    assert not result.clips and not result.depth.any()


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
    with pytest.raises(LoadError, match=f"ABI major {major}, this host speaks 1"):
        smartvis.load(BUILD / "tests" / "plugins" / f"{name}.so")


def test_what_is_tested_is_the_installed_wheel() -> None:
    assert "site-packages" in smartvis.__file__
    assert smartvis.load().path.startswith(smartvis.__path__[0])
