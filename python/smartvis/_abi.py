# SPDX-License-Identifier: MIT
"""The numbers and texts of smartvis_plugin.h and the extensions' headers, as ``abi/`` of the repository tells them.

``constants-VERSION.txt`` has a line for each; names are the headers'. ``tests/test_abi.py`` compiles the headers and
compares.
"""

import re
from pathlib import Path

from . import _places

# In the package, or in a checkout.
_FOLDER = next(f for f in (Path(__file__).parent / "abi", _places.clone() / "abi") if f.is_dir())
_NEWEST = max(_FOLDER.glob("constants-*.txt"), key=lambda path: [int(n) for n in re.findall(r"\d+", path.name)])


def _constants(text: str) -> dict[str, int | float | str]:
    read = {"whole": int, "real": float, "text": str}
    rows = (line.split(" ", 2) for line in text.splitlines())
    return {name: read[kind](value) for name, kind, value in rows}


NUMBERS = _constants(_NEWEST.read_text())


def __getattr__(name: str) -> int:
    """A number of the headers."""
    value = NUMBERS.get(name)
    if not isinstance(value, int):
        raise AttributeError(f"the headers have no whole number {name}")
    return value
