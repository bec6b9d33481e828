# SPDX-License-Identifier: MIT
"""Finding and running ``host_sim``, which makes the scenes and holds the measures.

It is looked for in this order: the environment variable ``SMARTVIS_HOST_SIM``; beside the package's plugin; the search
path; and the folder ``build`` of the clone that the package lies in or was installed from. The package's own stands
before the search path, because one that lies there may be of another version, whose commands and files are others.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Sequence

from . import _places, _runtime
from ._errors import DeviceError, HostError
from ._words import of_an_argument

_NAME = "host_sim.exe" if _runtime.WINDOWS else "host_sim"
_OWN = _places.own(_NAME)
_CLONE = _places.built(_NAME)
_OPENCL = 5  # host_sim's exit code where OpenCL is missing or fails


def find() -> str:
    """The path of host_sim; HostError says how to get one."""
    named = os.environ.get("SMARTVIS_HOST_SIM")
    if named:
        if not os.access(named, os.X_OK):
            raise HostError(f"SMARTVIS_HOST_SIM={named}: no such program")
        return named
    for path in (str(_OWN), shutil.which("host_sim"), str(_CLONE)):
        if path and os.access(path, os.X_OK):
            return path
    raise HostError(
        "host_sim is not there: install the wheel of 'make wheel', or run 'make' in the clone of SmartVis, which "
        "names what it needs; where the clone has gone, SMARTVIS_HOST_SIM names the program"
    )


def run(arguments: Sequence[str], folder: str | None = None, **names: str) -> str:
    """Runs host_sim in a folder and returns what it prints; HostError with its own line and exit code if it fails.
    `names`: by option, what the argument is called that it was made of."""
    program = find()
    own = environment(program)
    command = [os.path.abspath(program), *arguments]
    ended = subprocess.run(
        command, cwd=folder, env=own, capture_output=True, encoding="utf-8", errors="replace", check=False
    )
    if ended.returncode != 0:
        # Where its cache cannot be written, fontconfig says so first; nothing fails for that.
        lines = [line for line in ended.stderr.strip().splitlines() if not line.startswith("Fontconfig ")]
        first = lines[0] if lines else f"ended with code {ended.returncode} and said nothing"
        cure = _runtime.cure(ended.stderr, own) if ended.returncode == _OPENCL else ""
        kind = DeviceError if ended.returncode == _OPENCL else HostError
        raise kind(of_an_argument(first, **names) + cure, ended.returncode)
    return ended.stdout


def call(arguments: Sequence[str]) -> int:
    """Runs host_sim where its user sees what it says; returns its exit code."""
    program = find()
    command = [os.path.abspath(program), *arguments]
    return subprocess.run(command, env=environment(program), check=False).returncode


def environment(program: str) -> dict[str, str]:
    """What host_sim gets: this process' variables, the OpenCL that the plugin has here, and the wheel's own font."""
    fonts = _OWN.with_name("share") / "fonts" / "fonts.conf"
    own = program == str(_OWN) and fonts.exists() and "FONTCONFIG_PATH" not in os.environ
    return ({"FONTCONFIG_FILE": str(fonts)} if own else {}) | os.environ | _runtime.chosen()
