# SPDX-License-Identifier: MIT
"""The judges of surfaces end to end on small cases that scenes export: every command, foreign files, wrong ones."""

import json
import os
import re
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from commands import COMMANDS, main

from smartvis import _host, _metaimage, cli

NOTHING = "method=mean evidence=1 min_gap=64"  # clips nothing
WALL, MEAN = "--method=method=wall", "--method=method=mean"
PLUGINS = Path(os.environ["SV_BUILD_DIR"]) / "tests" / "plugins"
Export = Callable[[str, int], str]


@dataclass
class Ended:
    code: int
    out: str
    err: str

    def found(self, pattern: str) -> list[str]:
        """What a pattern matches, of one group that, line by line."""
        return re.findall(pattern, self.out, re.MULTILINE)


@pytest.fixture
def judges(capsys: pytest.CaptureFixture[str]) -> Callable[..., Ended]:
    def run(*arguments: str) -> Ended:
        try:
            code = cli.guarded(lambda: main(arguments))
        except SystemExit as ended:
            code = int(ended.code or 0)
        return Ended(code, *capsys.readouterr())

    return run


@pytest.fixture(scope="session")
def case(exported: Export) -> str:
    return exported("E04", 64)


@pytest.fixture(scope="session")
def small(exported: Export) -> str:
    return exported("D01", 32)


def write_map(path: Path, side: int, value: int) -> str:
    _metaimage.write(path, np.full((side, side), value, np.uint8))
    return str(path)


# ---- the table


def test_what_clips_nothing_has_the_error_that_the_renderer_finds(judges: Callable[..., Ended], case: str) -> None:
    said = judges("table", "--case", case, "--method", NOTHING)
    (error,) = said.found(r"min_gap=64 +([\d.]+) /.*no confidence  1 refused$")
    steps = json.loads(_host.run(["measure", "--case", case, "--lowres", "64", "-"]))[0]["e_abs"]
    assert steps > 1 and abs(float(error) - steps * 128 / 64) < 0.05


def test_the_best_q_is_no_worse_and_a_confidence_has_its_calibration(judges: Callable[..., Ended], case: str) -> None:
    said = judges("table", "--case", case, "--method", "best method=mean", MEAN, WALL)
    (best,), (given,) = said.found(r"best q = [\d.]+ +([\d.]+) /"), said.found(r"method=mean  +([\d.]+) /")
    assert float(best) <= float(given)
    assert said.found(r"method=wall .* AUC [01]\.\d+ \(cut") and said.found(r"method=wall: it says / right")


def test_black_fluid_counts_where_maps_say_that_it_was_scanned(
    judges: Callable[..., Ended], case: str, tmp_path: Path
) -> None:
    maps = f"{write_map(tmp_path / 'from.mha', 64, 0)},{write_map(tmp_path / 'to.mha', 64, 64)}"
    assert judges("table", "--case", f"{case},{maps}", WALL).out != judges("table", "--case", case, WALL).out


# ---- no harm, flicker


def test_harm(judges: Callable[..., Ended], case: str) -> None:
    said = judges("harm", "--case", case, WALL, MEAN)
    assert len(said.found(r"method=wall  +. of   1 refused")) == 4
    assert len(said.found(r"^  bare, .*method=wall .* 0 cut above 2 %")) == 2


def test_the_same_frame_twice_does_not_flicker(judges: Callable[..., Ended], case: str) -> None:
    said = judges("flicker", "--case", case, "--case", case, WALL)
    assert said.found(r"(the truth moves) by") == ["the truth moves"]
    assert said.found(r"^  files, 2 frames: the truth moves by 0\.00$") and said.found(r"^    method=wall  +\+0\.00 ")


# ---- scans and marks


def test_with_nothing_told_a_set_has_the_tables_error(judges: Callable[..., Ended], case: str) -> None:
    (expected,) = judges("table", "--case", case, WALL).found(r"method=wall  +([\d.]+) /")
    assert judges("scans", "--case", case).found(r"^  method=wall +nothing .*  ([\d.]+) slices ") == [expected]


def test_marks_help(judges: Callable[..., Ended], case: str) -> None:
    """Without one the error is that of scans; it falls and never grows."""
    (expected,) = judges("scans", "--case", case).found(r"^  method=wall +beams .*  ([\d.]+) slices ")
    (said,) = judges("marks", "--case", case).found(r"^  files +1 +(.*)  slices$")
    errors = [float(row.split("/")[0]) for row in said.split("|")]
    assert abs(errors[0] - float(expected)) < 0.02 and errors[0] > errors[1] >= errors[2] >= errors[3]


