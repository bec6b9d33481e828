# SPDX-License-Identifier: MIT
"""How good a surface is: Eq. 4.6 of the thesis, how much of the fetus is cut and of occluders is left, and whether the
confidence tells. Every labelled ray counts as hidden."""

from __future__ import annotations

from collections import Counter
from dataclasses import astuple, dataclass, field
from typing import Any

import numpy as np
import rays
from cases import FETUS, Case
from numpy.typing import NDArray

TOLERANCE = 2.0  # slices of 128, or mm, by which a ray may be off
BINS = 2048  # of the confidence: most of it is above 0.98, where coarse bins would merge different values
_MUCH_CUT, _HARM_CUT, _LEAST_RAYS = 0.1, 0.02, 100


def total(values: NDArray[Any]) -> float:
    """The sum in the order of the rays: the same bits with every version of numpy."""
    return float(np.cumsum(values.ravel(), dtype=np.float64)[-1]) if values.size else 0.0


@dataclass
class Score:
    """Errors are in slices of 128, the rest are shares."""

    error: float = 0.0  #: mean over the labelled rays of |end in the result - end in the truth|
    cut: float = 0.0  #: of the fetus' rays, those that end more than 2 slices too deep
    left: float = 0.0  #: of the labelled rays, those that end more than 2 slices too early
    fetus: float = 0.0  #: the error of the fetus' rays alone
    #: By the admissible depths, which know nothing of a renderer, so haze in the sac is neither: of the fetus' rays,
    #: those whose surface lies more than 2 mm behind `far`, and in front of `near`. NaN: not known.
    deep: float = 0.0
    shallow: float = 0.0
    confidence: float = 0.0  #: mean over the labelled rays

    def plus(self, other: Score) -> Score:
        """The sum."""
        return Score(*(a + b for a, b in zip(astuple(self), astuple(other), strict=True)))


class Calibration:
    """Labelled rays by confidence: right ones (error at most 2 slices), wrong ones, and those that end too deep."""

    def __init__(self) -> None:
        self.right, self.wrong, self.cut = np.zeros((3, BINS), np.int64)

    def add(self, other: Calibration) -> None:
        """Its rays, too."""
        for name in ("right", "wrong", "cut"):
            getattr(self, name)[:] += getattr(other, name)

    def auc(self, fault: str = "wrong") -> float:
        """Area under the ROC curve of the confidence as a predictor of rays that are "wrong", "cut" or "left"."""
        bad = self.wrong - self.cut if fault == "left" else getattr(self, fault)
        below = np.cumsum(bad) - bad  # of less confidence
        pairs = float((self.right * (2 * below + bad)).sum()) / 2
        all_pairs = float(self.right.sum()) * float(bad.sum())
        return pairs / all_pairs if all_pairs > 0 else 1.0

    def reliability(self, low: float, high: float) -> tuple[int, float, float]:
        """Of rays with a confidence of low .. high: how many, the share of right ones, the mean confidence."""
        confidence = np.arange(BINS) / (BINS - 1)
        there = (confidence >= low) & (confidence < high)
        count = np.where(there, self.right + self.wrong, 0)
        rays_there = int(count.sum())
        if rays_there == 0:
            return 0, np.nan, np.nan
        return rays_there, int(self.right[there].sum()) / rays_there, total(confidence * count) / rays_there

    def line(self, what: str) -> str:
        """For every tenth of the confidence with at least 100 rays: what it says on average, the share that is right,
        and their share of all."""
        out = f"  {what}: it says / right / share of the rays, %\n   "
        everything = self.reliability(0.0, 1.1)[0]
        for tenth in range(10):
            count, right, mean = self.reliability(0.1 * tenth, 1.1 if tenth == 9 else 0.1 * (tenth + 1))
            if count >= _LEAST_RAYS:
                out += f" {mean:.2f}/{right:.2f}/{100.0 * count / everything:.0f}"
        return out


def _mean(sums: Any, count: Any) -> float:
    """A float32, as the report's measures; 0 over none."""
    return float(np.float32(float(sums) / float(count))) if count else 0.0


