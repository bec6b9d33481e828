# SPDX-License-Identifier: MIT
"""Volumes in files: whatever SimpleITK reads, sequences volume by volume, and results written whole or not at all."""

from __future__ import annotations

import contextlib
import errno
import glob
import gzip
import math
import os
import re
import sys
import tempfile
import zlib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _host, _images, _kretz
from ._clipper import _checked_spacing
from ._errors import HostError, SmartVisError

SUFFIXES = (".nrrd", ".nhdr", ".nii", ".nii.gz", ".mha", ".mhd", ".dcm", ".vtk", ".tif", ".tiff", *_kretz.SUFFIXES)
_HEADER = 1 << 24  # bytes of a header's text at most, as in the host
_MOST_VOXELS = 1 << 31  # of a volume, as in the host
_KEPT_VOXELS = 1 << 28
_FAR = 1e9  # of any number of a geometry: ITK squares them
_POSITION = "0020|0032"  # DICOM's tag: where a slice lies, in mm
_PATIENT = re.compile(r"left|right|[LR][AP]S", re.IGNORECASE)  # of a NRRD's spaces
_UNEVEN = 0.05  # of the distance between slices
_CINE = ("1.2.840.10008.5.1.4.1.1.3", "1.2.840.10008.5.1.4.1.1.3.1")  # DICOM's classes of ultrasound over time


class FileError(SmartVisError):
    """A file cannot be read as a volume, or a result cannot be written; the message names it."""


class OutputError(FileError):
    """A result cannot be written."""