def test_a_volume_with_labels(judges: Callable[..., Ended], exported: Export, tmp_path: Path) -> None:
    """One that is refused is hidden straight on by what its labels call tissue; no mark helps then."""
    full = tmp_path / "E01.mha"
    shutil.copy(exported("E01", 32).partition(",")[0], full)
    labels = np.repeat(np.array([1, 3], np.uint8), 16)[:, None, None] + np.zeros((1, 32, 32), np.uint8)
    _metaimage.write(tmp_path / "E01_label.mha", labels, (3.75, 3.75, 3.75))
    volume = ("--volume", str(full))
    said = judges("scans", *volume, "--method", NOTHING)
    assert len(said.found(r"^  to 20 degrees .* 0 / +0 / +9 .* cut +0\.00 % .* worst 100\.0$")) == 3
    assert len(said.found(r"^  orbit .* changes 0 times")) == 3
    said = judges("marks", *volume, "--method", NOTHING)
    assert said.found(r" 9 +([\d.]+ .*[1-9])  \| +\1  \| +\1  \| +\1  mm$")
    (tmp_path / "E01_label.mha").unlink()
    assert judges("marks", *volume).code == 3


# ---- the definition of wall


def test_a_folder_and_files_are_two_sites(
    judges: Callable[..., Ended], small: str, exported: Export, tmp_path: Path
) -> None:
    for name in ("E01", "M01"):
        for file, part in zip(small.split(","), ("full", "truth", "label"), strict=True):
            shutil.copy(file, tmp_path / f"{name}_{part}.mha")
    write_map(tmp_path / "scan_first.mha", 32, 0)
    write_map(tmp_path / "scan_end.mha", 32, 32)
    said = judges("wall", "--site", str(tmp_path), "--case", exported("E04", 32))
    assert len(said.found(r"^  all  ")) == 2 and said.found(r"^  (E01|M01) ") == ["E01", "M01"]


def test_constants_count(judges: Callable[..., Ended], small: str) -> None:
    as_it_is = judges("wall", "--case", small)
    assert as_it_is.found(r"^  all  ") and judges("wall", "--case", small, "--set", "fetus_level=0").out != as_it_is.out


@pytest.mark.parametrize("beams", [0, 1])
def test_limits_are_heeded_by_cases_and_volumes(judges: Callable[..., Ended], small: str, beams: int) -> None:
    sets = [f"--set={one}" for one in ("seen_share=1", "clear_share=2", f"beams={beams}")]
    said = judges("wall", "--case", small, "--volume", small.partition(",")[0], *sets)
    assert len(said.found("outcome 3,")) == 2


def test_a_turned_camera(judges: Callable[..., Ended], small: str) -> None:
    assert judges("wall", "--tilt=10,-5", "--case", small).found(r" 10,-5 .*outcome 0")


# ---- what is wrong


@pytest.mark.parametrize(("arguments", "code", "words"), [
    ((), 2, "COMMAND"),
    (("nothing",), 2, "'nothing'"),
    (("table", "--nothing"), 2, "--nothing"),
    (("table", "--scenes", "1"), 2, "--scenes: '1' is no SEED,POSE"),
    (("table", "--random", "7,0"), 2, "--random: '7,0' is no SEED,COUNT with a count of 1 .. 128"),
    (("table", "--case", "SMALL_FULL"), 2, "FULL,TRUTH,LABEL"),
    (("table", "--site", "nowhere"), 3, "nowhere: there is no NAME_full.mha"),
    (("table", "--case", "SMALL_FULL,SMALL_FULL,SMALL_FULL"), 3, "DimSize is 32 32 32, expected 32 32 1"),
    (("table", "--case", "SMALL,MAP,MAP"), 3, "from.mha: DimSize is 64 64 1, expected 32 32 1"),
    (("table", "--case", "SMALL", "--plugin", "NO_SYMBOL"), 4, "no_symbol.so"),
    (("table", "--case", "SMALL", WALL, "--plugin", "ZEROS"), 2, "method"),
    (("table", "--case", "SMALL", "--method", "method"), 2, "'method' is no KEY=VALUE"),
    *((("wall", f"--tilt={wrong}", "--case", "SMALL"), 2, f"--tilt: '{wrong}' is no X,Y of -45 to 45 degrees")
      for wrong in ("1", "50,0", "0,x", "1,2,3")),
    *((("wall", "--set", wrong, "--case", "SMALL"), 2, "--set: ")
      for wrong in ("fetus_level", "fetus_level=x", "nothing=1")),
])  # fmt: skip
def test_what_is_wrong_is_told(judges: Callable[..., Ended], small: str, tmp_path: Path,
                               arguments: tuple[str, ...], code: int, words: str) -> None:  # fmt: skip
    named = {"SMALL_FULL": small.partition(",")[0], "SMALL": small, "MAP": write_map(tmp_path / "from.mha", 64, 0),
             "NO_SYMBOL": str(PLUGINS / "no_symbol.so"), "ZEROS": str(PLUGINS / "zeros.so")}  # fmt: skip
    told = [re.sub("|".join(named), lambda name: named[name[0]], argument) for argument in arguments]
    ended = judges(*told)
    assert ended.code == code and words in ended.err


def test_help_names_every_command(judges: Callable[..., Ended]) -> None:
    ended = judges("--help")
    assert ended.code == 0 and all(f"\n  {name} " in ended.out for name in COMMANDS)
