# SPDX-License-Identifier: MIT
"""Many scans on Dask distributed.

``batch``: every volume of files and folders is a task. A worker process keeps its clippers active between volumes
of one format. A task writes its files by rename, and last its row, as JSON; a volume whose row is there is done.
So a batch goes on where it stopped, and a worker that is killed loses nothing: Dask gives its tasks to another.
"""

from __future__ import annotations

import contextlib
import csv
import faulthandler
import hashlib
import json
import os
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from . import _kretz, _process
from ._clip import ClipperCache
from ._errors import FileError, HostError, extra_module
from ._files import PARTS, Source, stem, whole
from ._files import SUFFIXES as SUFFIXES
from ._page import write_page
from ._text import plain
from ._work import COLUMNS, Row, Settings, clip_one

ROWS = "rows"  #: folder of the rows beside the results
BEGAN = ".began"  # ending of the name that tells when a volume was begun
_AHEAD = 4  # tasks a worker has in hand: enough to keep it busy, few enough for a list of any length
_LOOK = 2.0  # seconds between looks at workers of our own
_ALONE = 300  # seconds without any: on a busy machine a start takes some of them


@contextlib.contextmanager
def cluster(scheduler: str | None, workers: int, link: Callable[[str], None]) -> Iterator[Any]:
    """A client: of the scheduler at an address, or of `workers` processes of its own, a thread each. `link` is told
    where the dashboard is."""
    dask, config = (extra_module(name, "distributed", "batch") for name in ("distributed", "dask.config"))
    if scheduler is not None:
        try:
            client = dask.Client(scheduler, timeout="20s")
        except (OSError, ValueError) as error:
            raise ValueError(f"--scheduler {scheduler}: {error}") from None
        with client:
            link(client.dashboard_link)
            yield client
        return
    # A task that was on two workers when they died is put aside. A worker that died has time to come back: Dask itself
    # gives it 15 seconds, after which it ends the one that is just about to begin.
    patience = {"scheduler.allowed-failures": 1, "deploy.lost-worker-timeout": f"{_ALONE} s"}
    with (
        config.set({f"distributed.{key}": value for key, value in patience.items()}),
        dask.LocalCluster(
            n_workers=workers, threads_per_worker=1, processes=True, dashboard_address="127.0.0.1:0", silence_logs=50
        ) as local,
        dask.Client(local) as client,
    ):
        link(client.dashboard_link)
        yield client


def find_files(paths: Sequence[str]) -> list[Path]:
    """The files named, and of folders all below them with a suffix of a volume. A folder's DICOM slices are one
    volume; one that cannot be read stands for itself, so that it is told. FileError: a path is not there."""
    found: list[Path] = []
    for path in map(Path, paths):
        if not path.exists():
            raise FileError(f"{path}: no such file or folder")
        if not path.is_dir():
            found.append(path)
            continue
        closed: list[OSError] = []
        inside = sorted(
            Path(folder, name)
            for folder, _, names in os.walk(path, onerror=closed.append)
            for name in names
            if name.lower().endswith(SUFFIXES)
        )
        found += [Path(error.filename) for error in closed]
        slices = {p.parent for p in inside if p.suffix.lower() == ".dcm"}
        found += [p for p in inside if p.suffix.lower() != ".dcm"]
        found += [part for folder in sorted(slices) for part in _kretz.split(folder)]
    return found


def row_path(out: Path, file: Path, frame: int) -> Path:
    """Where a volume's row lies: one name for one file, wherever it was started from."""
    key = hashlib.sha256(os.fsencode(file.resolve())).hexdigest()[:16]
    return out / ROWS / f"{key}_{frame:05d}.json"


def folder_of(out: Path, file: Path) -> Path:
    """A folder for each file, named after it, so that files of one name do not overwrite one another."""
    whole_name = file.resolve()
    key = hashlib.sha256(os.fsencode(whole_name)).hexdigest()[:8]
    return out / f"{whole_name.parent.name[:60]}-{stem(whole_name)[:60]}-{key}"