class Source:
    """The volumes of one file, or of a folder of DICOM: each series is one. Kretz volumes in it are files
    of their own."""

    def __init__(self, path: str | os.PathLike[str], ask_first: bool = False, mirror: bool = False) -> None:
        """FileError: not readable, or no volume. `ask_first`: the host reads all of a MetaImage now, and not with the
        first volume. `mirror`: as of host_sim, for Kretz volumes."""
        self.path = Path(path)
        self._mirror = mirror
        self._kretz: tuple[int, Any] | None = None  # the volume that was read last, and its number
        self._reader: Any = None
        self._unchecked = self.path.suffix.lower() in (".mha", ".mhd")
        self._host_says_patient = False
        self._whole: Any = None
        self._series: list[tuple[str, ...]] = []
        self.count = 1
        try:
            str(self.path).encode()
        except UnicodeEncodeError:  # SimpleITK would end the process
            raise FileError(f"{str(self.path)!r}: the name is not UTF-8; rename the file") from None
        try:
            if ask_first and self.path.is_file():
                self._ask_host()
            self._open()
        except OSError as error:
            raise _unreadable(self.path, error) from None
        except RuntimeError as error:
            self._ask_host()  # its reason is the better one
            raise FileError(f"{self.path}: {_reason(error)}") from None

    def _open(self) -> None:
        sitk = _images.sitk()
        if not self.path.exists():
            raise FileError(f"{self.path}: no such file or folder")
        if self.path.is_dir():
            self._open_folder()
            return
        if not self.path.is_file():
            raise FileError(f"{self.path}: not a regular file")
        if _kretz.is_one(self.path):
            self._kretz = (0, self._read_kretz(0))
            return
        self._fields = _header(self.path)
        reader = self._reader = sitk.ImageFileReader()
        reader.SetFileName(str(self.path))
        with _no_warning(self.path):
            reader.ReadImageInformation()
        size, values = reader.GetSize(), reader.GetNumberOfComponents()
        self._not_only_pictures(reader)
        self._believable(reader)
        kinds = self._fields.get("kinds", "").replace('"', "").split()
        if kinds == ["domain", "domain", "list"] and len(size) == 3:
            raise FileError(f"{self.path}: Kinds says that it holds {size[2]} pictures over time, not a volume")
        if len(size) == 4 and values == 1:
            self.count = size[3]
        elif len(size) == 3 and values > 1 and kinds[:1] == ["list"]:
            self.count = values
        elif len(size) != 3 or values != 1:
            raise FileError(f"{self.path}: {len(size)} dimensions and {values} values a voxel, expected a volume")
        if self.count > 1:
            self._ask_host()

    def _open_folder(self) -> None:
        for inside in self.path.iterdir():
            if inside.exists() and not inside.is_file() and not inside.is_dir():
                raise FileError(f"{inside}: not a regular file")
            if inside.exists() and not os.access(inside, os.R_OK):  # GDCM would leave the slice out
                raise FileError(f"{inside}: cannot be read: {os.strerror(errno.EACCES)}")
        finder, folder = _images.sitk().ImageSeriesReader, str(self.path)
        for name in finder.GetGDCMSeriesIDs(folder):
            files = finder.GetGDCMSeriesFileNames(folder, name)
            slices = tuple(file for file in files if not _kretz.is_one(Path(file)))
            self._series += [slices] if slices else []
        if not self._series:
            raise FileError(f"{self.path}: the folder has no DICOM series")
        self.count = len(self._series)

    def _read_kretz(self, number: int) -> Any:
        try:
            image, self.count = _kretz.read(self.path, number, self._mirror)
        except HostError as error:
            raise _of_host(self.path, error) from None
        return image

    def _believable(self, reader: Any) -> None:
        """FileError for geometries that ITK takes without a word, and for more voxels than the file can hold."""
        size, spacing, origin = reader.GetSize(), reader.GetSpacing(), reader.GetOrigin()
        if len(size) >= 3:
            try:
                _checked_spacing(spacing[:3])
            except ValueError as error:
                raise FileError(f"{self.path}: {error}") from None
        self._numbers_that_hold(reader)
        if not np.isfinite(origin).all():
            raise FileError(f"{self.path}: origin={origin}, expected finite numbers")
        if math.prod(size[:3]) > _MOST_VOXELS:
            raise FileError(f"{self.path}: size={size}, expected at most {_MOST_VOXELS} voxels")
        name, there = self.path.name.lower(), self.path.stat().st_size
        # Of NIfTI the type in the file: values that are scaled become others.
        type_name = _images.sitk().GetPixelIDValueAsString(reader.GetPixelID())
        bits = int((re.findall(r"(\d+)-bit", type_name) or ["8"])[0]) * reader.GetNumberOfComponents()
        first = 0.0
        if reader.HasMetaDataKey("bitpix") and reader.HasMetaDataKey("vox_offset"):
            bits, first = int(reader.GetMetaData("bitpix")), float(reader.GetMetaData("vox_offset"))
        needed = math.prod(size) * bits // 8 + int(first)
        if name.endswith(".gz") or "gz" in self._fields.get("encoding", ""):
            there = there * 1032  # the best that deflate can do
        elif not name.endswith((".nii", ".vtk")) or b"ASCII" in _first_bytes(self.path):
            return
        if name.endswith(".nii.gz") and needed <= there:
            there = _inflated(self.path)
        if needed > there and "datafile" not in self._fields:
            raise FileError(f"{self.path}: size={size} needs {needed} bytes, the file holds {there} at most")

    def _numbers_that_hold(self, reader: Any) -> None:
        """FileError for numbers of the geometry that ITK cannot compute with: it takes 1 mm without a word then. A
        NRRD's NaN belongs to an axis that is none of space."""
        said = {name: value for name, value in self._fields.items() if name in ("spacings", "spacedirections")}
        nifti = [f"pixdim[{axis}]" for axis in (1, 2, 3)] + ["srow_x", "srow_y", "srow_z"]
        said |= {name: reader.GetMetaData(name) for name in nifti if reader.HasMetaDataKey(name)}
        for name, value in said.items():
            for number in re.findall(r"[-+]?(?:inf|nan|[.\d]+(?:e[-+]?\d+)?)", value.lower()):
                if abs(float(number)) > _FAR or ("nan" in number and name in nifti):
                    raise FileError(f"{self.path}: {name} is '{value}', expected finite numbers of {_FAR:g} at most")

    def _ask_host(self) -> None:
        """FileError if host_sim, which reads all of a MetaImage and is stricter than ITK, refuses the file."""
        if not self._unchecked:
            return
        try:
            self._host_says_patient = "\n  in the patient: not said" not in _host.run(["info", "--", str(self.path)])
        except HostError as error:
            if "give a window" not in str(error):  # said of values that were all read; clip says so, too
                raise _of_host(self.path, error) from None
        self._unchecked = False

    @property
    def knows_patient(self) -> bool:
        """True if the file says how the volume lies in the patient: the directions of its images are his then. Known
        once a volume was read."""
        if self._series:
            return True
        if self._kretz is not None or self.path.suffix.lower() in (".mha", ".mhd"):
            return self._host_says_patient
        codes = [
            self._reader.GetMetaData(code) for code in ("qform_code", "sform_code") if self._reader.HasMetaDataKey(code)
        ]
        return any(code.strip() != "0" for code in codes) or bool(_PATIENT.match(self._fields.get("space", "")))

    def _not_only_pictures(self, reader: Any) -> None:
        """FileError for what is DICOM, but no volume."""
        dicom = reader.GetMetaData("0008|0016").strip() if reader.HasMetaDataKey("0008|0016") else ""
        if dicom in _CINE:
            raise FileError(f"{self.path}: SOP class {dicom} holds pictures over time, not a volume")
        if dicom and reader.GetSize()[2:] in ((), (1,)):
            raise FileError(f"{self.path}: it is one picture of a DICOM series; name the folder that holds them all")

    def read(self, number: int = 0) -> Any:
        """Volume `number` as a SimpleITK image of 3 dimensions with one value a voxel."""
        self._ask_host()
        status = f"seq_frame{number:04d}_imagestatus"
        if self._reader is not None and self._fields.get(status, "").upper() == "INVALID":
            raise FileError(f"{self.path}: ImageStatus of volume {number} is INVALID")
        try:
            with _no_warning(None if self._series else self.path):
                return self._read(number)
        except OSError as error:
            raise _unreadable(self.path, error) from None
        except RuntimeError as error:
            raise FileError(f"{self.path}: {_reason(error)}") from None

    def _read(self, number: int) -> Any:
        sitk = _images.sitk()
        if self._kretz is not None:
            if self._kretz[0] != number:
                self._kretz = (number, self._read_kretz(number))
            return self._kretz[1]
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


