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
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from . import _process
from ._clip import ClipperCache
from ._errors import FileError, HostError, LoadError, extra_module
from ._files import Source, whole
from ._found import state_of
from ._page import write_page
from ._products import file_of
from ._rows import (
    BEGAN,
    changed,
    folder_of,
    forget,
    keep,
    locked,
    made_with,
    plugin_state,
    read_row,
    remove_leftovers,
    row_path,
)
from ._text import plain
from ._work import COLUMNS, Row, Settings, clip_one, name_of

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
    patience: dict[str, Any] = {"scheduler.allowed-failures": 1, "deploy.lost-worker-timeout": f"{_ALONE} s"}
    # A worker that is paused for its memory waits until others take less: here nobody else does, and it never goes on.
    patience |= {f"worker.memory.{what}": False for what in ("target", "spill", "pause")}
    with (
        config.set({f"distributed.{key}": value for key, value in patience.items()}),
        dask.LocalCluster(
            n_workers=workers, threads_per_worker=1, processes=True, dashboard_address="127.0.0.1:0", silence_logs=50
        ) as local,
        dask.Client(local) as client,
    ):
        link(client.dashboard_link)
        yield client


_worker_cache: ClipperCache | None = None
_worker_source: tuple[tuple[Path, str], Source] | None = None
_worker_plugins: dict[str, str] = {}  # by path, what they were when they were loaded
_Volume = tuple[Path, int, dict[str, Any]]


def task(path: str, frame: int, settings: Settings, out: str, seconds: int, made: dict[str, Any]) -> dict[str, Any]:
    """One volume, in a worker: its clippers outlive the task. Every trouble with a volume is in its row. One that takes
    too long ends the worker, whatever hangs, and the next worker that gets it finds when it began."""
    _process.limit = seconds
    file, results = Path(path), Path(out)
    began = row_path(results, file, frame).with_suffix(BEGAN)
    if began.exists() and time.time() - began.stat().st_mtime >= seconds:
        return keep(settings.row(path, frame, "input", f"{path}: it took longer than {seconds} s"), results)
    forget(results, file, frame)
    whole(began, lambda part: part.write_text(""))
    faulthandler.dump_traceback_later(seconds, exit=True, file=2)
    names: list[str] = []
    try:
        _check_plugin(settings, made["plugin"])
        source = _source(file, settings, made["file"])
        row = clip_one(source, frame, settings, folder_of(results, file), _worker_cache, True)
        names = [file_of(name_of(source, frame), what, settings.suffix) for what in (*settings.products, "small")]
    except (FileError, HostError, LoadError) as error:
        row = settings.row(path, frame, "plugin" if isinstance(error, LoadError) else "input", str(error))
    finally:
        faulthandler.cancel_dump_traceback_later()
        began.unlink(missing_ok=True)
    return keep(row, results, made, names if row.state == "ok" else [])


def _source(file: Path, settings: Settings, state: str) -> Source:
    """As before for the next volume of a file."""
    global _worker_cache, _worker_source
    if _worker_cache is None:
        _worker_cache = ClipperCache(most=2)
    if _worker_source is None or _worker_source[0] != (file, state):
        _worker_source = ((file, state), Source(file, mirror=settings.mirror, spacing=settings.spacing))
    return _worker_source[1]


def _check_plugin(settings: Settings, state: str) -> None:
    """LoadError: a worker that lives on from another batch has the library as it was then."""
    path = settings.load().path
    if path not in _worker_plugins:
        _worker_plugins[path] = plugin_state(path)
    if _worker_plugins[path] != state:
        raise LoadError(f"{path}: it has changed since this worker loaded it; start the workers anew")


@dataclass
class Plan:
    """What a batch does."""

    todo: list[tuple[Path, int, dict[str, Any]]] = field(default_factory=list)  #: volumes, with what they are made of
    done: list[dict[str, Any]] = field(default_factory=list)  #: rows
    anew: Counter[str] = field(default_factory=Counter)  #: how many that were done, by what has changed


def plan_of(files: Sequence[Path], out: Path, settings: Settings) -> Plan:
    """What is to be done, and what is done. A file that cannot be opened is a row at once."""
    plan, made = Plan(), made_with(settings)
    for file in files:
        try:
            state = state_of(file)
            count = Source(file).count
        except FileError as error:
            plan.done.append(keep(settings.row(str(file), 0, "input", str(error)), out))
            continue
        for frame in range(count):
            of = {"file": state} | made
            row = read_row(row_path(out, file, frame))
            ended = row is not None and row["state"] == "ok"
            what = changed(row, of, folder_of(out, file)) if row is not None and ended else ""
            if row is not None and ended and not what:
                plan.done.append(row)
            else:
                plan.todo.append((file, frame, of))
                plan.anew[what] += ended
    plan.done = [{name: row[name] for name in COLUMNS} for row in plan.done]
    return plan


