# SPDX-License-Identifier: MIT
"""Volumes in files: whatever SimpleITK reads, sequences volume by volume, and results written whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _images
from ._errors import SmartVisError

SUFFIXES = (".nrrd", ".nhdr", ".nii", ".nii.gz", ".mha", ".mhd", ".dcm", ".vtk", ".tif", ".tiff")
_HEADER = 65536
_KEPT_VOXELS = 1 << 28
_POSITION = "0020|0032"  # DICOM's tag: where a slice lies, in mm
_UNEVEN = 0.05  # of the distance between slices
_CINE = ("1.2.840.10008.5.1.4.1.1.3", "1.2.840.10008.5.1.4.1.1.3.1")  # DICOM's classes of ultrasound over time


class FileError(SmartVisError):
    """A file cannot be read as a volume, or a result cannot be written; the message names it."""


class Source:
    """The volumes of one file, or of a folder of DICOM: each series is one."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        """FileError: not readable, or no volume."""
        self.path = Path(path)
        self._reader: Any = None
        self._whole: Any = None
        self._series: list[tuple[str, ...]] = []
        self.count = 1
        try:
            self._open()
        except RuntimeError as error:
            raise FileError(f"{self.path}: {_reason(error)}") from None

    def _open(self) -> None:
        sitk = _images.sitk()
        if not self.path.exists():
            raise FileError(f"{self.path}: no such file or folder")
        if self.path.is_dir():
            finder, folder = sitk.ImageSeriesReader, str(self.path)
            self._series = [finder.GetGDCMSeriesFileNames(folder, s) for s in finder.GetGDCMSeriesIDs(folder)]
            if not self._series:
                raise FileError(f"{self.path}: the folder has no DICOM series")
            self.count = len(self._series)
            return
        reader = self._reader = sitk.ImageFileReader()
        reader.SetFileName(str(self.path))
        reader.ReadImageInformation()
        size, values = reader.GetSize(), reader.GetNumberOfComponents()
        self._not_only_pictures(reader)
        kinds = _kinds(self.path)
        if kinds == ["domain", "domain", "list"] and len(size) == 3:
            raise FileError(f"{self.path}: Kinds says that it holds {size[2]} pictures over time, not a volume")
        if len(size) == 4 and values == 1:
            self.count = size[3]
        elif len(size) == 3 and values > 1 and kinds[:1] == ["list"]:
            self.count = values
        elif len(size) != 3 or values != 1:
            raise FileError(f"{self.path}: {len(size)} dimensions and {values} values a voxel, expected a volume")

    def _not_only_pictures(self, reader: Any) -> None:
        """FileError for what is DICOM, but no volume."""
        dicom = reader.GetMetaData("0008|0016").strip() if reader.HasMetaDataKey("0008|0016") else ""
        if dicom in _CINE:
            raise FileError(f"{self.path}: SOP class {dicom} holds pictures over time, not a volume")
        if dicom and reader.GetSize()[2:] in ((), (1,)):
            raise FileError(f"{self.path}: it is one picture of a DICOM series; name the folder that holds them all")

    def read(self, number: int = 0) -> Any:
        """Volume `number` as a SimpleITK image of 3 dimensions with one value a voxel."""
        try:
            return self._read(number)
        except RuntimeError as error:
            raise FileError(f"{self.path}: {_reason(error)}") from None

    def _read(self, number: int) -> Any:
        sitk = _images.sitk()
        if self._series:
            return self._read_series(self._series[number])
        if self._whole is None and self.count == 1:
            size = list(self._reader.GetSize())
            if len(size) == 3:
                return self._reader.Execute()
        if self._reader is not None and self._reader.GetDimension() == 4:
            return self._read_of_four(number)
        if self._whole is None:
            self._whole = self._reader.Execute()
        if self._whole.GetNumberOfComponentsPerPixel() > 1:
            return sitk.VectorIndexSelectionCast(self._whole, number)
        return self._whole

    def _read_series(self, files: Sequence[str]) -> Any:
        if len(files) == 1:
            return Source(files[0]).read()
        reader = _images.sitk().ImageSeriesReader()
        reader.SetFileNames(files)
        reader.MetaDataDictionaryArrayUpdateOn()
        image = reader.Execute()
        if all(reader.HasMetaDataKey(n, _POSITION) for n in range(len(files))):
            self._evenly_spaced([reader.GetMetaData(n, _POSITION) for n in range(len(files))], files)
        return image

    def _evenly_spaced(self, positions: Sequence[str], files: Sequence[str]) -> None:
        """SimpleITK takes the mean distance between slices, and with one missing the rest lie in the wrong place."""
        at = np.array([[float(number) for number in position.split("\\")] for position in positions])
        gaps = np.linalg.norm(np.diff(at, axis=0), axis=1)
        usual = float(np.median(gaps))
        worst = int(np.abs(gaps - usual).argmax())
        if usual <= 0 or abs(gaps[worst] - usual) > _UNEVEN * usual:
            raise FileError(
                f"{files[worst + 1]}: it lies {gaps[worst]:.4g} mm behind the slice before it, others of the DICOM "
                f"series {usual:.4g} mm: slices are missing or not evenly spaced"
            )

    def _read_of_four(self, number: int) -> Any:
        """A file that is compressed is unpacked for every read, so what is not too large is read once."""
        size = list(self._reader.GetSize())
        part, first = [*size[:3], 0], [0, 0, 0, number]
        if self._whole is None and int(np.prod(size)) <= _KEPT_VOXELS:
            self._whole = self._reader.Execute()
        if self._whole is not None:
            return _images.sitk().Extract(self._whole, part, first)
        self._reader.SetExtractSize(part)
        self._reader.SetExtractIndex(first)
        return self._reader.Execute()


def _kinds(path: Path) -> list[str]:
    """The axes' kinds that a NRRD or MetaImage header tells, or none."""
    if path.suffix not in (".nrrd", ".nhdr", ".mha", ".mhd"):
        return []
    with open(path, "rb") as file:
        head = file.read(_HEADER)
    for line in head.split(b"\n"):
        name, mark, value = line.replace(b"=", b":", 1).partition(b":")
        if mark and name.strip().lower() == b"kinds":
            return value.decode("ascii", "replace").replace('"', "").split()
        if name.strip() == b"ElementDataFile" or not line.strip():
            break
    return []


