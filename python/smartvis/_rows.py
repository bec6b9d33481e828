# SPDX-License-Identifier: MIT
"""What is kept of a batch: a row for each volume, with what it was made of, and who writes."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import re
import sys
from collections.abc import Iterable, Iterator
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from . import __version__
from ._errors import OutputError
from ._files import cut, stem, whole
from ._found import ROWS, SETTINGS
from ._work import COLUMNS, Row, Settings

BEGAN = ".began"  #: ending of the name that tells when a volume was begun
_LEFT = re.compile(rf"\.part-\d+-.*|.*{re.escape(BEGAN)}")  # by workers that were killed


def row_path(out: Path, file: Path, frame: int) -> Path:
    """Where a volume's row lies: one name for one file, wherever it was started from."""
    return out / ROWS / f"{_key(file)[:16]}_{frame:05d}.json"


def folder_of(out: Path, file: Path) -> Path:
    """A folder for each file, named after it, so that files of one name do not overwrite one another."""
    path = Path(os.path.abspath(file))
    return out / f"{cut(path.parent.name, 80)}-{cut(stem(path), 120)}-{_key(file)[:8]}"


def _key(file: Path) -> str:
    return hashlib.sha256(os.fsencode(os.path.abspath(file))).hexdigest()


def made_with(settings: Settings) -> dict[str, str]:
    """What a row depends on beside its file."""
    path = settings.load().path
    facts = json.dumps([__version__, asdict(replace(settings, plugin=path))], sort_keys=True)
    return {"settings": hashlib.sha256(facts.encode()).hexdigest(), "plugin": plugin_state(path)}


def plugin_state(path: str) -> str:
    """Another text when the library is another one."""
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()


def keep(row: Row, out: Path, made: dict[str, Any] | None = None, results: Iterable[str] = ()) -> dict[str, Any]:
    """Writes a row, with what it was `made` of and the files that came of it."""
    facts = asdict(row)
    folder = folder_of(out, Path(row.file))
    made = (made or {}) | {"results": {name: _state(folder / name) for name in results}}
    text = json.dumps(facts | {"made": made})
    whole(row_path(out, Path(row.file), row.frame), lambda part: part.write_text(text))
    return facts


def read_row(path: Path) -> dict[str, Any] | None:
    """A row as it was kept, "made" among its facts; None: there is none that is whole."""
    try:
        row = json.loads(path.read_text())
    except (OSError, ValueError):
        return None
    return row if isinstance(row, dict) and {*row} - {"made"} == {*COLUMNS} else None


def changed(row: dict[str, Any], made: dict[str, Any], folder: Path) -> str:
    """What is another since the row was kept: "file", "settings", "plugin" or "results"; "": nothing."""
    before = row.get("made", {})
    for what, state in made.items():
        if before.get(what) != state:
            return what
    there = {name: _state(folder / name) for name in before["results"]}
    return "" if there == before["results"] else "results"


def forget(out: Path, file: Path, frame: int) -> None:
    """Removes a row and what came of it, so that nothing of it stands beside what comes anew."""
    path = row_path(out, file, frame)
    row = read_row(path)
    for name in (row or {}).get("made", {}).get("results", {}):
        (folder_of(out, file) / name).unlink(missing_ok=True)
    path.unlink(missing_ok=True)


def _state(path: Path) -> list[int]:
    try:
        facts = path.stat()
    except OSError:
        return []
    return [facts.st_size, facts.st_mtime_ns]


@contextlib.contextmanager
def locked(out: Path, settings: Settings) -> Iterator[None]:
    """While one batch writes there; OutputError: another one does. Leaves what it was made with for who looks."""
    facts = json.dumps(asdict(replace(settings, plugin=settings.load().path)), sort_keys=True)
    path = out / ROWS / "lock"
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
    except OSError as error:
        raise OutputError(f"{path}: {error.strerror}") from None
    try:
        if not _lock(descriptor):
            raise OutputError(f"{out}: another batch writes there; wait for it, or choose another --out")
        whole(out / ROWS / SETTINGS, lambda part: part.write_text(facts))
        yield
    finally:
        os.close(descriptor)


def _lock(descriptor: int) -> bool:
    """False: another process has it. A file system that knows no locks gives them to everybody."""
    if sys.platform == "win32":
        import msvcrt

        try:
            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        except OSError:
            return False
        return True
    import fcntl

    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        pass
    return True


def remove_leftovers(out: Path, files: Iterable[Path]) -> None:
    """Of workers that were killed, where this batch writes; nobody else's."""
    for folder in {out, out / ROWS, *(folder_of(out, file) for file in files)}:
        with contextlib.suppress(OSError):
            for path in folder.iterdir():
                if _LEFT.fullmatch(path.name):
                    path.unlink(missing_ok=True)
