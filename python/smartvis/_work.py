# SPDX-License-Identifier: MIT
"""One volume of a file from reading to results: the command line, batch and its workers share it."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from . import _sequence
from ._clip import ClipperCache, clip
from ._errors import FileError, LoadError, OutputError, SmartVisError, state_of
from ._files import Source, stem
from ._plugin import Plugin, load
from ._products import PRODUCTS, image_of, write
from ._result import Result
from ._words import on_command_line


@dataclass(frozen=True)
class Settings:
    """How volumes are clipped; it travels to workers."""

    parameters: dict[str, Any] = field(default_factory=dict)
    view: tuple[float, float, float] | str | None = None
    scanned: str | None = "auto"
    window: tuple[float, float] | None = None
    plugin: str | None = None
    products: tuple[str, ...] = PRODUCTS
    suffix: str = ".nrrd"
    level: float | None = None
    spacing: tuple[float, float, float] | None = None  #: mm, of files that do not say it, or wrongly
    probe: str | None = None  #: the side of the volume at which it was
    mirror: bool = False  #: of Kretz volumes, as of host_sim

    def load(self) -> Plugin:
        """The plugin that clips."""
        return load(self.plugin)

    @property
    def said(self) -> str:
        """What is set, as on a command line."""
        values = {key: f"{value:g}" if isinstance(value, float) else value for key, value in self.parameters.items()}
        return " ".join(f"{key}={value}" for key, value in sorted(values.items()))

    def row(self, file: str, frame: int, state: str = "ok", reason: str = "") -> Row:
        """The beginning of a volume's row, or all that there is of one that failed."""
        try:
            known = self.load().parameters.get("method")
        except LoadError:  # what failed may be that
            known = None
        method = self.parameters.get("method", known.default) if known else ""
        return Row(file, frame, state, reason, method=str(method), settings=self.said)

    def clip(self, volume: Any, cache: ClipperCache | None = None, spacing: Any = None) -> Result:
        """Clips an image, or an array of this spacing."""
        how: dict[str, Any] = {"view": self.view, "scanned": self.scanned, "window": self.window, "probe": self.probe}
        return clip(volume, spacing, plugin=self.load(), cache=cache, **how, **self.parameters)


@dataclass
class Row:
    """What became of one volume: a line of the table."""

    file: str
    frame: int
    state: str = "ok"  #: ok, input, plugin or output: where it failed
    reason: str = ""
    method: str = ""  #: set, or the plugin's default
    settings: str = ""  #: what was set, KEY=VALUE
    outcome: str = ""
    why: str = ""  #: why nothing is clipped, and what to do
    try_this: str = ""  #: the setting that clips all the same
    doubt: str = ""  #: what is not plausible about the volume's size, or not known
    beams: str = ""  #: how they ran, from where, and how sure that is
    width: int = 0
    height: int = 0
    slices: int = 0
    depth_mm: float = 0.0  #: mean over the pixels that clip
    unit: str = "mm"  #: of it; voxels where the file does not say its spacing
    clipped_share: float = 0.0  #: of the pixels
    confidence: float | None = None  #: mean over the pixels that clip; None: none do, or the method has none
    points: int = 0
    read_ms: float = 0.0
    clip_ms: float = 0.0
    write_ms: float = 0.0
    files: str = ""
    picture: str = ""  #: a small one beside the files, for the page


COLUMNS = tuple(asdict(Row("", 0)))


def name_of(source: Source, frame: int) -> str:
    """What the names of a volume's files begin with."""
    return stem(source.path) + (f"_f{frame:04d}" if source.count > 1 else "")


def clip_one(
    source: Source, frame: int, settings: Settings, out: Path, cache: ClipperCache | None = None, small: bool = False,
    sequences: Sequences | None = None,
) -> Row:  # fmt: skip
    """Reads, clips and writes one volume, with a small picture if that is wanted; of sequences in one file into
    `sequences`, which the caller closes. What is wrong with it is in the row, not an exception."""
    row = settings.row(str(source.path), frame)
    prefix = out / name_of(source, frame)

    def make_all(image: Any, result: Result) -> None:
        def make(what: str) -> Path:
            whole = sequences is not None and settings.suffix == _sequence.SUFFIX
            made = image_of(image, result, what) if whole else None
            if sequences is None or made is None:
                return write(image, result, prefix, what, settings.suffix, settings.level)
            return _append(sequences, out / f"{stem(source.path)}_{what}{settings.suffix}", made, source.count)

        row.files = " ".join(make(what).name for what in settings.products)
        row.picture = write(image, result, prefix, "small").name if small else ""

    fill(row, source, settings, make_all, cache)
    return row


def fill(
    row: Row, source: Source, settings: Settings, write_all: Callable[[Any, Result], object],
    cache: ClipperCache | None = None, step: Callable[[str], object] = lambda what: None,
) -> None:  # fmt: skip
    """Reads and clips the row's volume, and has `write_all` write what comes of it. `step` is told "read" and "clip"
    before each. What is wrong is in the row."""
    try:
        step("read")
        start = time.perf_counter()
        image = source.read(row.frame)
        if isinstance(settings.view, str) and settings.view != "probe" and not source.knows_patient:
            raise FileError(
                f"{source.path}: does not say how it lies in the patient, so there is no view {settings.view}"
            )
        row.read_ms = 1e3 * (time.perf_counter() - start)
        row.width, row.height, row.slices = image.GetSize()
        step("clip")
        start = time.perf_counter()
        result = settings.clip(image, cache)
        row.clip_ms = 1e3 * (time.perf_counter() - start)
        _describe(row, result)
    except MemoryError:
        row.state, row.reason = "memory", f"{source.path}: no memory to clip it"
        return
    except (SmartVisError, ValueError) as error:
        row.state, row.reason = state_of(error), str(error)
        return
    try:
        start = time.perf_counter()
        write_all(image, result)
        row.write_ms = 1e3 * (time.perf_counter() - start)
    except MemoryError:
        row.state, row.reason = "memory", f"{source.path}: no memory to write its results"
    except (FileError, ValueError) as error:
        row.state, row.reason = "output", str(error)


def _describe(row: Row, result: Result) -> None:
    row.outcome = result.outcome.name
    row.points = result.statistics.points
    row.why, row.doubt, row.beams = on_command_line(result.why), on_command_line(result.doubt), result.beams
    row.try_this = " ".join(f"--set {key}={value}" for key, value in result.try_this.items())
    row.unit = "mm" if result.spacing_known else "voxels"
    clips = result.depth > 0
    row.clipped_share = float(clips.mean())
    row.depth_mm = float(result.depth_mm[clips].mean()) if clips.any() else 0.0
    if result.confidence is not None and clips.any():
        row.confidence = round(float(result.confidence[clips].mean()), 4)


Sequences = dict[Path, "_sequence.Writer"]  #: files that volumes are added to


def _append(sequences: Sequences, path: Path, made: Any, count: int) -> Path:
    try:
        sequences.setdefault(path, _sequence.Writer(path, count)).add(made)
    except OSError as error:
        raise OutputError(f"{path}: {error.strerror or error}") from None
    return path
