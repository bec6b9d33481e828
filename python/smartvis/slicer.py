# SPDX-License-Identifier: MIT
"""The command ``smartvis-slicer``: a command-line module of 3D Slicer, MITK and whatever else knows the Slicer
execution model. It clips one volume as ``smartvis clip`` does. Exit codes are those of ``smartvis``."""

from __future__ import annotations

import argparse
import os
import shlex
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, NoReturn
from xml.sax.saxutils import escape

from . import _module, _options, _process, _runtime, cli
from ._files import Source, whole
from ._plugin import load
from ._products import write_as
from ._text import plain
from ._work import Row, fill

#: What leads a Python and its libraries: Slicer's own would lead another Python astray.
_LEADS = ("PYTHONHOME", "PYTHONPATH", "LD_LIBRARY_PATH", "SMARTVIS_PLUGIN", "SMARTVIS_HOST_SIM")


class _Progress:
    """Progress on the standard output: so many steps, each with what is being done."""

    def __init__(self, steps: int) -> None:
        self._steps, self._done = steps, 0

    def next(self, what: str) -> None:
        """The step before is done, and this one begins."""
        if self._done:
            self.end()
        title = f"<filter-name>{_module.TITLE}</filter-name>"
        _show(f"<filter-start>{title}<filter-comment>{what}</filter-comment></filter-start>")
        self._tell(self._done)
        self._done += 1

    def end(self, last: bool = False) -> None:
        """Nothing more is done, be it that this was the last step."""
        if last:
            self._tell(self._steps)
        _show("<filter-end></filter-end>")

    def _tell(self, done: int) -> None:
        _show(f"<filter-progress>{done / self._steps:.3f}</filter-progress>")


def _show(markup: str) -> None:
    print(markup, flush=True)


class _Parser(_options.Parser):
    """What is wrong is one sentence: a form has no room for how the command is used."""

    def error(self, message: str) -> NoReturn:
        raise ValueError(message)


def parser_of() -> argparse.ArgumentParser:
    """The command line: the fields of the form, and the options of what clips."""
    about = "Clips a volume as 3D Slicer and MITK ask for it; for a terminal there is `smartvis clip`."
    parser = _Parser(prog="smartvis-slicer", description=about, allow_abbrev=False)
    add = parser.add_argument
    add("scan", nargs="?", help="the volume, in any format that `smartvis clip` reads")
    add("--xml", action="store_true", help="print what the module is, for programs that make a form of it")
    add("--install", metavar="FOLDER", help="put the module into a folder, for the program's paths of modules")
    add("--returnparameterfile", metavar="FILE", help="where to write outcome, beams and note")
    add("--processinformationaddress", help=argparse.SUPPRESS)  # of what Slicer runs within itself
    for item in _module.RESULTS.values():
        add(f"--{item.name}", metavar="FILE", help=item.description)
    add("--direction", metavar="X,Y,Z", type=_options.numbers(3), help="where the camera looks, instead of --view")
    add("--spacing", metavar="X,Y,Z", type=_options.spacing_of, help="mm between voxels, instead of the file's")
    add("--level", type=_options.finite, help="grey value at which the model's tissue begins [Otsu's threshold]")
    _options.add_clip_options(parser)
    known = {option for action in parser._actions for option in action.option_strings}
    for key in load().parameters:
        if f"--{key}" not in known:  # short for --set KEY=VALUE
            how: dict[str, Any] = {
                "type": f"{key}={{}}".format,
                "default": argparse.SUPPRESS,
                "help": argparse.SUPPRESS,
            }
            add(f"--{key}", dest="set", action="append", **how)
    return parser


def main(words: Sequence[str] | None = None) -> int:
    """Runs the command line and returns the exit code."""
    return cli.guarded(lambda: _obey(_options.signed(sys.argv[1:] if words is None else words, "--direction")))


