# SPDX-License-Identifier: MIT
"""Clipper: clip() for volume after volume, with the same bits, whatever it clipped before; from several threads."""

import itertools
import re
import subprocess
import sys
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import SimpleITK as sitk
from conftest import LONG, SOURCE, host_sim, layers

import smartvis
from smartvis import Clipper, Result

SHAPE = (64, 56, 56)
CROWDED = (32, 20, 24)
DATA = SOURCE.parent / "shared" / "data"  # where `make demo` looks for scans, too
SCANS = [*sorted(DATA.glob("*.mha")), *sorted(p for p in DATA.glob("real/*.mha") if "_label" not in p.name)]


def same(a: Result, b: Result) -> bool:
    """Maps, reason and doubt."""
    maps: list[tuple[Any, Any]] = [(a.depth, b.depth), (a.status, b.status), (a.confidence, b.confidence)]
    return all(np.array_equal(*pair) for pair in maps) and (a.why, a.doubt) == (b.why, b.doubt)


def of_the_host(path: Any, folder: Any) -> np.ndarray:
    """The map of `host_sim run`, in mm."""
    few = ["--few-pictures", "--setting", "smartvis", "--frames", 1, "--picture", 32]
    host_sim("run", "--volume", path, "--write", "depthmap", "--out", folder, *few)
    return sitk.GetArrayFromImage(sitk.ReadImage(str(folder / "depthmap.mha")))[0]


@pytest.mark.parametrize("name", [*smartvis.CASES, *map(str, SCANS)])
def test_every_door_gives_one_answer(name: str, tmp_path: Any) -> None:
    """Of a scene or a real scan: host, clip, and a Clipper that saw something else before."""
    path = name
    if name in smartvis.CASES:
        host_sim("scenes", name, "--size", 80, "--export", "--out", tmp_path)
        path = tmp_path / f"{name}_full.mha"
    image = sitk.ReadImage(str(path))
    once = smartvis.clip(image)
    assert np.array_equal(once.depth_mm, of_the_host(path, tmp_path))
    volume = sitk.GetArrayFromImage(image)
    alone = smartvis.clip(volume, image.GetSpacing())
    with Clipper(volume.shape, image.GetSpacing(), buffer=volume.dtype == np.uint8) as clipper:
        assert same(clipper(volume), alone)
        clipper(np.roll(volume, 7, axis=1))
        assert same(clipper(volume), alone) and same(clipper.adjust(), alone)
        if volume.dtype == np.uint8:
            clipper.buffer[:] = volume
            assert same(clipper(clipper.buffer), alone)


@pytest.mark.skipif(not (DATA / "real").exists(), reason="no real scans beside the repository")
def test_real_scans_are_clipped_by_a_sequence() -> None:
    """What lies outside the fan is no fluid."""
    for path in sorted(DATA.glob("real/fetus_*[!l].mha")):
        image = sitk.ReadImage(str(path))
        volume = sitk.GetArrayFromImage(image)
        with Clipper(volume.shape, image.GetSpacing()) as clipper:
            result = clipper(volume)
        assert result.clips and "Nothing hides" not in result.why


def test_a_sequence_is_fitted_once(volume: np.ndarray, monkeypatch: pytest.MonkeyPatch) -> None:
    """The fan is kept while grid and outline stay, as a scanner would."""
    looks: list[smartvis._seen.Levels] = []

    class Counted(smartvis._seen.Levels):
        def __init__(self, *given: Any, **how: Any) -> None:
            super().__init__(*given, **how)
            looks.append(self)

    monkeypatch.setattr(smartvis._clip, "Levels", Counted)
    z, y, x = np.indices(SHAPE)
    scanned = np.abs(x - 27.5) + np.abs(y - 27.5) < 14 + z * 0.5
    volumes = [np.where(scanned, np.roll(volume, shift, 1) | 1, 0).astype(np.uint8) for shift in (0, 3, 6)]
    with Clipper(SHAPE, (1, 1, 1.01)) as clipper:
        for one in volumes:
            clipper(one)
        clipper(np.where(np.roll(scanned, 5, 2), volume | 1, 0).astype(np.uint8))
        clipper(volumes[0])
    assert [look.fitted for look in looks] == [True, False, False, True, False]


