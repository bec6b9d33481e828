# SPDX-License-Identifier: MIT
"""Volumes in files: whatever SimpleITK reads, sequences volume by volume, and results written whole or not at all."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _images, _kretz, _process
from ._errors import FileError, OutputError, SmartVisError

WRITTEN = (".nrrd", ".nhdr", ".nii", ".nii.gz", ".mha", ".mhd", ".vtk", ".tif", ".tiff")  #: formats of volumes
SUFFIXES = (*WRITTEN, ".dcm", *_kretz.SUFFIXES)


class Source:
    """The volumes of one file, or of a folder of DICOM, read in a process of its own."""

    def __init__(
        self, path: str | os.PathLike[str], mirror: bool = False, spacing: Sequence[float] | None = None
    ) -> None:
        """FileError: not readable, or no volume. `mirror`: as of host_sim, for Kretz volumes. `spacing`: mm along x, y
        and z, where the file does not say it, or wrongly."""
        self.path = Path(path)
        self._mirror = mirror
        self._spacing = spacing
        self.knows_patient = False  #: the file says how its volumes lie in the patient; known once one was read
        try:
            str(self.path).encode()
        except UnicodeEncodeError:  # SimpleITK would end the process
            raise FileError(f"{str(self.path)!r}: the name is not UTF-8; rename the file") from None
        facts = _process.ask("open", str(self.path), mirror)
        self.count: int = facts["count"]
        #: What tells the volumes apart, where that is known.
        self.names: list[str] = facts["names"] or [""] * self.count

    def read(self, number: int = 0) -> Any:
        """Volume `number` as a SimpleITK image of 3 dimensions with one value a voxel."""
        *parts, self.knows_patient = _process.ask("read", str(self.path), self._mirror, number)
        image = _images.whole(*parts)
        if self._spacing is not None and _images.kretz(image):
            raise FileError(f"{self.path}: a Kretz file says itself how large it is, --spacing was given")
        if self._spacing is not None:
            image.SetSpacing([float(length) for length in self._spacing])
            image.EraseMetaData(_images.NOT_SAID)
        return image

    def only(self) -> Any:
        """The volume of a file that holds one; FileError: it holds several."""
        self.check_one()
        return self.read()

    def check_one(self) -> None:
        """FileError: it holds several volumes."""
        if self.count != 1:
            raise FileError(
                f"{self.path}: holds {self.count} volumes: clip them with `smartvis clip`, or read one of them and "
                "give that"
            )


def stem(path: Path) -> str:
    """The file's name without what tells its format: "head.seq" of head.seq.nii.gz; no longer than leaves room for
    what results are called."""
    name = path.name
    for suffix in sorted(SUFFIXES, key=len, reverse=True):
        if name.lower().endswith(suffix) and len(name) > len(suffix):
            return cut(name[: -len(suffix)], 180)
    return cut(name, 180)


def cut(name: str, most: int) -> str:
    """A name of so many bytes at most; file systems take 255."""
    return os.fsencode(name)[:most].decode(errors="ignore") if len(os.fsencode(name)) > most else name


PARTS = ".part-*"  #: names of files that are being written


def whole(path: Path, write: Callable[[Path], object]) -> Path:
    """Calls `write` with a name beside `path`, which becomes `path` when all of it is there."""
    part = path.with_name(f".part-{os.getpid()}-{path.name}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write(part)
        os.replace(part, path)
    except (SmartVisError, OSError) as error:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)
        if isinstance(error, OSError):
            raise OutputError(f"{path}: {error.strerror or error}") from None
        raise
    return path


def write_image(path: Path, image: Any) -> Path:
    """An image in the format that the file's suffix names, compressed where the format can. A format of pictures is
    refused, of which a volume would have one slice."""
    if not path.name.lower().endswith(WRITTEN):
        raise OutputError(f"{path}: no volume is written by this suffix, but by {' '.join(WRITTEN)}")
    parts = _images.parts(image)
    return whole(path, lambda part: _process.ask("write", str(path), str(part), parts))


def write_ply(path: Path, vertices: NDArray[np.float64], faces: NDArray[np.int64], mm: bool = True) -> Path:
    """A triangle mesh as binary PLY, in mm, or in voxels if the spacing is not known; it says which, and the axes as 3D
    Slicer looks for them."""
    unit = "mm\ncomment SPACE=LPS UNIT=mm" if mm else "voxels: the file does not say its spacing\ncomment SPACE=LPS"
    header = (
        f"ply\nformat binary_little_endian 1.0\ncomment SmartVis clipped volume, {unit}\n"
        f"element vertex {len(vertices)}\nproperty float x\nproperty float y\n"
        f"property float z\nelement face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    rows = np.empty(len(faces), [("count", "u1"), ("index", "<i4", 3)])
    rows["count"], rows["index"] = 3, faces

    def write(part: Path) -> None:
        part.write_bytes(header.encode() + vertices.astype("<f4").tobytes() + rows.tobytes())

    return whole(path, write)
