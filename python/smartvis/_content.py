# SPDX-License-Identifier: MIT
"""What a file is by its first bytes. SimpleITK goes by the name, and reads formats whose geometry nobody here knows."""

from __future__ import annotations

import gzip
import os
import re
import struct
import zlib
from collections.abc import Iterable, Iterator
from pathlib import Path

from ._errors import FileError

_HEAD = 1 << 16
_NAMES = {  # of a format: the endings that SimpleITK knows it by; a file of another name is to take the first
    "NRRD": (".nrrd", ".nhdr"),
    "MetaImage": (".mha", ".mhd"),
    "NIfTI": (".nii", ".hdr", ".img"),
    "NIfTI in gzip": (".nii.gz", ".hdr.gz", ".img.gz"),
    "TIFF": (".tif", ".tiff"),
    "VTK": (".vtk",),
}
_NEVER = {  # what is read under no name, and why
    "packed": "it is compressed as a whole: unpack it first",
    "NIfTI-2": "it is NIfTI-2, which is not read here: save it as NIfTI-1",
    "Analyze": "it is Analyze 7.5, which does not say where left is: save it as NIfTI",
    "companion": "it is what macOS keeps beside a file, not the file: that is called so without ._ in front",
    "pointer": "it is a pointer of Git LFS, not the file: `git lfs pull` brings that",
    "page": "it is a web page, perhaps of a download that failed",
    "zip": "it is a zip archive: unpack it first",
    "picture": "it is a picture: one file has all slices of a volume",
    "video": "it is a video, not a volume",
    "HDF5": "it is HDF5, as MINC and NetCDF are, which is not read here: save it as NRRD",
    "NumPy": "it is an array of NumPy, which says no spacing: save it as NRRD",
    "VTK's XML": "it is VTK's XML format, which is not read here: save it in the legacy format, or as NRRD",
    "XML": "it is XML, perhaps an answer that a server sent instead of the file",
    "JSON": "it is JSON, perhaps an answer that a server sent instead of the file",
    "PDF": "it is a PDF document",
    "UTF-16": "it is text in UTF-16: save it as plain text",
    "mark": "it begins with a byte order mark, as no header does: save it without one",
    "DICOM": "it is DICOM without its preamble: dcmconv of DCMTK writes one",
    "nothing": "the file is empty",
}
_MARKS = (
    (rb"NRRD", "NRRD"),
    (rb"\x00\x05\x16\x07", "companion"),
    (rb"version https://git-lfs", "pointer"),
    (rb"\s*<(?i:!doctype html|html)", "page"),
    (rb"\s*(<\?xml[^>]*>\s*)?<VTKFile", "VTK's XML"),
    (rb"\s*<\?xml", "XML"),
    (rb"\s*\{", "JSON"),
    (rb"\x89HDF", "HDF5"),
    (rb"\x93NUMPY", "NumPy"),
    (rb"%PDF", "PDF"),
    (rb"\xff\xfe|\xfe\xff", "UTF-16"),
    (rb"\xef\xbb\xbf", "mark"),
    (rb"BZh|\xfd7zXZ|7z\xbc\xaf|\x28\xb5\x2f\xfd|Rar!", "packed"),
    (rb"....ftyp", "video"),
    (rb"PK\x03\x04", "zip"),
    (rb"\x89PNG|\xff\xd8\xff|BM", "picture"),
    (rb"II[*+]\x00|MM\x00[*+]", "TIFF"),
    (rb"# vtk DataFile", "VTK"),
    (rb"[\x02\x08]\x00.\x00[A-Z][A-Z]", "DICOM"),
    (rb"\s*[A-Za-z]\w*\s*[=:]", "MetaImage"),
)


def is_nifti(path: Path) -> bool:
    """By its name."""
    return path.name.lower().endswith(_NAMES["NIfTI"] + _NAMES["NIfTI in gzip"])


def is_tiff(path: Path) -> bool:
    """By its name."""
    return path.name.lower().endswith(_NAMES["TIFF"])