def test_what_a_clipper_was_told_holds_for_every_volume(volume: np.ndarray) -> None:
    how: dict[str, Any] = {"view": (0.1, 0, 1), "scanned": "all", "window": (0, 220), "lowres": 40, "probe": "-z"}
    how |= {"remove": [(28.0, 28.0, 40.0, 6.0)], "method": "wall", "q": 0.3}
    alone = smartvis.clip(volume, (1, 1, 1), **how)
    with Clipper(SHAPE, (1, 1, 1), **how) as clipper:
        for _ in range(2):
            assert same(clipper(volume), alone)
        assert same(clipper.adjust(), alone)  # the mark is applied to each map
        straight = smartvis.clip(volume, (1, 1, 1), **(how | {"view": None}))
        assert same(clipper(volume, view="probe"), straight)
    fan = volume.copy()
    fan[:5] = 7
    with Clipper(SHAPE, (1, 1, 1), padding=7) as clipper:
        assert same(clipper(fan), smartvis.clip(fan, (1, 1, 1), scanned=fan != 7))
        assert same(clipper(fan, "all"), smartvis.clip(fan, (1, 1, 1), scanned="all"))


def test_beams_are_told_along_the_axes_of_the_volume(volume: np.ndarray) -> None:
    """A fan about the middle of the face, seen straight and from the side."""
    probe, apex = np.eye(3), (27.5, 27.5, -60.0)
    with Clipper(SHAPE, (1, 1, 1), probe=probe, beams=(apex, 20)) as clipper:
        assert same(clipper(volume), smartvis.clip(volume, (1, 1, 1), probe=probe, beams=(apex, 20)))
        for view in ((0, 0, 1), (1, 0, 0)):
            look = clipper._look(smartvis._volume.given(volume), None, view, probe)
            told = clipper._told(look, probe, (apex, 20))
            index = np.array(told.beam_apex_mm) / look.camera.spacing
            assert np.allclose(look.camera.to_volume_mm(index), apex) and told.beam_sweep_mm == 20
    for wrong in ("fan", ((1, 2), 3), 5):
        with pytest.raises(ValueError, match="beams=.*expected 'parallel', or a fan's"):
            smartvis.clip(volume, (1, 1, 1), probe=probe, beams=wrong)


def test_values_are_set_and_reset(volume: np.ndarray) -> None:
    with Clipper(SHAPE, (1, 1, 1), method="mean") as clipper:
        first = clipper(volume)
        clipper.set(q=0.9)
        turned = clipper(volume)
        assert not np.array_equal(turned.depth, first.depth)
        clipper.set(method="wall")  # which is read at activation
        assert same(clipper(volume), smartvis.clip(volume, (1, 1, 1), method="wall", q=0.9))
        clipper.reset(method="mean")
        assert same(clipper(volume), first)
        with pytest.raises(ValueError, match="no parameter 'knob'"):
            clipper.set(knob=1)


def of_eight_threads(call: Callable[[int], Result | None], expected: list[Result], calls: int) -> int:
    """Each thread asks for its own volume, all at once: how many of the maps came, each of its volume's bits."""
    begin = threading.Barrier(8)

    def work(number: int) -> list[bool]:
        begin.wait(LONG)
        came = (call(number) for _ in range(calls))
        return [same(result, expected[number]) for result in came if result is not None]

    with ThreadPoolExecutor(8) as threads:
        right = [one for ended in [threads.submit(work, number) for number in range(8)] for one in ended.result(LONG)]
    assert all(right), f"{right.count(False)} of {len(right)} maps are another volume's"
    return len(right)


@pytest.fixture(scope="module")
def crowd() -> tuple[list[np.ndarray], list[Result]]:
    """Small volumes, and the map of each by one thread: no two are alike."""
    fluid = [(0.1, 0.6), (0.2, 0.5), (0.2, 0.6), (0.3, 0.6), (0.2, 0.7), (0.3, 0.7), (0.4, 0.7), (0.4, 0.8)]
    volumes = [layers(CROWDED, *ends) for ends in fluid]
    maps = [smartvis.clip(volume, (1, 1, 1)) for volume in volumes]
    assert sum(same(a, b) for a in maps for b in maps) == len(maps) == 8
    return volumes, maps


def test_a_thousand_maps_by_eight_threads(crowd: tuple[list[np.ndarray], list[Result]]) -> None:
    """One Clipper for all, and one each; clip() has one behind it, too."""
    volumes, maps = crowd
    with Clipper(CROWDED, (1, 1, 1)) as one:
        assert of_eight_threads(lambda n: one(volumes[n]), maps, 125) == 1000
    each = [Clipper(CROWDED, (1, 1, 1)) for _ in range(8)]
    assert of_eight_threads(lambda n: each[n](volumes[n]), maps, 125) == 1000
    for clipper in each:
        clipper.close()
    assert of_eight_threads(lambda n: smartvis.clip(volumes[n], (1, 1, 1)), maps, 20) == 160
    turned = np.roll(volumes[0], 9, axis=0)  # of another grid: the plugin is activated anew
    volumes, maps = [*volumes[1:], turned], [*maps[1:], smartvis.clip(turned, (1, 1, 1))]
    with Clipper(CROWDED, (1, 1, 1)) as one:
        assert of_eight_threads(lambda n: one(volumes[n]), maps, 2) == 16


