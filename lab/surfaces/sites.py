# SPDX-License-Identifier: MIT
"""The sites that surfaces are judged on, sets of cases, and the methods that are."""

from __future__ import annotations

import re
from collections.abc import Iterable
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from pathlib import Path

import cases
from cases import Case
from scores import Score, SiteScore, judge
from session import Session, opened

from smartvis._errors import FileError
from smartvis._scene import CASES

_QS = [0.05 * i for i in range(31)]
_MOST_RANDOM = 128


@dataclass
class Site:
    """A set of cases."""

    title: str
    cases: list[Case] = field(default_factory=list)

    def __str__(self) -> str:
        return f"{self.title} ({len(self.cases)} cases)"


def _numbers(option: str, text: str, expected: str) -> tuple[int, int]:
    if not re.fullmatch(r"\d{1,9},\d{1,9}", text):
        raise ValueError(f"--{option}: '{text}' is no {expected}")
    first, second = map(int, text.split(","))
    return first, second


class Sites:
    """All sets of a command line: scenes together are one, files together another, a folder is one of its own."""

    def __init__(self) -> None:
        self.all: list[Site] = []

    @property
    def files(self) -> list[Site]:
        """The set of files, if there is one."""
        return [site for site in self.all if site.title == "files"]

    def _set_of(self, title: str) -> Site:
        for site in self.all:
            if site.title.startswith(title):
                return site
        self.all.append(Site(title))
        return self.all[-1]

    def _add_scenes(self, names: Iterable[str], title: str, seed: int = 0, pose: int = 0) -> None:
        site = self._set_of("scenes")
        for name in names:
            site.cases += cases.scene(name, seed, pose)
        site.title += f" {title}"

    def add_scenes(self, text: str) -> None:
        """The nine scenes of "SEED,POSE"."""
        seed, pose = _numbers("scenes", text, "SEED,POSE")
        self._add_scenes(CASES, text, seed, pose)

    def add_scene(self, name: str) -> None:
        """A scene by its name or file, at its own seed."""
        self._add_scenes([name], name)

    def add_random(self, text: str) -> None:
        """The first random scenes of "SEED,COUNT"."""
        self._add_random("random", text)

    def add_greys(self, text: str) -> None:
        """The same scenes in random greys."""
        self._add_random("greys", text)

    def _add_random(self, kind: str, text: str) -> None:
        expected = f"SEED,COUNT with a count of 1 .. {_MOST_RANDOM}"
        seed, count = _numbers(kind, text, expected)
        if not 1 <= count <= _MOST_RANDOM:
            raise ValueError(f"--{kind}: '{text}' is no {expected}")
        letter = kind[0].upper()
        names = [f"{letter}{seed}_{n}" for n in range(count)]
        self._add_scenes(names, f"{letter}{seed}_0..{count - 1}")

    def add_folder(self, folder: str) -> None:
        """Every NAME_full.mha of a folder."""
        found = sorted(Path(folder).glob("*_full.mha"))
        if not found:
            raise FileError(f"{folder}: there is no NAME_full.mha")
        names = [path.name.removesuffix("_full.mha") for path in found]
        self.all.append(Site(folder, [cases.in_folder(Path(folder), name) for name in names]))

    def add_files(self, text: str) -> None:
        """One case."""
        self._set_of("files").cases.append(cases.files(text))


@dataclass(frozen=True)
class Method:
    """Settings of a plugin, one for all cases of a set."""

    settings: str  #: "key=value", parted by spaces
    best_q: bool = False  #: at the single q that gives the least mean error over the set

    def open(self, plugin: str | None, told: str = "nothing") -> AbstractContextManager[Session]:
        """A session of it, which is closed in the end."""
        return opened(plugin, self.settings, told)


def judge_case(session: Session, case: Case, to: SiteScore) -> Score:
    """Adds what comes of a frame."""
    result = session.clip(case)
    score = judge(case, result.depth, result.confidence, to.calibration)
    to.add(case.name, score)
    to.refused += not result.clips
    to.answers[session.answer] += 1
    return score


def judge_site(session: Session, site: Site, best_q: bool) -> tuple[SiteScore, list[Score], float | None]:
    """What a session comes to on a set, each case's score, and the best q if that is wanted."""
    best = None
    if best_q:
        errors = []
        for q in _QS:
            session.set(q=q)
            trial = SiteScore()
            for case in site.cases:
                judge_case(session, case, trial)
            errors.append(trial.sum.error)
        best = _QS[errors.index(min(errors))]
        session.set(q=best)
    score = SiteScore()
    each = [judge_case(session, case, score) for case in site.cases]
    return score, each, best
