# SPDX-License-Identifier: MIT
"""The machine's sentences name options of a command line. Here they name arguments, and the other way round."""

import re

_LENGTH = r"(\d+(?:\.\d+)?)"
_THREE = ",".join([_LENGTH] * 3)
_PAIRS = (  # on a command line; in Python
    ("--spacing X,Y,Z", "spacing=(x, y, z)"),
    ("--window LOW,HIGH with LOW above it", "window=(low, high) with low above it"),
)
_NUMBERS = (  # a pattern, and how it is written on the other side
    (r"--padding auto", "scanned='auto'"),
    (rf"--spacing {_THREE}", r"spacing=(\1, \2, \3)"),
    (r"--probe ([-+][xyz])", r"probe='\1'"),
)
_BACK = (
    (r"scanned='auto'", "--scanned auto"),  # as `smartvis clip` has it
    (rf"spacing=\({_THREE.replace(',', ', ')}\)", r"--spacing \1,\2,\3"),
    (r"probe='([-+][xyz])'", r"--probe \1"),
)


def in_python(text: str) -> str:
    """What the machine says, to who calls from Python.

    >>> in_python("Is the probe there? --probe -z, or --spacing 1,1,2.5.")
    "Is the probe there? probe='-z', or spacing=(1, 1, 2.5)."
    """
    for option, argument in _PAIRS:
        text = text.replace(option, argument)
    for pattern, argument in _NUMBERS:
        text = re.sub(pattern, argument, text)
    return text


def on_command_line(text: str) -> str:
    """The same to who types a command.

    >>> on_command_line(in_python("--spacing X,Y,Z says it; --spacing 1,1,2.5; --probe -z"))
    '--spacing X,Y,Z says it; --spacing 1,1,2.5; --probe -z'
    """
    for option, argument in _PAIRS:
        text = text.replace(argument, option)
    for pattern, option in _BACK:
        text = re.sub(pattern, option, text)
    return text


def of_an_argument(text: str, **names: str) -> str:
    """A complaint of host_sim's about an option, as one about the argument that it was made of.

    >>> of_an_argument("host_sim run: --picture: 3 is outside 16 .. 2048", picture="size")
    'size: 3 is outside 16 .. 2048'
    """
    return re.sub(r"^host_sim \w+: --([a-z]+):", lambda found: f"{names.get(found[1], found[1])}:", text)
