# SPDX-License-Identifier: MIT
"""The package's version, for itself and pyproject.toml: that of CMakeLists.txt. And the commit that was built."""

from . import _places

__version__ = "1.0.0"


def _read() -> str:
    try:
        return _places.find("commit.txt").read_text().strip()
    except OSError:
        return ""


__commit__ = _read()  #: twelve digits, with ".changed" where files differed from it; "": nobody knew
FULL = "+".join(filter(None, (__version__, __commit__)))  #: what programs and plugin call themselves
