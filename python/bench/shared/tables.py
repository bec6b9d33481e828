# SPDX-License-Identifier: MIT
"""What a benchmark leaves behind: a table of all its numbers, and a plot."""

import argparse
import csv
from collections.abc import Callable
from typing import Any

Row = dict[str, Any]


def add_outputs(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--csv", help="all numbers")
    parser.add_argument("--svg", help="the plot")


def save(rows: list[Row], given: argparse.Namespace, plot: Callable[[list[Row], str], None]) -> None:
    """Writes what `add_outputs` was given."""
    if given.csv:
        with open(given.csv, "w", newline="") as file:
            table = csv.DictWriter(file, rows[0])
            table.writeheader()
            table.writerows(rows)
    if given.svg:
        plot(rows, given.svg)