_worker_cache: ClipperCache | None = None
_worker_source: Source | None = None


def task(path: str, frame: int, settings: Settings, out: str, seconds: int) -> dict[str, Any]:
    """One volume, in a worker: its clippers outlive the task. Every trouble with a volume is in its row. One that takes
    too long ends the worker, whatever hangs, and the next worker that gets it finds when it began."""
    global _worker_cache, _worker_source
    if _worker_cache is None:
        _worker_cache = ClipperCache(most=2)
    _process.limit = seconds
    file, results = Path(path), Path(out)
    began = row_path(results, file, frame).with_suffix(BEGAN)
    if began.exists() and time.time() - began.stat().st_mtime >= seconds:
        return _keep(Row(path, frame, "input", f"{path}: it took longer than {seconds} s"), results)
    whole(began, lambda part: part.write_text(""))
    faulthandler.dump_traceback_later(seconds, exit=True, file=2)
    try:
        if _worker_source is None or _worker_source.path != file:
            _worker_source = Source(file, mirror=settings.mirror, spacing=settings.spacing)
        row = clip_one(_worker_source, frame, settings, folder_of(results, file), _worker_cache, True)
    except (FileError, HostError) as error:
        row = Row(path, frame, "input", str(error))
    finally:
        faulthandler.cancel_dump_traceback_later()
        began.unlink(missing_ok=True)
    return _keep(row, results)


def _keep(row: Row, out: Path) -> dict[str, Any]:
    facts = asdict(row)
    path = row_path(out, Path(row.file), row.frame)
    whole(path, lambda part: part.write_text(json.dumps(facts)))
    return facts


def frames_of(files: Sequence[Path], out: Path) -> tuple[list[tuple[Path, int]], list[dict[str, Any]]]:
    """The volumes to do, and the rows of those that are done. A file that cannot be opened is a row at once."""
    todo: list[tuple[Path, int]] = []
    done: list[dict[str, Any]] = []
    for file in files:
        try:
            count = Source(file).count
        except FileError as error:
            done.append(_keep(Row(str(file), 0, "input", str(error)), out))
            continue
        for frame in range(count):
            row = _read_row(row_path(out, file, frame))
            if row is not None and row["state"] == "ok":
                done.append(row)
            else:
                todo.append((file, frame))
    return todo, done


def _read_row(path: Path) -> dict[str, Any] | None:
    try:
        row = json.loads(path.read_text())
    except (OSError, ValueError):
        return None
    return row if isinstance(row, dict) and set(row) == set(COLUMNS) else None


def same_settings(out: Path, settings: Settings) -> None:
    """Results of other settings are never mixed in: ValueError."""
    path = out / ROWS / "settings.json"
    facts = json.dumps(asdict(replace(settings, plugin=settings.load().path)), sort_keys=True)
    if path.exists() and path.read_text() != facts:
        raise ValueError(f"{out} holds a batch with other settings, {path}; choose another --out")
    whole(path, lambda part: part.write_text(facts))


def batch(
    files: Sequence[Path],
    settings: Settings,
    out: Path,
    client: Any,
    step: Callable[[], Any],
    seconds: int = 600,
    total: Callable[[int], Any] = lambda count: None,
) -> list[dict[str, Any]]:
    """Clips what is not done yet, and returns the rows of all; table.csv and index.html have them, too, however the
    batch ends. Failed volumes are tried anew by the next batch; `seconds` is what one may take. `total` is told how
    many volumes there are, `step` is called for each. One batch at a time may write to `out`.
    HostError: the workers died and none came back."""
    same_settings(out, settings)
    _remove_leftovers(out)
    _process.limit = seconds
    todo, rows = frames_of(files, out)
    total(len(todo) + len(rows))
    for _ in rows:
        step()
    try:
        for row in _rows(todo, settings, out, client, seconds):
            rows.append(row)
            step()
    finally:
        _remove_leftovers(out)
        rows.sort(key=lambda row: (row["file"], row["frame"]))
        write_table(out / "table.csv", rows)
        write_page(out / "index.html", [(Row(**row), folder_of(out, Path(row["file"]))) for row in rows])
    return rows


