# SPDX-License-Identifier: MIT
"""Do no harm: what methods do where there is nothing to remove, or something that only looks like it."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import cases
import numpy as np
import rays
from cases import FETUS, NEITHER, SAC, Case
from numpy.typing import NDArray
from scores import SiteScore
from session import Session
from sites import Method, Site, Sites, judge_case
from turns import from_side

from smartvis import _metaimage
from smartvis._errors import FileError

_FLUID, _POOL, _LEAST_POOL, _NEAR, _FAR, _LEAD, _NOISE = 40, 65536, 64, 3, 8, 16, 24
# Half a bladder's width, and how much of the tissue between it and the true surface stays: it lies on the wall of the
# sac, and never in the sac or the fetus.
_BLADDER_MM, _BETWEEN_MM = 20.0, 5.0
_TURNS = 12  # about each of three axes
_COARSE, _FINE = 96, 144  # voxels along a side of a view: 1.8 and 1.2 mm each for a head
Voxels = NDArray[np.bool_]


def _noise(count: int) -> NDArray[np.int64]:
    """Numerical Recipes' generator from 1 on: the same noise on every machine."""
    factor, step, modulus = 1664525, 1013904223, 1 << 32
    factors, steps = np.ones(1, np.uint64), np.zeros(1, np.uint64)
    jump, add = factor, step  # of as many numbers as there are
    while len(factors) <= count:
        factors = np.concatenate([factors, factors * np.uint64(jump) % np.uint64(modulus)])
        steps = np.concatenate([steps, (steps * np.uint64(jump) + np.uint64(add)) % np.uint64(modulus)])
        jump, add = jump * jump % modulus, (jump * add + add) % modulus
    state = (factors[1 : count + 1] + steps[1 : count + 1]) % np.uint64(modulus)
    return (state >> np.uint64(8)).astype(np.int64)


def _put(full: NDArray[np.uint8], where: Voxels, level: Callable[[NDArray[np.int64]], NDArray[np.int64]]) -> None:
    """Noise at these voxels, one ray after the other."""
    count = int(where.sum())
    by_ray = np.moveaxis(full, 0, -1)
    by_ray[np.moveaxis(where, 0, -1)] = level(_noise(count))


def _nothing_hides(case: Case, relabel: bool) -> Case:
    """The fetus is whatever can be seen; its truth is the volume as it is."""
    truth = rays.ends(case.full)
    label = np.where(truth < case.slices, FETUS, NEITHER).astype(np.uint8) if relabel else case.label
    return replace(case, truth=truth, label=label, clean=case.full, near=None, far=None)


# ------------------------------------------------------------------------------------ from a case with a truth


def _fluid(case: Case) -> NDArray[np.int64]:
    """Levels of fluid just before the surface."""
    back = np.arange(_NEAR, _FAR + 1)
    z = case.truth[case.labelled].astype(int)[:, None] - back
    low, high = (ends[case.labelled].astype(int)[:, None] for ends in (case.first, case.end))
    y, x = (axis[:, None] for axis in np.nonzero(case.labelled))
    inside = (z >= low) & (z < high)
    level = case.full[np.where(inside, z, 0), y, x]
    pool = level[inside & (level < _FLUID)][:_POOL].astype(np.int64)
    if len(pool) < _LEAST_POOL:
        raise FileError(f"{case.name}: {len(pool)} voxels of fluid before the surface, expected {_LEAST_POOL} or more")
    return pool


def _clips(case: Case) -> NDArray[np.int64]:
    """Where the truth begins: removed voxels are 0 or 1."""
    z = np.arange(case.slices)[:, None, None]
    kept = ((case.clean > 1) & (z >= case.first)) | (z >= case.end)
    first = np.where(kept.any(axis=0), kept.argmax(axis=0), case.slices)
    return np.maximum(first, case.first)


def _bladder(case: Case, clip: NDArray[np.int64]) -> Voxels:
    """An ellipsoid of fluid half way between the start of the scan and the surface, over the middle of the labelled
    rays."""
    y, x = np.nonzero(case.labelled)
    front = case.first[case.labelled].sum(dtype=float) / len(x)
    thick = (clip[case.labelled].sum(dtype=float) - case.first[case.labelled].sum(dtype=float)) / len(x)
    centre = (x.sum(dtype=float) / len(x), y.sum(dtype=float) / len(x), front + 0.4 * thick)
    radius = (_BLADDER_MM / case.spacing[0], _BLADDER_MM / case.spacing[1], 0.25 * thick)
    z, y, x = np.ogrid[: case.slices, : case.label.shape[0], : case.label.shape[1]]
    parts = [((at - c) / r) ** 2 for at, c, r in zip((x, y, z), centre, radius, strict=True)]
    inside = parts[0] + parts[1] + parts[2] < 1.0
    return inside & (~case.labelled | (z + _BETWEEN_MM / case.spacing[2] < clip))