def judge(case: Case, depth: NDArray[np.float32], confidence: NDArray[np.float32] | None, calibration: Calibration,
          original: NDArray[np.uint8] | None = None) -> Score:  # fmt: skip
    """The score of a surface, on the levels of `original` (None: the case's own)."""
    scale = np.float32(128) / np.float32(case.slices)
    tolerance = int(np.float32(TOLERANCE) / scale)
    there, fetus = case.labelled, case.label == FETUS
    off = (case.truth - rays.ends(case.full if original is None else original, depth)).astype(np.int64)
    wrong, cut, left = there & (abs(off) > tolerance), fetus & (off < -tolerance), there & (off > tolerance)
    sure = np.zeros(depth.shape, np.float32) if confidence is None else confidence
    bins = (sure * np.float32(BINS - 1) + np.float32(0.5)).astype(np.int64)
    calibration.right += np.bincount(bins[there & ~wrong], minlength=BINS)
    calibration.wrong += np.bincount(bins[wrong], minlength=BINS)
    calibration.cut += np.bincount(bins[wrong & (off < 0)], minlength=BINS)
    deep = shallow = float("nan")
    if case.near is not None and case.far is not None:
        room = np.float32(TOLERANCE / case.spacing[2])
        count = max(int(fetus.sum()), 1)
        deep = int((depth > case.far + room)[fetus].sum()) / count
        shallow = int((depth < case.near - room)[fetus].sum()) / count
    return Score(
        error=float(scale) * _mean(abs(off[there]).sum(), there.sum()),
        cut=_mean(cut.sum(), fetus.sum()),
        left=_mean(left.sum(), there.sum()),
        fetus=float(scale) * _mean(abs(off[fetus]).sum(), fetus.sum()),
        deep=deep,
        shallow=shallow,
        confidence=total(sure[there].astype(np.float64)) / max(int(there.sum()), 1),
    )


@dataclass
class SiteScore:
    """What scores of cases add up to."""

    sum: Score = field(default_factory=Score)
    worst: tuple[float, str] = (0.0, "")  #: error of a case
    surest: tuple[float, str] = (0.0, "")  #: mean confidence of a case of which more than a tenth is cut
    worst_cut: float = 0.0
    count: int = 0
    harmed: int = 0  #: cases of which more than 2 % of the fetus' rays are cut
    refused: int = 0  #: cases that the method does not clip
    answers: Counter[str] = field(default_factory=Counter)
    calibration: Calibration = field(default_factory=Calibration)

    def add(self, name: str, score: Score) -> None:
        """One more case."""
        self.sum = self.sum.plus(score)
        if self.count == 0 or score.error > self.worst[0]:
            self.worst = (score.error, name)
        self.worst_cut = max(self.worst_cut, score.cut)
        self.harmed += score.cut > _HARM_CUT
        if score.cut > _MUCH_CUT and score.confidence > self.surest[0]:
            self.surest = (score.confidence, name)
        self.count += 1

    @property
    def mean(self) -> Score:
        """Over the cases."""
        return Score(*(value / max(self.count, 1) for value in astuple(self.sum)))

    @property
    def surest_words(self) -> str:
        """The surest case of which more than a tenth is cut, if there is one."""
        return f"  cut above 10 %: confidence {self.surest[0]:.2f} {self.surest[1]}" if self.surest[0] > 0 else ""

    def line(self, sure: bool) -> str:
        """Error / cut / left, worst case, and if it is `sure` the confidence's AUC."""
        m, c = self.mean, self.calibration
        out = (
            f"{m.error:5.2f} / {100 * m.cut:5.2f} / {100 * m.left:5.2f}  worst {self.worst[0]:5.2f} {self.worst[1]:<4}"
        )
        if sure:
            out += f"  AUC {c.auc():.3f} (cut {c.auc('cut'):.3f}, left {c.auc('left'):.3f}){self.surest_words}"
        else:
            out += "  no confidence"
        return out + (f"  {self.refused} refused" if self.refused else "")

    def fetus_line(self) -> str:
        """The error of the fetus' rays, and what the admissible depths say if all cases have them."""
        m = self.mean
        out = f"       the fetus' rays: error {m.fetus:.2f}"
        if np.isnan(m.deep):
            return out
        return out + f"; by the admissible depths {100 * m.deep:.1f} % cut, {100 * m.shallow:.1f} % left"
