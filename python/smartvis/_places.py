# SPDX-License-Identifier: MIT
"""Where the parts of the package lie that are no Python: beside it, or in the clone that it comes from."""

from __future__ import annotations

import json
from functools import cache
from importlib import metadata
from pathlib import Path
from urllib.parse import urlsplit
from urllib.request import url2pathname

_PACKAGE = Path(__file__).parent


@cache
def _installed() -> tuple[Path | None, Path | None]:
    """By what pip wrote down (PEP 610): the folder of the sources that this package was installed from, if it was one;
    and of an editable installation, whose Python stays in the sources, where the rest was put."""
    try:
        pip = metadata.distribution("smartvis")
        said = json.loads(pip.read_text("direct_url.json") or "{}")
    except (metadata.PackageNotFoundError, ValueError):
        return None, None
    if "dir_info" not in said:
        return None, None
    sources = Path(url2pathname(urlsplit(said["url"]).path))
    put = Path(str(pip.locate_file("smartvis")))
    if said["dir_info"].get("editable"):
        return (sources, put) if (sources / "smartvis").resolve() == _PACKAGE.resolve() else (None, None)
    return (sources, None) if put.resolve() == _PACKAGE.resolve() else (None, None)


def clone() -> Path:
    """The clone that the package lies in or was installed from, if there is one."""
    sources, _ = _installed()
    return (sources or _PACKAGE.resolve().parent).parent


def own(name: str) -> Path:
    """Where a file of the package's folder `plugin` is, if it has it."""
    _, put = _installed()
    return next((at for at in (_PACKAGE, put) if at and (at / "plugin" / name).exists()), _PACKAGE) / "plugin" / name


def built(name: str) -> Path:
    """Where `make` puts it."""
    return clone() / "build" / name


def find(name: str) -> Path:
    """The package's own, or what `make` has built."""
    return built(name) if not own(name).exists() and built(name).exists() else own(name)
