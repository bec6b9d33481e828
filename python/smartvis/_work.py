# SPDX-License-Identifier: MIT
"""One volume of a file from reading to results: the command line, batch and its workers share it."""

from __future__ import annotations

import time
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from . import _images, _picture
from ._clip import ClipperCache, clip
from ._errors import FileError, PluginError, SmartVisError
from ._files import Source, stem, whole, write_image, write_ply
from ._plugin import Plugin, load
from ._products import depth_image, mesh, quick_look, small_look
from ._result import Result
from ._volume import to_uint8

PRODUCTS = ("clipped", "depth", "mesh", "look")


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

    def clip(self, image: Any, cache: ClipperCache | None = None) -> Result:
        """Clips an image."""
        result: Result = clip(
            image,
            view=self.view,
            scanned=self.scanned,
            window=self.window,
            probe=self.probe,
            plugin=self.load(),
            cache=cache,
            **self.parameters,
        )
        return result


@dataclass
class Row:
    """What became of one volume: a line of the table."""

    file: str
    frame: int
    state: str = "ok"  #: ok, input, plugin or output: where it failed
    reason: str = ""
    outcome: str = ""
    why: str = ""  #: why nothing is clipped, and what to do
    try_this: str = ""  #: the setting that clips all the same
    doubt: str = ""  #: what is not plausible about the volume's size, or not known
    width: int = 0
    height: int = 0
    slices: int = 0
    depth_mm: float = 0.0  #: mean over the pixels that clip
    unit: str = "mm"  #: of it; voxels where the file does not say its spacing
    clipped_share: float = 0.0  #: of the pixels
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
    source: Source, frame: int, settings: Settings, out: Path, cache: ClipperCache | None = None, small: bool = False
) -> Row:
    """Reads, clips and writes one volume, with a small picture if that is wanted. What is wrong with it is in the row,
    not an exception."""
    row = Row(str(source.path), frame)
    try:
        start = time.perf_counter()
        image = source.read(frame)
        if isinstance(settings.view, str) and settings.view != "probe" and not source.knows_patient:
            raise FileError(
                f"{source.path}: does not say how it lies in the patient, so there is no view {settings.view}"
            )
        row.read_ms = 1e3 * (time.perf_counter() - start)
        row.width, row.height, row.slices = image.GetSize()
        start = time.perf_counter()
        result = settings.clip(image, cache)
        row.clip_ms = 1e3 * (time.perf_counter() - start)
        _describe(row, result)
    except PluginError as error:
        row.state, row.reason = "plugin", str(error)
        return row
    except MemoryError:
        row.state, row.reason = "input", f"{source.path}: no memory to clip it"
        return row
    except (SmartVisError, ValueError) as error:
        row.state, row.reason = "input", str(error)
        return row
    try:
        start = time.perf_counter()
        prefix = out / name_of(source, frame)
        row.files = " ".join(p.name for p in _write(image, result, settings, prefix))
        row.picture = _write_small(image, result, settings, prefix).name if small else ""
        row.write_ms = 1e3 * (time.perf_counter() - start)
    except MemoryError:
        row.state, row.reason = "output", f"{source.path}: no memory to write its results"
    except (FileError, ValueError) as error:
        row.state, row.reason = "output", str(error)
    return row


def _describe(row: Row, result: Result) -> None:
    row.outcome = result.outcome.name
    row.points = result.statistics.points
    row.why, row.doubt = result.why, result.doubt
    row.try_this = " ".join(f"--set {key}={value}" for key, value in result.try_this.items())
    row.unit = "mm" if result.spacing_known else "voxels"
    clips = result.depth > 0
    row.clipped_share = float(clips.mean())
    row.depth_mm = float(result.depth_mm[clips].mean()) if clips.any() else 0.0


def _write_small(image: Any, result: Result, settings: Settings, prefix: Path) -> Path:
    look = small_look(to_uint8(_images.array(image), settings.window), result)
    return whole(prefix.with_name(f"{prefix.name}_small.png"), lambda part: part.write_bytes(_picture.encode(look)))


def _write(image: Any, result: Result, settings: Settings, prefix: Path) -> list[Path]:
    def name(what: str, suffix: str) -> Path:
        return prefix.with_name(f"{prefix.name}_{what}{suffix}")

    written = []
    for product in settings.products:
        if product == "clipped":
            written.append(write_image(name("clipped", settings.suffix), result.apply(image)))
        elif product == "depth":
            written.append(write_image(name("depth", settings.suffix), depth_image(image, result)))
        elif product == "mesh":
            written.append(
                write_ply(name("mesh", ".ply"), *mesh(image, result, settings.level), mm=result.spacing_known)
            )
        elif product == "look":
            look = quick_look(to_uint8(_images.array(image), settings.window), result)
            picture = _images.sitk().GetImageFromArray(np.ascontiguousarray(look), isVector=True)
            written.append(write_image(name("look", ".png"), picture))
    return written
