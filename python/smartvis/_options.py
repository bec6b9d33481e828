# SPDX-License-Identifier: MIT
"""What a command line of this package says: its words, values and options, and the settings that they make."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Sequence
from typing import Any

from ._files import WRITTEN
from ._plugin import load
from ._products import WRITABLE
from ._seen import SIDES
from ._text import plain
from ._view import PLACES
from ._work import Settings


class Parser(argparse.ArgumentParser):
    """Shows words of the command line, which a shell may have made of files' names."""

    def _print_message(self, message: str, file: Any = None) -> None:
        super()._print_message(plain(message), file)


def signed(words: Sequence[str], *more: str) -> list[str]:
    """Values that begin with "-" joined to their options: argparse takes "-z" and "-60,0" for options."""
    options = ("--probe", "--view", "--window", "--level", *more)
    joined: list[str] = []
    for word in words:
        if joined and joined[-1] in options and word[:1] == "-" != word[1:2]:
            joined[-1] += f"={word}"
        else:
            joined.append(word)
    return joined


def numbers(count: int, expected: str = "", holds: Callable[[Any], bool] = lambda values: True) -> Any:
    """An argparse type: `count` numbers with commas between them, of which something holds."""

    def parse(text: str) -> tuple[float, ...]:
        try:
            values = tuple(float.fromhex(part) if "0x" in part.lower() else float(part) for part in text.split(","))
        except ValueError:
            values = ()
        if len(values) != count:
            raise argparse.ArgumentTypeError(f"'{text}', expected {count} numbers with commas between them")
        if not holds(values):
            raise argparse.ArgumentTypeError(f"'{text}', expected {expected}")
        return values

    return parse


window_of = numbers(2, "two finite numbers, the lower first", lambda v: -math.inf < v[0] < v[1] < math.inf)
spacing_of = numbers(3, "three lengths in mm, each 1e-6 .. 1e6", lambda v: all(1e-6 <= length <= 1e6 for length in v))


def finite(text: str) -> float:
    """An argparse type: a finite number."""
    return float(numbers(1, "a finite number", lambda v: math.isfinite(v[0]))(text)[0])


def positive(text: str) -> int:
    """An argparse type: a whole number above 0."""
    if not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"'{text}', expected a whole number above 0")
    return int(text)


def view_of(text: str) -> tuple[float, ...] | str:
    """An argparse type: a place around the patient, or a direction."""
    if text in PLACES:
        return text
    try:
        direction: tuple[float, ...] = numbers(3)(text)
    except argparse.ArgumentTypeError as error:
        raise argparse.ArgumentTypeError(f"{error}, or one of {', '.join(PLACES)}") from None
    return direction


def add_clip_options(parser: argparse.ArgumentParser) -> None:
    """The options of everything that clips."""
    add, places, sides = parser.add_argument, ", ".join(PLACES), ", ".join(SIDES)
    what = "auto: all but the zeros, or the other constant, outside a fan; zeros: all but zeros; all: everything [auto]"
    add("--plugin", metavar="PATH", help="plugin library [the package's own]")
    add("--method", metavar="NAME", help="short for --set method=NAME")
    add("--set", metavar="KEY=VALUE", action="append", default=[], help="a parameter; repeatable")
    add("--view", metavar="PLACE", type=view_of, help=f"where the camera is, {places}, or looks, X,Y,Z [probe]")
    add("--window", metavar="LOW,HIGH", type=window_of, help="values that become 0 and 255")
    add("--scanned", choices=("auto", "zeros", "all"), default="auto", help=what)
    where = f"where it was: {sides}; auto: as the file says [auto]"
    add("--probe", metavar="SIDE", choices=("auto", *SIDES), default="auto", help=where)


def format_of(text: str) -> str:
    if text.startswith(".") and text.lower().endswith(WRITTEN):
        return text
    raise argparse.ArgumentTypeError(f"'{text}', expected one of {' '.join(WRITTEN)}, or .seq.nrrd")


def add_product_options(parser: argparse.ArgumentParser, default: str) -> None:
    """The options of what reads and writes files."""
    add = parser.add_argument
    add("--spacing", metavar="X,Y,Z", type=spacing_of, help="mm between voxels, where files do not say it, or wrongly")
    add("--write", metavar="LIST", default=default, help=f"of {','.join(WRITABLE)} [{default}]")
    add(
        "--format",
        metavar="SUFFIX",
        type=format_of,
        default=".nrrd",
        help="of volumes: .nrrd, .mha, .nii.gz; .seq.nrrd: one for a sequence [.nrrd]",
    )
    add("--level", type=finite, help="grey value at which the mesh's tissue begins [Otsu's threshold]")
    add("--mirror", action="store_true", help="Kretz volumes: the other side, as of host_sim")
    add(
        "--seconds",
        type=positive,
        default=600,
        help="that reading a file may take, in a batch a volume [600]",
    )


def pairs_of(args: argparse.Namespace) -> list[str]:
    """What is set, KEY=VALUE."""
    return [*args.set, *([f"method={args.method}"] if args.method else [])]


def settings_of(args: argparse.Namespace, pairs: Sequence[str] | None = None) -> Settings:
    """Settings from the options, with `pairs` in the place of what is set; ValueError names key and value."""
    values: dict[str, Any] = {}
    for pair in pairs_of(args) if pairs is None else pairs:
        key, _, value = pair.partition("=")
        if not key or not value:
            raise ValueError(f"--set: '{pair}', expected KEY=VALUE")
        values[key] = value
    known = load(args.plugin).parameters
    load(args.plugin).encode(values)
    for key, value in values.items():
        p = known[key]
        if not p.choices and not p.minimum <= float(value) <= p.maximum:
            raise ValueError(f"--set: {key} is {value}, expected {p.minimum:g} to {p.maximum:g}")
    products = tuple(p for p in getattr(args, "write", "").split(",") if p)
    for product in products:
        if product not in WRITABLE:
            raise ValueError(f"--write: '{product}' is none of {', '.join(WRITABLE)}")
    if "write" in args and not products:
        raise ValueError(f"--write: '{args.write}' names none of {', '.join(WRITABLE)}")
    of_files = {name: getattr(args, name) for name in ("level", "spacing", "mirror") if "write" in args}
    return Settings(
        parameters={k: v if known[k].choices else float(v) for k, v in values.items()},
        products=products,
        suffix=getattr(args, "format", ".nrrd"),
        probe=None if args.probe == "auto" else args.probe,
        **{name: getattr(args, name) for name in ("view", "scanned", "window", "plugin")},
        **of_files,
    )
