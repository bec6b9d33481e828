# SPDX-License-Identifier: MIT
"""Questions to the reader that nobody would ask: any words in place of a path, a number or a format. It answers each
of them, or says what is wrong; it never dies, and leaves nothing behind."""

import os
import random
from pathlib import Path
from typing import Any

import pytest
import SimpleITK as sitk
from conftest import layers

from smartvis import _process
from smartvis._errors import FileError, HostError, OutputError

SUFFIXES = (".nrrd", ".nii", ".mha", ".vtk", ".tif")


def anything(dice: random.Random, files: list[str]):
    """What might stand in a question's place."""
    word = "".join(
        chr(dice.choice([0, 1, 7, 10, 27, 32, 37, 46, 47, 92, 97, 126, 127, 0xE9, 0x4E00, 0xDC80]))
        for _ in range(dice.randint(0, 12))
    )
    numbers: list[Any] = [None, True, -1, 0, 1 << 80, 2.5, float("nan"), (), [], {}]
    words = [b"\0", "", word, f"/{word}", word * 500, [word], ("x",) * 5]
    return dice.choice([*numbers, *words, *files])


def question(dice: random.Random, files: list[str], out: Path):
    """The reader's function and its arguments, some of them right."""
    path = dice.choice(files) if dice.random() < 0.5 else anything(dice, files)
    mirror = dice.choice([False, True, anything(dice, files)])
    kind = dice.randrange(8)
    if kind < 4:
        return ("open", path, mirror)
    if kind < 7:
        return ("read", path, mirror, dice.choice([0, 0, 1, -1, anything(dice, files)]))
    # Where it may write: nothing else than the folder of this test.
    part = str(out / f"part{dice.choice((*SUFFIXES, '', '.x'))}")
    return ("write", path, part, dice.choice([anything(dice, files), tuple(anything(dice, files) for _ in range(5))]))


def ask_all(count: int, folder: Path, seed: int) -> None:
    dice, out = random.Random(seed), folder / "out"
    out.mkdir()
    files = [str(folder / f"scan{suffix}") for suffix in SUFFIXES]
    for path in files:
        sitk.WriteImage(sitk.GetImageFromArray(layers((8, 7, 6))), path)
    files += [str(folder), str(folder / "none.nrrd")]
    for _ in range(count):
        asked = question(dice, files, out)
        said = "it is answered"
        try:
            _process.ask(*asked)
        except (FileError, HostError, OutputError, MemoryError) as error:
            said = str(error)
        wrong = [words for words in ("Traceback", "crashes at it", "was ended") if words in said]
        assert said.strip() and not wrong, (asked, said)
    assert _process._child is not None
    # Temporary files of what was read are gone with it.
    assert len(os.listdir(f"/proc/{_process._child._process.pid}/fd")) < 20


@pytest.mark.parametrize("seed", [1])
def test_any_question_is_answered(seed: int, tmp_path: Path) -> None:
    ask_all(600, tmp_path, seed)


@pytest.mark.night
@pytest.mark.parametrize("seed", range(4))
def test_any_question_is_answered_for_long(seed: int, tmp_path: Path) -> None:
    ask_all(25_000, tmp_path, 100 + seed)