def _remove_leftovers(out: Path) -> None:
    """Of workers that were killed."""
    for path in (*out.rglob(PARTS), *out.rglob(f"*{BEGAN}")):
        path.unlink(missing_ok=True)


def _rows(
    todo: Sequence[tuple[Path, int]], settings: Settings, out: Path, client: Any, seconds: int
) -> Iterator[dict[str, Any]]:
    """The rows of volumes as they end."""
    workers = max(len(client.nthreads()), 1)
    suspects = []

    def submit(file: Path, frame: int) -> Any:
        return client.submit(task, str(file), frame, settings, str(out), seconds, pure=False)

    for (file, frame), future in _done(todo, submit, client, workers, _AHEAD * workers):
        row = _row_of(future, row_path(out, file, frame))
        if row is None:
            suspects.append((file, frame))
        else:
            yield row
    # Dask suspects whatever was in hand on a worker that died. Alone, only what really kills one fails again.
    for (file, frame), future in _done(suspects, submit, client, workers, 1):
        row = _row_of(future, row_path(out, file, frame))
        yield row or _keep(Row(str(file), frame, "plugin", f"the worker died: {_reason(future)}"), out)


def _row_of(future: Any, path: Path) -> dict[str, Any] | None:
    """The row of a task that ended, from its file: what Dask itself keeps of a result is lost with the worker that has
    it, and to ask for it then is to wait without end. None: the task's worker died."""
    if future.status != "finished":
        return None
    row = _read_row(path)
    if row is not None:
        return row
    try:  # a file system of a network may show the file late
        kept: dict[str, Any] = future.result(timeout=_ALONE)
    except TimeoutError:
        return None
    return kept


def _reason(future: Any) -> str:
    return str(future.exception()) if future.status == "error" else future.status


def _done(
    volumes: Sequence[tuple[Path, int]], start: Callable[[Path, int], Any], client: Any, workers: int, ahead: int
) -> Iterator[tuple[tuple[Path, int], Any]]:
    """Volumes with their futures as they end, `ahead` of them in hand at a time."""
    from distributed import as_completed

    completed = as_completed(loop=client.loop)  # not that of another client in this process
    left = iter(volumes)
    waiting: dict[str, tuple[Path, int]] = {}

    def submit() -> None:
        for file, frame in left:
            future = start(file, frame)
            waiting[future.key] = (file, frame)
            completed.add(future)
            return

    for _ in range(ahead):
        submit()
    while waiting:
        _wait(completed, client, workers)
        future = next(completed)
        yield waiting.pop(future.key), future
        submit()


def _wait(completed: Any, client: Any, workers: int) -> None:
    """Until a future has ended. Workers of our own may die for good on a busy machine, and then no future ever ends:
    they are replaced. HostError: none came in time. A scheduler elsewhere is waited for."""
    last = time.monotonic()
    look = last + _LOOK
    while not completed.has_ready():
        time.sleep(0.005)
        now = time.monotonic()
        if client.cluster is None or now < look:
            continue
        look = now + _LOOK
        if client.nthreads():
            last = now
        elif now - last > _ALONE:
            raise HostError(f"no worker for {_ALONE} s; what is done is kept, and the next batch goes on from there", 1)
        else:
            client.cluster.scale(workers)


def write_table(path: Path, rows: Sequence[dict[str, Any]]) -> Path:
    """The rows as CSV."""

    def write(part: Path) -> None:
        with open(part, "w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
            writer.writeheader()
            writer.writerows({k: plain(v) if isinstance(v, str) else v for k, v in row.items()} for row in rows)

    return whole(path, write)