def _of_host(path: Path, error: HostError) -> FileError:
    if error.code is None:
        return FileError(f"{path}: this format is read by host_sim; NRRD, NIfTI and DICOM need no host. {error}")
    return FileError(str(error).removeprefix("host_sim info: "))


def _header(path: Path) -> dict[str, str]:
    """The fields of a NRRD or MetaImage header, names in lower case without spaces. FileError: a NRRD's data is not in
    its folder or below it, wherever links lead."""
    fields: dict[str, str] = {}
    with open(path, "rb") as file:
        is_nrrd = file.read(4) == b"NRRD"
        while (is_nrrd or path.suffix.lower() in (".mha", ".mhd")) and file.tell() < _HEADER:
            line = file.readline(_HEADER)
            found = re.match(rb"([^:=]+)[:=]\s*(.*)", line.strip())
            name = found[1].decode("ascii", "replace").replace(" ", "").lower() if found else ""
            if found:
                fields[name] = os.fsdecode(found[2])
            if name == "elementdatafile" or (is_nrrd and name == "datafile") or not (line.strip() if is_nrrd else line):
                break
        if is_nrrd and "datafile" in fields:
            listed = fields["datafile"].split()[:1] == ["LIST"]
            rest = file.read(_HEADER).splitlines() if listed else []
            _stay_below(path, [os.fsdecode(name) for name in rest] or [fields["datafile"]])
    return fields


def _stay_below(header: Path, names: Sequence[str]) -> None:
    folder = header.parent.resolve()
    for name in names:
        files = [str(folder / name)]
        if "%" in name:  # a pattern of many names, and the numbers in them
            files += glob.glob(os.path.join(glob.escape(str(folder)), re.sub(r"%\d*d", "*", name.split()[0])))
        for file in map(Path, files):
            if not file.resolve().is_relative_to(folder) or (file.exists() and not file.is_file()):
                raise FileError(f"{header}: data file is '{name}', expected a regular file in the folder or below it")


def _first_bytes(path: Path) -> bytes:
    with open(path, "rb") as file:
        return file.read(512)


def _inflated(path: Path) -> int:
    """The bytes that a gzip file holds. SimpleITK does not say when they end early or are damaged."""
    count = 0
    try:
        with gzip.open(path) as file:
            while piece := file.read(1 << 20):
                count += len(piece)
    except (OSError, EOFError, zlib.error) as error:
        raise FileError(f"{path}: {error}") from None
    return count


@contextlib.contextmanager
def _no_warning(path: Path | None) -> Iterator[None]:
    """FileError for what ITK only warns of, or libtiff. None: ITK may warn; a series' spacing is judged here."""
    said: list[str] = []
    is_tiff = path is not None and path.suffix.lower() in (".tif", ".tiff")

    class Logger(_images.sitk().LoggerBase):  # type: ignore[misc]
        def DisplayWarningText(self, text: str) -> None:  # noqa: N802
            said.append(text)

    logger = Logger()
    before = logger.SetAsGlobalITKLogger()
    try:
        with _libtiff(said) if is_tiff else contextlib.nullcontext():
            yield
    finally:
        before.SetAsGlobalITKLogger()
    if said and path is not None:
        raise FileError(f"{path}: {said[0].strip().splitlines()[-1].split('): ')[-1]}")


@contextlib.contextmanager
def _libtiff(said: list[str]) -> Iterator[None]:
    """Puts into `said` the errors that libtiff writes to the standard error, and nowhere else. ITK goes on after them:
    with the pages before the cut, or with voxels that were never read. Warnings of tags that nobody needs do not
    count."""
    with tempfile.TemporaryFile() as file:
        before = os.dup(2)
        os.dup2(file.fileno(), 2)
        try:
            yield
        finally:
            os.dup2(before, 2)
            os.close(before)
            file.seek(0)
            for line in file.read(_HEADER).decode("utf-8", "replace").splitlines():
                if not re.match(r"\w+: ", line):
                    print(line, file=sys.stderr)  # not libtiff's
                elif "Warning" not in line or "IO error" in line:
                    said.append(line)


def _unreadable(path: Path, error: OSError) -> FileError:
    return FileError(f"{error.filename or path}: cannot be read: {error.strerror or error}")


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
        path.parent.mkdir(parents=True, exist_ok=True)
        write(part)
        os.replace(part, path)
    except (RuntimeError, OSError) as error:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)
        reason = (error.strerror or error) if isinstance(error, OSError) else _reason(error)
        raise OutputError(f"{path}: {reason}") from None
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
