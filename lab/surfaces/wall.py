# SPDX-License-Identifier: MIT
"""The definition of wall on cases, with any of its constants changed; what it knows of a case. The definition is that
of src/ref, by the definitions' library (src/ref/definitions.h)."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import cases
import numpy as np
from cases import Case
from numpy.typing import NDArray
from scores import Calibration, SiteScore, judge
from sites import Site, Sites
from turns import tilted

_SURFACE, _DOUBTFUL = 0, 4  # of sv_wall_outcome


@dataclass
class Facts:
    """What the definition finds on the way (sv_wall_facts), in the order of sv_define_wall."""

    outcome: float
    threshold: float
    rays: float
    wall_rays: float
    gap_share: float
    wall: float
    spread: float
    fetus: float


@cache
def _library() -> Any:
    build = Path(os.environ.get("SV_BUILD_DIR") or Path(__file__).resolve().parents[2] / "build")
    library = ctypes.CDLL(str(build / "libsmartvis_definitions.so"))
    library.sv_define_wall.restype = ctypes.c_bool
    library.sv_define_wall_constant.restype = ctypes.c_char_p
    return library


@cache
def defaults() -> dict[str, float]:
    """Every constant of the definition, in its order; of what is on or off 1 or 0."""
    found: dict[str, float] = {}
    value = ctypes.c_double()
    while name := _library().sv_define_wall_constant(len(found), ctypes.byref(value)):
        found[name.decode()] = value.value
    return found


@dataclass
class Change:
    """What the definition is given: other constants, other grey levels, a turned camera. Numbers by their names."""

    constants: dict[str, float] = field(default_factory=dict)  #: of `defaults`
    levels: dict[str, float] = field(default_factory=dict)  #: gain, gamma, black: of `changed`
    near: dict[str, float] = field(default_factory=dict)  #: near_slices, near_gain, near_black: of `changed_near`
    beams: bool = False  #: it is told what a case knows of its beams
    tilt: tuple[float, float] = (0.0, 0.0)

    def set(self, text: str) -> None:
        """Takes "KEY=NUMBER". ValueError: it is none."""
        key, equals, value = text.partition("=")
        if not equals:
            raise ValueError(f"--set: '{text}' is no KEY=VALUE")
        try:
            number = float(value)
        except ValueError:
            raise ValueError(f"--set: '{text}' is no KEY=NUMBER") from None
        if key in ("gain", "gamma", "black"):
            self.levels[key] = number
        elif key in ("near_slices", "near_gain", "near_black"):
            self.near[key.removeprefix("near_")] = number
        elif key == "beams":
            self.beams = number != 0.0
        elif key in defaults():
            self.constants[key] = number
        else:
            raise ValueError(f"--set: there is no constant '{key}'")

    def turn(self, text: str) -> None:
        """Takes "X,Y", degrees. ValueError: it is none."""
        try:
            x, y = (float(part) for part in text.split(","))
        except ValueError:
            x = y = float("nan")
        if not (abs(x) <= 45.0 and abs(y) <= 45.0):
            raise ValueError(f"--tilt: '{text}' is no X,Y of -45 to 45 degrees")
        self.tilt = (x, y)

    def changed(self, case: Case) -> Case:
        """The case with its other levels."""
        if self.levels:
            case = cases.changed(case, **self.levels)
        if self.near.get("slices", 0.0) > 0.0:
            case = cases.changed_near(
                case, int(self.near["slices"]), self.near.get("gain", 1.0), self.near.get("black", 0.0)
            )
        return case


def ask(case: Case, change: Change) -> tuple[NDArray[np.float32], NDArray[np.float32], Facts]:
    """What the definition says of a case: depth, confidence, facts."""
    depth, confidence = np.zeros((2, *case.label.shape), np.float32)
    told = case.told if change.beams else cases.Told()
    fan = isinstance(told.beams, tuple)
    probe = np.zeros(13, np.float32)
    if told.probe is not None:
        probe[:9] = told.probe.ravel()
    if fan:
        probe[9:] = (*told.beams[0], told.beams[1])
    facts, text = np.zeros(8), ctypes.create_string_buffer(160)
    given = [case.full, case.first, case.end, np.array(case.full.shape[::-1], np.uint32), np.array(case.spacing), probe,
             np.array(list((defaults() | change.constants).values()))]  # fmt: skip
    arrays = [np.ascontiguousarray(array) for array in given] + [depth, confidence, facts]
    addresses = [ctypes.c_void_p(array.ctypes.data) for array in arrays]
    beams = ctypes.c_uint32(2 if fan else 1 if told.beams else 0)
    if not _library().sv_define_wall(beams, *addresses, text, ctypes.c_size_t(len(text))):
        raise ValueError(f"{case.name}: {text.value.decode()}")
    return depth, confidence, Facts(*facts.tolist())


def _case(case: Case, change: Change, score: SiteScore, clipped: Calibration) -> None:
    """The case is turned and gets other levels before; it is judged on its own levels. `clipped`: of cases that were
    not refused."""
    if any(change.tilt):
        case = tilted(case, change.tilt)
    depth, confidence, f = ask(change.changed(case), change)
    own = Calibration()
    s = judge(case, depth, confidence, own)
    score.add(case.name, s)
    score.calibration.add(own)
    if f.outcome == _SURFACE or (f.outcome == _DOUBTFUL and change.constants.get("clip_doubtful")):
        clipped.add(own)
    else:
        score.refused += 1
    seen = 100.0 * f.wall_rays / f.rays if f.rays else 0.0
    print(f"  {case.name:<4} {s.error:5.2f} / {100 * s.cut:4.1f} / {100 * s.left:4.1f}   outcome {f.outcome:.0f}, "
          f"T {f.threshold:.0f}, gap share {f.gap_share:.2f}, wall {f.wall:.0f}, spread {f.spread:.2f}, "
          f"seen by {seen:.0f} %, fetus {f.fetus:.3f}")  # fmt: skip


def _site(site: Site, change: Change) -> None:
    score, clipped = SiteScore(), Calibration()
    print(site)
    for case in site.cases:
        _case(case, change, score, clipped)
    print(f"  all  {score.line(True)}\n{score.fetus_line()}\n{score.calibration.line('wall')}")
    if score.refused:
        areas = ", ".join(f"{fault}{clipped.auc(what):.3f}" for fault, what in _FAULTS.items())
        print(f"  without the refused: {areas}")


_FAULTS = {"AUC ": "wrong", "cut ": "cut", "left ": "left"}


def wall(sites: Sites, volumes: Sequence[str], change: Change) -> None:
    """Prints it."""
    if not sites.all and not volumes:
        sites.add_scenes("201,0")
    for site in sites.all:
        _site(site, change)
    for path in volumes:
        if any(change.tilt):
            raise ValueError("--tilt: is for cases with a truth")
        case = cases.volume(path)
        _, _, f = ask(change.changed(case), change)
        print(f"{case.name}: outcome {f.outcome:.0f}, gap share {f.gap_share:.3f}, fetus {f.fetus:.3f}")