def _obey(words: Sequence[str]) -> int:
    parser = parser_of()
    args = parser.parse_args(words)
    if args.xml:
        print(_module.describe(load().parameters.values()), end="")
        return cli.OK
    if args.install is not None:
        return install(cli.make_folder(args.install))
    if args.scan is None:
        parser.error("no scan is given")
    return _clip(args)


def _clip(args: argparse.Namespace) -> int:
    """Clips the scan, and writes what is asked for."""
    wanted = {what: Path(path) for what, item in _module.RESULTS.items() if (path := getattr(args, item.name))}
    if not wanted:
        raise ValueError(f"no result is asked for: choose {', '.join(i.label for i in _module.RESULTS.values())}")
    if "mesh" in wanted and wanted["mesh"].suffix.lower() != ".ply":
        raise ValueError(f"--model: {wanted['mesh']}: models are written as .ply")
    settings = _options.settings_of(_as_of_clip(args, wanted))
    source = Source(args.scan, spacing=settings.spacing)
    source.check_one()
    progress = _Progress(2 + len(wanted))

    def write_all(image: Any, result: Any) -> None:
        for what, path in wanted.items():
            progress.next(f"writes the {_module.RESULTS[what].label.lower()}")
            write_as(image, result, path, what, settings.level)

    row = Row(args.scan, 0)
    doing = {"read": "reads the scan", "clip": "clips"}
    fill(row, source, settings, write_all, step=lambda what: progress.next(doing[what]))
    if row.state != "ok":
        progress.end()
        cli.tell(row.reason)
        return cli.CODES[row.state]
    print(escape(plain(cli.line_of(row))))
    if args.returnparameterfile:
        whole(Path(args.returnparameterfile), lambda part: part.write_text(_returned(row), "utf-8"))
    progress.end(last=True)
    return cli.OK


def _as_of_clip(args: argparse.Namespace, wanted: Iterable[str]) -> argparse.Namespace:
    """The command line of `smartvis clip` that says the same."""
    view = args.view if args.direction is None else args.direction
    return argparse.Namespace(**(vars(args) | {"view": view, "write": ",".join(wanted), "mirror": False}))


def _returned(row: Row) -> str:
    """The file of what comes back: a line for each."""
    note = " ".join(dict.fromkeys(filter(None, (row.why, row.try_this, row.doubt))))
    said = (cli.found_in(row), row.beams, note)
    lines = [f"{item.name} = {' '.join(text.split())}" for item, text in zip(_module.SAID, said, strict=True)]
    return plain("\n".join([*lines, ""]))


def install(folder: Path) -> int:
    """Puts the module there: a program for this Python, and what it says of itself, so that nobody waits for it. A
    program that looks for modules tries whatever lies in a folder, so they get one of their own."""
    name = f"{_module.TITLE}.bat" if _runtime.WINDOWS else _module.TITLE
    text = _batch() if _runtime.WINDOWS else _script()

    def write(part: Path) -> None:
        part.write_bytes(text.encode())
        part.chmod(0o755)

    whole(folder / name, write)
    description = _module.describe(load().parameters.values(), for_slicer=True)
    whole(folder / f"{_module.TITLE}.xml", lambda part: part.write_text(description, "utf-8"))
    print(plain(f"The module is in {folder.absolute()}: add that to the module paths of the program, and restart it"))
    return cli.OK


def _script() -> str:
    lines = ["#!/bin/sh", "# Written by `smartvis-slicer --install`: what leads this Python, and not the caller's own."]
    for name in _LEADS:
        value = os.environ.get(name)
        lines.append(f"unset {name}" if value is None else f"export {name}={shlex.quote(value)}")
    return "\n".join([*lines, f'exec {shlex.quote(_process.python())} -P -m smartvis.slicer "$@"', ""])


def _batch() -> str:
    lines = ["@echo off", *(f"set {name}={os.environ.get(name, '')}" for name in _LEADS)]
    return "\r\n".join([*lines, f'"{_process.python()}" -P -m smartvis.slicer %*', ""])


def run() -> NoReturn:
    """The entry of the console script."""
    cli.run(main)


if __name__ == "__main__":
    run()
