# SPDX-License-Identifier: MIT
"""A batch with several values of a setting: one batch for each choice of them, in a folder of its own, and beside
these folders a table and a page of all."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from ._study import write_overview
from ._work import Settings


def choices(pairs: Sequence[str]) -> dict[str, list[str]]:
    """Pairs KEY=VALUE, where VALUE may be several, V1,V2: for each choice the pairs, by what tells it from others."""
    values = {key: text.split(",") for key, _, text in (pair.partition("=") for pair in pairs)}
    chosen: dict[str, list[str]] = {}
    for one in itertools.product(*values.values()):
        made = dict(zip(values, one, strict=True))
        told = "_".join(f"{key}={value}" for key, value in made.items() if len(values[key]) > 1)
        chosen[told] = [f"{key}={value}" for key, value in made.items()]
    return chosen


def sweep(
    each: Mapping[str, Settings], out: Path, batch: Callable[[Settings, Path], list[dict[str, Any]]]
) -> list[dict[str, Any]]:
    """Calls `batch` for each, with its folder, and returns the rows of all. table.csv and index.html have what was
    done, also if a batch could not be."""
    rows: list[tuple[dict[str, Any], Path]] = []
    try:
        for name, settings in each.items():
            rows += [(row, out / name) for row in batch(settings, out / name)]
    finally:
        done = write_overview(out, rows)
    return done