def check(path: Path) -> None:
    """FileError for what the name does not say: another format, or one that is not read. Of a file that is nothing
    known its reader says why."""
    with open(path, "rb") as file:
        kind = _kind(path, file.read(_HEAD))
    if kind in _NEVER:
        raise FileError(f"{path}: {_NEVER[kind]}")
    name = path.name.lower()
    if kind in _NAMES and not name.endswith(_NAMES[kind]):
        raise FileError(f"{path}: by its content it is {kind}, not by its name: let it end in {_NAMES[kind][0]}")
    if not kind and not name.endswith(tuple(ending for endings in _NAMES.values() for ending in endings)):
        listed = ", ".join([*list(_NAMES)[:3], *list(_NAMES)[4:]])
        raise FileError(f"{path}: is none of {listed}, DICOM and Kretz, which are read")
    if kind == "VTK":
        _check_vtk(path)
    elif kind == "TIFF":
        _check_tiff(path)


def _kind(path: Path, head: bytes) -> str:
    if not head:
        return "nothing"
    if head[:2] != b"\x1f\x8b":
        return _of_bytes(path, head)
    inside = _of_bytes(path, _unpacked(head))
    if inside == "NIfTI":
        return "NIfTI in gzip"
    return inside if inside in ("NIfTI-2", "Analyze") else "packed"


def _unpacked(head: bytes) -> bytes:
    """As far as it goes."""
    try:
        return zlib.decompressobj(15 + 32).decompress(head, _HEAD)
    except zlib.error:
        return b""


def _of_bytes(path: Path, head: bytes) -> str:
    for order in "<>":
        size = struct.unpack_from(f"{order}i", head)[0] if len(head) >= 4 else 0
        if size == 540 and head[4:7] in (b"n+2", b"ni2"):
            return "NIfTI-2"
        if size == 348:
            return "NIfTI" if head[344:347] in (b"n+1", b"ni1") else "Analyze"
    beside = Path(f"{str(path)[:-4]}.hdr")
    if path.suffix.lower() == ".img" and beside.is_file():
        return _of_bytes(beside, beside.read_bytes()[:_HEAD])
    return next((kind for mark, kind in _MARKS if re.match(mark, head, re.DOTALL)), "")


def _check_tiff(path: Path) -> None:
    """FileError: its pages never end. Whatever else is wrong is told by who reads them."""
    if in_circle(pages_of_tiff(path)):
        raise FileError(f"{path}: its pages lead in a circle: the file is damaged")


def in_circle(places: Iterable[int]) -> bool:
    """One of them comes again."""
    known: set[int] = set()
    for place in places:
        if place in known:
            return True
        known.add(place)
    return False


def pages_of_tiff(path: Path) -> Iterator[int]:
    """Where the directories of its pages begin, as each leads to the next, as far as they are there."""
    with open(path, "rb") as file:
        head = file.read(16)
        order = "<" if head[:2] == b"II" else ">"
        large = 43 in head[2:4]  # BigTIFF
        place, count, entry = (f"{order}Q", f"{order}Q", 20) if large else (f"{order}I", f"{order}H", 12)
        try:
            (at,) = struct.unpack_from(place, head, 8 if large else 4)
            while at:
                yield at
                file.seek(at)
                (entries,) = struct.unpack(count, file.read(struct.calcsize(count)))
                file.seek(entry * entries, os.SEEK_CUR)
                (at,) = struct.unpack(place, file.read(struct.calcsize(place)))
        except (struct.error, OSError, OverflowError):
            return


def _check_vtk(path: Path) -> None:
    """FileError: no image, or its values belong to cells, which SimpleITK takes for those of points, of which each row
    has one more."""
    with open(path, "rb") as file:
        head = file.read(_HEAD)
    kind = re.search(rb"^DATASET\s+(\w+)", head, re.MULTILINE | re.IGNORECASE)
    if kind and kind[1].upper() != b"STRUCTURED_POINTS":
        raise FileError(f"{path}: its dataset is {kind[1].decode()}, expected STRUCTURED_POINTS")
    if re.search(rb"^POINT_DATA\s+\d+\s+FIELD", head, re.MULTILINE | re.IGNORECASE):
        raise FileError(f"{path}: its values are in a FIELD, expected SCALARS")
    first = re.search(rb"^(POINT|CELL)_DATA", head, re.MULTILINE | re.IGNORECASE)
    if first and first[1].upper() == b"CELL":
        raise FileError(
            f"{path}: its values belong to cells (CELL_DATA), which are read as points elsewhere: save them as "
            "POINT_DATA, with one point a voxel"
        )


def unpacked(path: Path, most: int) -> bytes:
    """The first bytes of a file, of one in gzip those in it."""
    with open(path, "rb") as file:
        packed = file.read(2) == b"\x1f\x8b"
    with gzip.open(path) if packed else open(path, "rb") as file:
        return file.read(most)