def _variant(case: Case, kind: str) -> Case:
    """What becomes fluid gets levels of the case's own fluid, unless it is black."""
    pool, clip, full = _fluid(case), _clips(case), case.full.copy()
    z = np.arange(case.slices)[:, None, None]
    if kind == "bladder":
        where = _bladder(case, clip)
    else:
        where = case.labelled & (z >= clip) if kind == "no fetus" else z < clip
    _put(full, where & case.scanned, lambda noise: pool[noise % len(pool)] * (kind != "bare, black fluid"))
    made = replace(case, full=full, near=None, far=None)
    if kind == "no fetus":
        made.label = np.where(case.labelled, SAC, NEITHER).astype(np.uint8)
    return made if kind == "bladder" else _nothing_hides(made, False)


#: Bare: all before the true surface is fluid; no fetus: all behind it is, and the labelled rays are sac; bladder: an
#: ellipsoid of fluid, 40 mm wide, in the front tissue.
VARIANTS = ("bare, noisy fluid", "bare, black fluid", "no fetus", "bladder")

# ------------------------------------------------------------------------------------ from a volume that nothing hides


def _bare(case: Case, kind: str) -> Case:
    """Every ray that ends on tissue is labelled fetus, and its own end is the truth."""
    lead = _LEAD if "behind" in kind else 0
    full = np.concatenate([np.zeros((lead, *case.label.shape), np.uint8), case.full])
    seen = case.first < case.end
    first, end = case.first, np.where(seen, case.end + lead, 0).astype(np.uint16)
    if kind != _BARE[0]:
        first = np.zeros_like(first)
    if kind == "no ranges":
        end = np.full_like(end, len(full))
    if kind == "behind noisy fluid":
        before = seen & (np.arange(len(full))[:, None, None] < case.first.astype(int) + lead)
        _put(full, before, lambda noise: 1 + noise % _NOISE)
    return _nothing_hides(replace(case, full=full, first=first, end=end), True)


def _occluded(case: Case) -> Case:
    """The scene `real`: its occluders before the slices of the volume in which anything was scanned. The room before
    them would pass for fluid, and the occluders grow with the volume."""
    seen = case.first < case.end
    if not seen.any():
        raise FileError(f"{case.name}: nothing of it was scanned")
    part = case.full[case.first[seen].min() : case.end[seen].max()]
    with tempfile.TemporaryDirectory() as folder:
        _metaimage.write(Path(folder) / "occluded.mha", part, case.spacing)
        (made,) = cases.scene("real", real=f"{folder}/occluded.mha")
    return replace(made, name=case.name)


_BARE = ("scanned ranges given", "no ranges", "behind noisy fluid", "behind black fluid")
_OCCLUDED = ("behind occluders", "fine, behind occluders")  # in coarse and fine views

# ------------------------------------------------------------------------------------ do no harm

Team = list[tuple[Method, Session]]  # open together, so that a volume is made once
Scores = list[SiteScore]  # of a team


def _judge(team: Team, case: Case, scores: Scores) -> None:
    for (_, session), score in zip(team, scores, strict=True):
        judge_case(session, case, score)


def _print(team: Team, what: str, scores: Scores) -> None:
    for (method, session), s in zip(team, scores, strict=True):
        m = s.mean
        line = (f"  {what:<22} {method.settings:<18} {s.refused:3} of {s.count:3} refused, {s.harmed:3} cut above 2 %; "
                f"cut {100 * m.cut:5.2f}, worst {100 * s.worst_cut:5.1f}; "
                f"error {m.error:6.2f}, worst {s.worst[0]:6.2f}; left {100 * m.left:5.1f}")  # fmt: skip
        if session.sure and s.count > s.refused:
            line += f"; confidence {s.sum.confidence / (s.count - s.refused):.2f}"
        print(line, flush=True)


def _site(team: Team, site: Site) -> None:
    print(site.title)
    for kind in VARIANTS:
        scores = [SiteScore() for _ in team]
        for case in site.cases:
            _judge(team, _variant(case, kind), scores)
        _print(team, kind, scores)


def _volume(team: Team, path: str) -> None:
    """All rows of all sides of a volume."""
    whole = cases.volume(path)
    scores = {kind: [SiteScore() for _ in team] for kind in _BARE + _OCCLUDED}
    for view in range(3 * _TURNS):
        at = (view // _TURNS, 360.0 / _TURNS * (view % _TURNS))
        coarse, fine = (from_side(whole, *at, side) for side in (_COARSE, _FINE))
        for kind in _BARE:
            _judge(team, _bare(coarse, kind), scores[kind])
        for kind, seen in zip(_OCCLUDED, (coarse, fine), strict=True):
            _judge(team, _occluded(seen), scores[kind])
    print(f"{whole.name}, {3 * _TURNS} views")
    for kind, row in scores.items():
        _print(team, kind, row)


def harm(sites: Sites, volumes: Sequence[str], methods: Sequence[Method], plugin: str | None) -> None:
    """Prints for every method the variants of every case, and volumes that nothing hides, from all sides, with and
    without scanned ranges, behind fluid and behind occluders."""
    print(
        "Do no harm: cut and left in %, error in slices of 128. No fetus: nothing can be cut, and all that counts "
        "is\nrefused or a low confidence"
    )
    with ExitStack() as stack:
        team = [(method, stack.enter_context(method.open(plugin))) for method in methods]
        for site in sites.all:
            _site(team, site)
        for path in volumes:
            _volume(team, path)
    print()
