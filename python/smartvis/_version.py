# SPDX-License-Identifier: MIT
"""The package's version, for itself and for pyproject.toml; it is that of CMakeLists.txt."""

__version__ = "1.0.0"