def test_threads_are_refused_when_their_clipper_is_closed(crowd: tuple[list[np.ndarray], list[Result]]) -> None:
    """By another thread, while they are at it; none gets a map that is not its volume's."""
    volumes, maps = crowd
    one, calls = Clipper(CROWDED, (1, 1, 1)), itertools.count()
    said: list[str] = []

    def call(n: int) -> Result | None:
        if next(calls) == 100:
            one.close()
        try:
            return one(volumes[n])
        except ValueError as error:
            said.append(str(error))
            return None

    right = of_eight_threads(call, maps, 25)
    assert 90 <= right < 200 and len(said) == 200 - right and set(said) == {"the clipper is closed"}


WRONG: list[tuple[Callable[[Clipper, np.ndarray], Any], str]] = [
    (lambda clipper, v: clipper(v[:, :, 1:]), r"shape \(64, 56, 55\), expected \(64, 56, 56\)"),
    (lambda clipper, v: clipper(v.astype(complex)), "the volume holds complex128"),
    (lambda clipper, v: clipper(v, np.zeros((56, 56))), r"scanned has shape \(56, 56\)"),
    (lambda clipper, v: clipper.buffer, "buffer=True"),
    (lambda clipper, v: clipper.adjust(q=0.2), "no volume to adjust yet"),
]


@pytest.mark.parametrize(("call", "said"), WRONG)
def test_wrong_calls_are_named(volume: np.ndarray, call: Callable[[Clipper, np.ndarray], Any], said: str) -> None:
    with Clipper(SHAPE, (1, 1, 1)) as clipper, pytest.raises(ValueError, match=said):
        call(clipper, volume)
    with pytest.raises(ValueError, match="closed"):
        clipper(volume)


def test_wrong_beginnings_are_named() -> None:
    for how, said in (({"shape": (0, 1, 1)}, "each 1 .. 8192"), ({"spacing": 0.5}, "spacing=0.5, expected (x, y, z)"),
                      ({"probe": "above"}, "probe='above'"), ({"window": 3}, "window=3, expected two finite numbers"),
                      ({"buffer": np.zeros(SHAPE, np.float32)}, "expected a C-contiguous array of uint8"),
                      ({"knob": 1}, "no parameter 'knob'")):  # fmt: skip
        with pytest.raises(ValueError) as caught:  # noqa: PT011
            Clipper(**({"shape": SHAPE} | how))
        assert said in str(caught.value)


def test_numbers_of_any_type_are_taken(volume: np.ndarray) -> None:
    with Clipper(SHAPE, (1, 1, 1)) as clipper:
        whole = clipper(volume)
        shifted = clipper(layers(SHAPE).astype(np.int16) - 10)
    assert whole.clips and same(shifted, smartvis.clip(volume.astype(np.int16) - 10, (1, 1, 1)))


def held() -> int:
    """Bytes of this process that no file has."""
    return int(re.findall(r"RssAnon:\s*(\d+)", Path("/proc/self/status").read_text())[0]) << 10


def activate_in_turn(count: int, most: int) -> None:
    """Volumes of more shapes than a cache has room for: each activates a plugin anew."""
    cache = smartvis.ClipperCache(most=most)
    volumes = [layers((side, side, side)) for side in range(24, 25 + most)]
    for number in range(count):
        smartvis.clip(volumes[number % len(volumes)], spacing=(1, 1, 1), cache=cache)
    cache.close()


@pytest.mark.night
def test_activations_leave_nothing() -> None:
    """The runtime keeps some of every program that it reads, until the device rests: some 60 KB an activation. Memory
    that is kept for reuse comes and goes by 4 MB."""
    activate_in_turn(48, 2)
    before = held()
    activate_in_turn(384, 2)
    assert held() - before < 8 << 20


def test_a_process_ends_whatever_it_began_with() -> None:
    """What `atexit` has of the process's own, such as folders for the time being, may stand before all of ours."""
    code = (
        "import tempfile; kept = tempfile.TemporaryDirectory()\n"
        "import numpy as np, smartvis\n"
        "clipper = smartvis.Clipper((24, 24, 24), (1, 1, 1))\n"
        "clipper(np.full((24, 24, 24), 9, np.uint8))\n"
        "print('clipped')"
    )
    command = [sys.executable, "-P", "-c", code]
    ended = subprocess.run(command, capture_output=True, text=True, check=False, timeout=LONG)
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "clipped\n", "")
