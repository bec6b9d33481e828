# SPDX-License-Identifier: MIT
"""python/bench/ still runs, on little: how fast something is, no test says."""

import re
import subprocess
import sys

import pytest
from conftest import LONG, SOURCE

BENCH = SOURCE / "python" / "bench"
PRINTED = {
    ("growth.py", "--size", "64", "--frames", "2"): r"64 x 64 x 64 \|( +[\d.]+){5} \|( +-?[\d.]+){3}",
    ("serve.py", "32", "3"): r"[\d.]+ volumes of 32\^3 a second, there and back",
    (
        "surfaces.py",
        "--quick",
        "--size",
        "128",
        "--no-truth",
    ): r"mean kernel 23 +128 \| [\d.]+ \([\d.]+\) [\d.]+ \| \d(\.\d)?e-0[5-9] ",
}


def test_all_are_tried() -> None:
    assert {path.name for path in BENCH.glob("*.py")} == {name for name, *_ in PRINTED}


@pytest.mark.parametrize("command", PRINTED, ids=lambda command: command[0])
def test_it_prints_what_it_measures(command: tuple[str, ...]) -> None:
    program = [sys.executable, "-P", str(BENCH / command[0]), *command[1:]]
    done = subprocess.run(program, capture_output=True, text=True, timeout=LONG, check=False)
    assert done.returncode == 0 and re.search(PRINTED[command], done.stdout), done.stderr