def batch(
    files: Sequence[Path],
    settings: Settings,
    out: Path,
    client: Any,
    step: Callable[[], Any],
    seconds: int = 600,
    total: Callable[[int], Any] = lambda count: None,
    tell: Callable[[str], Any] = lambda text: None,
) -> list[dict[str, Any]]:
    """Clips what is not done yet, or of another file, plugin or settings, and returns the rows of all; table.csv and
    index.html have them, too, however the batch ends. Failed volumes are tried anew by the next batch; `seconds` is
    what one may take. `total` is told how many volumes there are, `step` is called for each, `tell` is told what is
    done anew. OutputError: another batch writes to `out`. HostError: the workers died and none came back."""
    with locked(out, settings):
        remove_leftovers(out, files)
        _process.limit = seconds
        plan = plan_of(files, out, settings)
        rows = plan.done
        total(len(plan.todo) + len(rows))
        if again := plan.anew.total():
            what = ", ".join(sorted(what for what, count in plan.anew.items() if count))
            tell(f"{again} of the volumes that were done are done anew; changed: {what}")
        for _ in rows:
            step()
        try:
            for row in _rows(plan.todo, settings, out, client, seconds):
                rows.append(row)
                step()
        finally:
            remove_leftovers(out, files)
            rows = write_overview(out, [(row, out) for row in rows])
    return rows


def _rows(
    todo: Sequence[_Volume], settings: Settings, out: Path, client: Any, seconds: int
) -> Iterator[dict[str, Any]]:
    """The rows of volumes as they end."""
    workers, memory = max(len(client.nthreads()), 1), _memory(client)
    suspects = []

    def submit(file: Path, frame: int, made: dict[str, Any]) -> Any:
        return client.submit(task, str(file), frame, settings, str(out), seconds, made, pure=False)

    for volume, future in _done(todo, submit, client, workers, _AHEAD * workers):
        row = _row_of(future, row_path(out, *volume[:2]))
        if row is None:
            suspects.append(volume)
        else:
            yield row
    # Dask suspects whatever was in hand on a worker that died. Alone, only what really kills one fails again.
    for (file, frame, _), future in _done(suspects, submit, client, workers, 1):
        row = _row_of(future, row_path(out, file, frame))
        reason = f"the worker died: {_reason(future)}{memory}"
        yield row or keep(settings.row(str(file), frame, "plugin", reason), out)


def _memory(client: Any) -> str:
    """What workers of our own have of it: one that takes more is ended without a word."""
    limits = [worker["memory_limit"] for worker in client.scheduler_info()["workers"].values()]
    if client.cluster is None or not any(limits):
        return ""
    most = min(filter(None, limits)) >> 20
    return f"; perhaps for want of memory: each has {most} MiB, and with fewer --workers more"


def _row_of(future: Any, path: Path) -> dict[str, Any] | None:
    """The row of a task that ended, from its file: what Dask itself keeps of a result is lost with the worker that has
    it, and to ask for it then is to wait without end. None: the task's worker died."""
    if future.status != "finished":
        return None
    row = read_row(path)
    if row is not None:
        return {name: row[name] for name in COLUMNS}
    try:  # a file system of a network may show the file late
        kept: dict[str, Any] = future.result(timeout=_ALONE)
    except TimeoutError:
        return None
    return kept


def _reason(future: Any) -> str:
    return str(future.exception()) if future.status == "error" else future.status


def _done(
    volumes: Sequence[_Volume], start: Callable[[Path, int, dict[str, Any]], Any], client: Any, workers: int, ahead: int
) -> Iterator[tuple[_Volume, Any]]:
    """Volumes with their futures as they end, `ahead` of them in hand at a time."""
    from distributed import as_completed

    completed = as_completed(loop=client.loop)  # not that of another client in this process
    left = iter(volumes)
    waiting: dict[str, _Volume] = {}

    def submit() -> None:
        for volume in left:
            future = start(*volume)
            waiting[future.key] = volume
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


def write_overview(out: Path, rows: Sequence[tuple[dict[str, Any], Path]]) -> list[dict[str, Any]]:
    """Rows, each with the folder of its batch, as table.csv and index.html in `out`: what one volume came to stands
    together. Returns them so."""
    ordered = sorted(rows, key=lambda of: (of[0]["file"], of[0]["frame"]))
    write_table(out / "table.csv", [row for row, _ in ordered])
    write_page(out / "index.html", [(Row(**row), folder_of(folder, Path(row["file"]))) for row, folder in ordered])
    return [row for row, _ in ordered]


def write_table(path: Path, rows: Sequence[dict[str, Any]]) -> Path:
    """The rows as CSV."""

    def write(part: Path) -> None:
        with open(part, "w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
            writer.writeheader()
            writer.writerows({k: plain(v) if isinstance(v, str) else v for k, v in row.items()} for row in rows)

    return whole(path, write)
