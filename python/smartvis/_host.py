# SPDX-License-Identifier: MIT
"""Finding and running ``host_sim``, which makes the scenes and holds the measures.

It is not part of the wheel, because it needs libraries that the plugin does not. It is looked for in this
order: the environment variable ``SMARTVIS_HOST_SIM``, the search path, and the folder ``build`` of the
repository that the package was installed from in place.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

from ._errors import HostError


def find() -> str:
    """The path of host_sim; HostError says how to get one."""
    named = os.environ.get("SMARTVIS_HOST_SIM")
    if named:
        if not os.access(named, os.X_OK):
            raise HostError(f"SMARTVIS_HOST_SIM={named}: no such program")
        return named
    found = shutil.which("host_sim")
    beside = Path(__file__).resolve().parents[2] / "build" / "host_sim"
    if found or os.access(beside, os.X_OK):
        return found or str(beside)
    raise HostError(
        "host_sim is not there: run 'make' in the repository of SmartVis, and set SMARTVIS_HOST_SIM to build/host_sim"
    )


def run(arguments: Sequence[str], folder: str | None = None) -> str:
    """Runs host_sim in a folder and returns what it prints; HostError with its own line and exit code if it fails."""
    command = [os.path.abspath(find()), *arguments]
    ended = subprocess.run(command, cwd=folder, capture_output=True, text=True, errors="replace", check=False)
    if ended.returncode != 0:
        lines = ended.stderr.strip().splitlines() or [f"ended with code {ended.returncode} and said nothing"]
        raise HostError(lines[0], ended.returncode)
    return ended.stdout
