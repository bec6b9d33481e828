# SPDX-License-Identifier: MIT
"""What a person who scans gets: verdicts and surfaces with beams told, the pose alone, nothing; of sets, and of volumes
from turned cameras, as the machine hands them over."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache, partial
from itertools import pairwise
from pathlib import Path

import cases
import marks
import numpy as np
from cases import Told
from marks import Sums
from numpy.typing import NDArray
from seen import Seen
from session import Session
from sites import Method, Site, Sites, judge_site

from smartvis import _metaimage
from smartvis._errors import FileError
from smartvis._volume import given

_TOLD = ("beams", "pose", "nothing")
_STEP_MM, _POCKET_MM = 0.25, 2.0  # along a ray from voxel to voxel of labels; shorter fluid is none
_NOT_SCANNED, _TISSUE, _FLUID, _FETUS, _CORD, _BEHIND, _DOUBTFUL = range(7)
_KIND = np.array([0, 1, 2, 3, 4, 1] + [_DOUBTFUL] * 250, np.uint8)  # what is behind is tissue
# Yaw and pitch: those of a probe's user, and all around.
_USER = (
    *((0, 0), (10, 0), (-10, 10), (20, 0), (-20, 0), (0, 20), (0, -20), (20, 20), (-20, -20)),
    *((30, 0), (-30, 0), (0, 30), (0, -30), (30, -30), (-30, 30), (40, 0), (-40, 0), (0, 40), (0, -40)),
    *((50, 0), (-50, 0), (0, 50), (0, -50)),
)
_NEAR_VIEWS = 9
_AROUND = tuple((20 * (i % 18), 30 * (i // 18 - 1)) for i in range(54))
_BANDS = ((-1, 20), (20, 40), (40, 50))  # degrees
_ORBIT, _FRAME_NS = 200, 50_000_000


def _answers(what: str, told: str, answers: Counter[str]) -> str:
    return f"  {what:<32} {told:<8} {answers['sure']:4} /{answers['doubtful']:3} /{answers['refused']:3}"


def _shares(cut: float, left: float) -> str:
    return f"cut {100 * cut:5.2f} %  left {100 * left:5.2f} %"


def _site(site: Site, plugin: str | None, method: Method, told: str) -> None:
    with method.open(plugin, told) as session:
        score, _, _ = judge_site(session, site, method.best_q)
    m, c = score.mean, score.calibration
    print(f"{_answers(method.settings, told, score.answers)}  {m.error:5.2f} slices  {_shares(m.cut, m.left)}  "
          f"AUC cut {c.auc('cut'):.3f}, left {c.auc('left'):.3f}{score.surest_words}")  # fmt: skip


# ------------------------------------------------------------------------------------------- a volume with labels


@dataclass
class Rays:
    """Where rays may be clipped, mm from the first slice: low .. high was scanned, near .. far is right."""

    judged: NDArray[np.bool_]
    low: NDArray[np.float64]
    near: NDArray[np.float64]
    far: NDArray[np.float64]
    high: NDArray[np.float64]

    def off(self, depth: NDArray[np.float64]) -> NDArray[np.float64]:
        """How much is left (> 0) or cut (< 0) of rays that are clipped at depths of so many mm."""
        at = np.minimum(np.maximum(depth, self.low), self.high)
        return np.maximum(self.near - at, 0.0) - np.maximum(at - self.far, 0.0)


def rays_of(labels: NDArray[np.uint8]) -> Rays:
    """Of the labels [step, ray] along rays."""
    kind, steps = _KIND[labels], len(labels)
    k = np.arange(steps)[:, None]
    there = labels != _NOT_SCANNED
    begin = np.where(there.any(axis=0), there.argmax(axis=0), steps)
    end = np.where(there.any(axis=0), steps - there[::-1].argmax(axis=0), steps)
    judged = (begin < end) & (labels[np.minimum(begin, steps - 1), np.arange(labels.shape[1])] < _DOUBTFUL)
    first = _first_stop(kind, begin, end)
    tissue = (kind == _TISSUE) & (k >= begin) & (k < first)
    last = np.where(tissue, k + 1, 0).max(axis=0)
    solid = ((kind == _FETUS) | (kind == _TISSUE)) & (k >= first) & (k < end)
    stays = np.where(solid.any(axis=0), solid.argmax(axis=0), 0)
    judged &= (first < end) & solid.any(axis=0) & (kind[stays, np.arange(labels.shape[1])] == _FETUS)
    near = np.where(last > begin, last, begin)
    return Rays(judged, *(_STEP_MM * (at - 0.5) for at in (begin, near, stays, end)))


def _first_stop(kind: NDArray[np.uint8], begin: NDArray[np.int64], end: NDArray[np.int64]) -> NDArray[np.int64]:
    """The first step behind the tissue, or what nobody can tell, that a ray begins with. A pocket of fluid or cord in
    tissue is tissue."""
    first, run_end, after = end.copy(), end.copy(), np.full(end.shape, 255)
    for k in range(len(kind) - 1, -1, -1):
        here = kind[k]
        changes = (kind[k + 1] != here) & (k + 1 < end) if k + 1 < len(kind) else np.zeros(end.shape, bool)
        if changes.any():
            run_end[changes], after[changes] = k + 1, kind[k + 1][changes]
        begins = (kind[k - 1] != here) | (k == begin) if k > 0 else np.ones(end.shape, bool)
        pocket = (run_end - k < _POCKET_MM / _STEP_MM) & (after == _TISSUE)
        stops = (here == _FETUS) | (((here == _FLUID) | (here == _CORD)) & ~pocket)
        at = begins & stops & (k >= begin) & (k < end)
        first[at] = k
    return first


# ------------------------------------------------------------------------------------------- turned cameras


class Scan:
    """A volume from a file, and what its labels say, if there are any."""

    def __init__(self, path: str) -> None:
        of = given(path)
        self.name = Path(path).name
        self.levels = cases.levels_of(of)
        self.spacing = of.spacing
        labels = Path(f"{path[:-4]}_label.mha")
        self._labels = _metaimage.read(labels) if labels.exists() else None
        self.hidden = self._labels is not None  #: else nothing hides what it shows
        self._seen = cache(self.seen)
        self.rays = cache(self._rays_anew)

    def seen(self, view: tuple[float, float], around: bool = False) -> Seen:
        """The volume as a camera sees it that is turned by yaw and pitch."""
        grid = self.levels.plan(turn=view, around=around)
        return Seen(self.levels, grid, self.spacing or (1.0, 1.0, 1.0))

    def _rays_anew(self, view: tuple[float, float]) -> Rays:
        assert self._labels is not None
        voxels, spacing = self._labels
        seen = self._seen(view)
        _, height, width = seen.grid.shape
        depth = seen.grid.box[1]
        steps = int(depth / _STEP_MM)
        sample = seen.sampler(voxels, (spacing[0], spacing[1], spacing[2]))
        slice_mm = depth / seen.grid.shape[0]
        labels = np.empty((steps, height * width), np.uint8)
        for k in range(steps):
            labels[k] = sample((0.5 * slice_mm + k * _STEP_MM) / depth).ravel()
        return rays_of(labels)

    def clip(self, session: Session, view: tuple[float, float], told: str) -> tuple[Seen, NDArray[np.float32], bool]:
        """A frame that continues none: what is seen, the map, and whether it clips."""
        seen = self._seen(view)
        result = session.frame(seen, _known(seen, told), _FRAME_NS)
        return seen, result.depth, result.clips

    def orbit(self, session: Session, told: str) -> int:
        """How often the answer changes while the camera goes round."""
        answers = []
        for i in range(_ORBIT):
            seen = self.seen((360.0 * i / _ORBIT, 40.0 * math.sin(0.1 * i)), around=True)
            session.frame(seen, _known(seen, told), (i + 1) * _FRAME_NS, goes_on=i > 0)
            answers.append(session.answer)
        return sum(now != before for before, now in pairwise(answers))


def _known(seen: Seen, told: str) -> Told:
    return Told(seen.grid.probe, seen.grid.beams).limited(told)


def _user(scan: Scan, session: Session, told: str) -> None:
    for more_than, to in _BANDS:
        answers, sums = Counter[str](), list[tuple[float, float, float]]()
        for view in _USER:
            if not more_than < max(map(abs, view)) <= to:
                continue
            seen, depth, _ = scan.clip(session, view, told)
            answers[session.answer] += 1
            s = Sums.of_rays(scan.rays(view), depth, seen)[0]
            sums.append((s.cut, s.left, s.error))
        cut, left, error = (float(value) / len(sums) for value in np.cumsum(sums, axis=0)[-1])
        worst = max(one[0] + one[1] for one in sums)
        print(f"{_answers(f'to {to} degrees', told, answers)}  {error:5.2f} mm      {_shares(cut, left)}  "
              f"bad {100 * (cut + left):.1f} %, worst {100 * worst:.1f}", flush=True)  # fmt: skip


def _around(scan: Scan, session: Session, told: str) -> None:
    answers = Counter[str]()
    for view in _AROUND:
        scan.clip(session, view, told)
        answers[session.answer] += 1
    print(f"{_answers('all around', told, answers)}  nothing hides it")


def _volumes(volumes: Sequence[str], plugin: str | None, method: Method) -> None:
    print(method.settings)
    with method.open(plugin) as session:
        for path in volumes:
            scan = Scan(path)
            print(scan.name)
            for told in _TOLD:
                (_user if scan.hidden else _around)(scan, session, told)
                changes = scan.orbit(session, told)
                print(f"  {'orbit':<32} {told:<8} the answer changes {changes} times in {_ORBIT} frames", flush=True)


def scans(sites: Sites, volumes: Sequence[str], methods: Sequence[Method], plugin: str | None) -> None:
    """Prints a row for every set, method and what is told. Then the volumes: FILE with FILE_label.mha beside it
    (voxels: 1, 5 tissue, 2 fluid, 3 fetus, 4 cord, 6 and more doubtful) by its labels from 23 views; others, which
    nothing hides, from 54; and an orbit of 200 frames."""
    print("Told; sure / doubtful / refused; error, and share of the fetus' rays that are cut, of all rays on which an "
          "occluder is left;\nof volumes with labels: of the fetus' rays")  # fmt: skip
    for site in sites.all:
        print(site)
        for method in methods:
            for told in _TOLD:
                _site(site, plugin, method, told)
    for method in methods if volumes else ():
        _volumes(volumes, plugin, method)


# ------------------------------------------------------------------------------------------- marks


def _plays_of_site(site: Site, session: Session) -> Iterator[marks.Scores]:
    for case in site.cases:
        result = session.clip(case)
        yield marks.play(case.seen, partial(Sums.of_case, case), result.depth, result.clips)


def _plays_of_volume(path: str, session: Session) -> Iterator[marks.Scores]:
    scan = Scan(path)
    if not scan.hidden:
        raise FileError(f"{path[:-4]}_label.mha: there is none")
    for view in _USER[:_NEAR_VIEWS]:
        seen, depth, clips = scan.clip(session, view, "beams")
        yield marks.play(seen, partial(Sums.of_rays, scan.rays(view), seen=seen), depth, clips)


def mark(sites: Sites, volumes: Sequence[str], methods: Sequence[Method], plugin: str | None) -> None:
    """Prints the means of every set; and of volumes with labels, from nine views up to 20 degrees."""
    print(f"Cases or views; error / cut % / left % after {', '.join(map(str, marks.ROWS))} marks")
    for method in methods:
        print(method.settings)
        with method.open(plugin, "beams") as session:
            for site in sites.all:
                print(marks.line(site.title, "slices", list(_plays_of_site(site, session))), flush=True)
            for path in volumes:
                print(marks.line(Path(path).name, "mm", list(_plays_of_volume(path, session))), flush=True)