def _reason(error: RuntimeError) -> str:
    """The last line of SimpleITK's many, without its places in the source."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    return lines[-1].split("ERROR: ")[-1] if lines else "not readable"


def stem(path: Path) -> str:
    """The file's name without what tells its format: "head.seq" of head.seq.nii.gz."""
    name = path.name
    for suffix in sorted(SUFFIXES, key=len, reverse=True):
        if name.lower().endswith(suffix) and len(name) > len(suffix):
            return name[: -len(suffix)]
    return name


PARTS = ".part-*"  #: names of files that are being written


def whole(path: Path, write: Callable[[Path], object]) -> Path:
    """Calls `write` with a name beside `path`, which becomes `path` when all of it is there."""
    part = path.with_name(f".part-{os.getpid()}-{path.name}")
    try:
        write(part)
        os.replace(part, path)
    except RuntimeError as error:
        raise FileError(f"{path}: {_reason(error)}") from None
    except OSError as error:
        raise FileError(f"{path}: {error.strerror or error}") from None
    finally:
        part.unlink(missing_ok=True)
    return path


def write_image(path: Path, image: Any) -> Path:
    """An image in the format that the file's suffix names, compressed where the format can."""
    return whole(path, lambda part: _images.sitk().WriteImage(image, str(part), True))


def write_ply(path: Path, vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> Path:
    """A triangle mesh as binary PLY, in mm."""
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\nproperty float x\nproperty float y\n"
        f"property float z\nelement face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    rows = np.empty(len(faces), [("count", "u1"), ("index", "<i4", 3)])
    rows["count"], rows["index"] = 3, faces

    def write(part: Path) -> None:
        part.write_bytes(header.encode() + vertices.astype("<f4").tobytes() + rows.tobytes())

    return whole(path, write)
