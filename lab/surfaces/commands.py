# SPDX-License-Identifier: MIT
"""Judges surfaces on sites: scenes, and volumes of other programs with their truth. Errors are in slices of 128; cut:
% of the fetus' rays cut by more than 2 slices; left: % of the labelled rays with an occluder."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from typing import Any

from flicker import flicker
from harm import harm
from scans import mark, scans
from sites import Method, Sites
from table import table
from wall import Change, wall

_MEAN, _WALL = Method("method=mean", best_q=True), Method("method=wall")

#: What a command does with a command line, and what it says of itself.
COMMANDS: dict[str, tuple[Callable[[Any], None], str]] = {
    "table": (
        lambda given: table(given.sites, given.method, given.plugin),
        "every method on every site: error, cut, left, worst case, AUC and calibration of the confidence",
    ),
    "harm": (
        lambda given: harm(given.sites, given.volume, given.method, given.plugin),
        "bare cases, cases without a fetus, with a bladder; volumes that nothing hides, from 36 sides",
    ),
    "scans": (
        lambda given: scans(given.sites, given.volume, given.method, given.plugin),
        "verdict, error, cut, left of sets and of volumes from all sides, with beams told, the pose alone, nothing",
    ),
    "marks": (
        lambda given: mark(given.sites, given.volume, given.method, given.plugin),
        "error, cut, left after 0, 1, 3 and 6 marks of a user who knows the truth; volumes from nine views",
    ),
    "flicker": (
        lambda given: flicker(given.sites, given.method, given.plugin),
        "what the renderings of four moving scenes, or of the frames of --case, flicker beyond the truth's",
    ),
    "wall": (
        lambda given: wall(given.sites, given.volume, given.wall),
        "the definition of wall with any of its constants changed (--set); what it knows of a case",
    ),
}

_FOLDER_HELP = """every NAME_full.mha there, with NAME_truth, NAME_label, NAME_first and NAME_end.mha, or scan_first and
scan_end.mha for all"""
_SET_HELP = """wall: another value of a constant, a field of sv_wall_settings; or gain, gamma, black: change the grey
levels first, the judgement is on the unchanged ones; near_slices, near_gain, near_black: so many first scanned slices
only; beams=1: tell the beams"""
_VOLUME_HELP = """harm, scans: a volume that nothing hides; scans, marks: one with FILE_label.mha beside it; wall: its
verdict; repeatable"""
_METHOD_HELP = """'KEY=VALUE ...', or 'best KEY=VALUE ...' at its best single q; repeatable [best method=mean;
method=wall]"""


class _Take(argparse.Action):
    """An option that may be given often; `const` takes its text."""

    def __call__(self, parser: argparse.ArgumentParser, given: Any, text: Any, option: str | None = None) -> None:
        given.taken = [*(given.taken or []), (self.const, text)]


def _method(text: str) -> Method:
    best = text.removeprefix("best ")
    return Method(best, best_q=best != text)


def parser_of(sites: Sites, change: Change) -> argparse.ArgumentParser:
    """The command line. Sites and change take their options when all of it was read."""
    lines = "\n".join(f"  {name:<9} {says}" for name, (_, says) in COMMANDS.items())
    raw = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser("surfaces", description=f"{__doc__}\n\n{lines}", formatter_class=raw)
    parser.add_argument("command", choices=COMMANDS, metavar="COMMAND")
    taken = parser.add_argument_group("cases and constants, each repeatable")
    for name, metavar, take, says in (
        ("scenes", "SEED,POSE", sites.add_scenes, "the nine scenes at 128^3 [201,0]"),
        ("scene", "NAME", sites.add_scene, "one by name or file, at 128^3: H01, or R7_3, number 3 of the random set 7"),
        ("random", "SEED,COUNT", sites.add_random, "the first random scenes of a set; all scenes are one site"),
        ("greys", "SEED,COUNT", sites.add_greys, "the same in random greys, an echo for every tissue but fluid"),
        ("site", "FOLDER", sites.add_folder, _FOLDER_HELP),
        (
            "case",
            "FILES",
            sites.add_files,
            "FULL,TRUTH,LABEL[,FIRST,END] as host_sim report has them; all are one site",
        ),
        ("set", "KEY=VALUE", change.set, _SET_HELP),
        ("tilt", "X,Y", change.turn, "wall: turn the camera by so many degrees about x and then y first"),
    ):
        taken.add_argument(f"--{name}", metavar=metavar, action=_Take, const=take, dest="taken", help=says)
    parser.add_argument("--volume", metavar="FILE", action="append", default=[], help=_VOLUME_HELP)
    parser.add_argument("--method", metavar="SETTINGS", action="append", type=_method, help=_METHOD_HELP)
    parser.add_argument("--plugin", metavar="PATH", help="library to judge [the package's]")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs a command line; the exit code is one of host_sim's."""
    sites, change = Sites(), Change()
    given = parser_of(sites, change).parse_args(arguments)
    given.sites, given.wall = sites, change
    for take, text in given.taken or []:
        take(text)
    run, _ = COMMANDS[given.command]
    given.method = given.method or ([_WALL] if given.command in ("scans", "marks") else [_MEAN, _WALL])
    if not sites.all and given.command in ("table", "harm"):
        sites.add_scenes("201,0")
    run(given)
    return 0
