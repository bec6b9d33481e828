# SPDX-License-Identifier: MIT
"""How calm a surface is in a moving scene: what the renderings flicker beyond the truth's. Nothing remembers unless its
settings say so. A method at its best q takes the one that is best for these frames."""

from __future__ import annotations

from collections.abc import Sequence

import cases
import numpy as np
import rays
from cases import Case
from scores import total
from session import Session
from sites import Method, Site, Sites, judge_site

from smartvis._errors import FileError

_SCENES, _FRAMES, _SEED, _GOAL = ("E01", "E03", "M02", "D01"), 20, 401, 0.5


def _move(before: Case, now: Case, ends: list[rays.Maps]) -> float:
    """Mean move of the rays' ends, slices of 128."""
    both = before.labelled & now.labelled
    moved = abs(ends[1][both] - ends[0][both]).astype(np.float64)
    return 128.0 / now.slices * total(moved) / moved.size if moved.size else 0.0


def _check(site: Site) -> None:
    if len(site.cases) < 2:
        raise ValueError(f"flicker: a sequence of {len(site.cases)} frame")
    height, width = site.cases[0].label.shape
    for case in site.cases:
        if case.label.shape != (height, width):
            size = "{1} x {0}".format(*case.label.shape)
            raise FileError(f"{case.name}: {size} rays, the first frame has {width} x {height}")


def _flicker_of(session: Session, site: Site) -> tuple[float, float]:
    """How far ends move from frame to frame in the result, and in the truth."""
    ends = [rays.ends(case.full, session.clip(case).depth) for case in site.cases]
    result = truth = 0.0
    for n in range(1, len(ends)):
        pair = (site.cases[n - 1], site.cases[n])
        result += _move(*pair, ends[n - 1 : n + 1]) / (len(ends) - 1)
        truth += _move(*pair, [case.truth for case in pair]) / (len(ends) - 1)
    return result, truth


def _sequence(site: Site, name: str, methods: Sequence[Method], plugin: str | None) -> list[float]:
    """Every method's flicker beyond the truth's."""
    _check(site)
    beyond: list[float] = []
    for method in methods:
        with method.open(plugin) as session:
            score, _, _ = judge_site(session, site, method.best_q)
            result, truth = _flicker_of(session, site)
        if not beyond:
            print(f"  {name}, {len(site.cases)} frames: the truth moves by {truth:.2f}")
        print(f"    {method.settings:<28} {result - truth:+5.2f}   error {score.mean.error:5.2f}", flush=True)
        beyond.append(result - truth)
    return beyond


def flicker(sites: Sites, methods: Sequence[Method], plugin: str | None) -> None:
    """Prints it of the set of files as the frames of one sequence, or without one of four scenes that move."""
    print("Flicker: move of the rendered ends from frame to frame beyond the truth's, slices of 128 "
          f"(goal {_GOAL:.1f}); error")  # fmt: skip
    for site in sites.files:
        _sequence(site, site.title, methods, plugin)
    if not sites.files:
        moving = (Site(name, list(cases.scene(name, _SEED, frames=_FRAMES))) for name in _SCENES)
        beyond = np.cumsum([_sequence(site, site.title, methods, plugin) for site in moving], axis=0)[-1]
        for method, sum_of in zip(methods, beyond, strict=True):
            above = "" if sum_of <= _GOAL * len(_SCENES) else "  above the goal"
            print(f"  mean of {len(_SCENES)}: {method.settings:<28} {sum_of / len(_SCENES):+5.2f}{above}")
    print()
