# SPDX-License-Identifier: MIT
"""What a file says of lengths, place and probe, where SimpleITK reads it otherwise or not at all."""

from __future__ import annotations

import math
import os
import re
import struct
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from . import _images, _nifti
from ._errors import FileError

_UNITS = {"mm": 1.0, "millimeter": 1.0, "millimetre": 1.0, "cm": 10.0, "centimeter": 10.0, "m": 1e3, "meter": 1e3}
_UNITS |= dict.fromkeys(("um", "µm", "\u03bcm", "micron", "micrometer"), 1e-3) | {"nm": 1e-6, "in": 25.4, "inch": 25.4}

_NO_UNITS = ("", "pixel", "pixels", "voxel", "none", "reference frame")  # of ImageJ and OME, where nobody knows


def _millimetres(path: Path, unit: str) -> float:
    """Of a unit of length by its name; FileError: nobody knows it."""
    name = unit.strip().lower()
    for known in (name, name.removesuffix("s"), name.replace("tre", "ter").removesuffix("s")):
        if known in _UNITS:
            return _UNITS[known]
    raise FileError(f"{path}: its lengths are in '{unit}', expected one of {', '.join(_UNITS)}")


def unit(path: Path, fields: dict[str, str], notes: dict[str, str]) -> float:
    """mm of a NRRD's unit of space, or a MetaImage's. ITK takes it for 1, and notes the second in what it writes."""
    given = re.findall(r'"([^"]*)"', fields.get("spaceunits", fields.get("units", "")))
    given = given or [fields.get("distanceunits", notes.get(_images.UNIT.lower(), ""))]
    units = {_millimetres(path, unit) for unit in given[:3] if unit.strip("? ")}
    if len(units) > 1:
        raise FileError(f"{path}: its axes have different units, {', '.join(given)}")
    return units.pop() if units else 1.0


def check_marks(path: Path, fields: dict[str, str]) -> None:
    """FileError for a NRRD's numbers with a comma as decimal mark: of spacings ITK reads what stands before it; and for
    a space with time."""
    apart, vectors = fields.get("spacings", ""), fields.get("spacedirections", "")
    space = fields.get("space", "")
    if re.search(r"time$|^[lr][ap]st$", space.lower()):
        raise FileError(f"{path}: its space is '{space}', expected one of three dimensions, without time")
    parts = re.findall(r"\(([^)]*)\)", vectors)  # as many numbers as there are of them, at most
    if "," in apart or any(part.count(",") >= max(3, len(parts)) for part in parts):
        raise FileError(f"{path}: its spacing is '{apart or vectors}', expected a point as decimal mark")


def check_kinds(path: Path, fields: dict[str, str]) -> bool:
    """Whether a NRRD's kinds say that an axis is a list or time. FileError: another one than ITK can take for it."""
    if "ndims" in fields:  # MetaImage, of which the machine knows more
        return False
    kinds = fields.get("kinds", "").replace('"', "").split()
    over_time = [axis for axis, kind in enumerate(kinds) if kind in ("list", "time")]
    if over_time == [2] and len(kinds) == 3:
        count = fields.get("sizes", "").split()[2:]
        raise FileError(f"{path}: Kinds says that it holds {''.join(count)} pictures over time, not a volume")
    for axis in over_time:
        if axis != len(kinds) - 1 and (axis, kinds[axis]) != (0, "list"):
            raise FileError(f"{path}: Kinds says that axis {axis + 1} is time, expected the last one")
    return bool(over_time)


def in_other_words(path: Path, fields: dict[str, str]) -> tuple[float, ...]:
    """How far apart voxels are, where ITK does not read it: by the limits of a NRRD's axes, or VTK's older word. ()
    elsewhere."""
    told: list[float] = []
    try:
        if path.name.lower().endswith(".vtk"):
            found = re.search(
                rb"^ASPECT_RATIO\s+(\S+)\s+(\S+)\s+(\S+)", first_bytes(path), re.MULTILINE | re.IGNORECASE
            )
            told = [float(length) for length in found.groups()] if found else []
        elif "spacings" not in fields:
            told = _between_limits(fields)
    except ValueError:  # no numbers
        return ()
    return tuple(told) if all(math.isfinite(length) and length > 0 for length in told) else ()


def _between_limits(fields: dict[str, str]) -> list[float]:
    least, most, sizes = (fields.get(name, "").split() for name in ("axismins", "axismaxs", "sizes"))
    centres = fields.get("centers", fields.get("centerings", "")).split()  # the definition has both names
    fewer = {"cell": 0, "node": 1}
    if not len(least) == len(most) == len(sizes) == len(centres) == 3 or not fewer.keys() >= set(centres):
        return []
    return [
        abs(float(high) - float(low)) / max(1, int(size) - fewer[centre])
        for low, high, size, centre in zip(least, most, sizes, centres, strict=True)
    ]


def says_spacing(path: Path, fields: dict[str, str], reader: Any, head: _nifti.Header | None) -> bool:
    """Whether the file says how far apart voxels are; ITK says 1 if not."""
    name = path.name.lower()
    if name.endswith((".nrrd", ".nhdr")):
        told = fields.get("spacings", "") or fields.get("spacedirections", "")
        return sum(not re.search("nan|none", part) for part in re.findall(r"\([^)]*\)|\S+", told.lower())) >= 3
    if reader.HasMetaDataKey("pixdim[1]"):
        apart = {float(reader.GetMetaData(f"pixdim[{axis}]")) for axis in (1, 2, 3)}
        has_unit = int(float(reader.GetMetaData("xyzt_units"))) & 7
        return not (head and _nifti.lacks_lengths(head)) and (apart != {1.0} or bool(has_unit))
    return not name.endswith(".vtk") or b"SPACING" in first_bytes(path).upper()


def check_pages(path: Path) -> None:
    """FileError: pages of a TIFF differ in size. Of which other size a page may be, a preview, the file says."""
    import tifffile

    try:
        with tifffile.TiffFile(path) as file:
            sizes = {(page.imagewidth, page.imagelength) for page in file.pages if not page.is_reduced}
    except Exception:  # its reader says what is wrong
        return
    if len(sizes) > 1:
        told = " and ".join(f"{width} x {height}" for width, height in sorted(sizes, reverse=True))
        raise FileError(f"{path}: its pages are of {told} pixels: save those of the volume as a file")


def tiff_spacing(path: Path) -> tuple[float, ...] | None:
    """What ImageJ or OME writes into a TIFF of the distances of its voxels. None: it says nothing of an axis.
    FileError: its pages are several volumes, or white is 0."""
    import tifffile

    try:
        with tifffile.TiffFile(path) as file:
            notes, tags, ome = file.imagej_metadata or {}, file.pages[0].tags, file.ome_metadata or ""
            lines = [tags[name].value for name in ("XResolution", "YResolution") if name in tags]
            sizes = dict(zip(file.series[0].axes, file.series[0].shape, strict=True))
            inverted = "PhotometricInterpretation" in tags and tags["PhotometricInterpretation"].value == 0
    except Exception:  # of a file whose voxels were read, and that says nothing more
        return None
    if inverted:  # which ITK does not turn round
        raise FileError(f"{path}: its grey is inverted (white is 0): invert it first")
    for axis, what in (("T", "times"), ("C", "channels")):
        if sizes.get(axis, 1) > 1:
            raise FileError(f"{path}: its pages are of {sizes[axis]} {what}: save each as a file of its own")
    said = [re.search(f'PhysicalSize{axis}="([^"]+)"', ome) for axis in "XYZ"]
    units = [re.search(f'PhysicalSize{axis}Unit="([^"]+)"', ome) for axis in "XYZ"]
    if any(unit and unit[1].lower() in _NO_UNITS for unit in units):
        return None
    if all(said):
        return tuple(
            _millimetres(path, unit[1] if unit else "um") * float(length[1])
            for length, unit in zip(said, units, strict=True)
            if length
        )
    unit, apart = notes.get("unit", ""), float(notes.get("spacing", 0))
    if unit.lower() in _NO_UNITS or apart <= 0 or len(lines) < 2 or not all(line[0] for line in lines):
        return None
    mm = _millimetres(path, unit.replace("\\u00B5", "u"))
    return mm * lines[0][1] / lines[0][0], mm * lines[1][1] / lines[1][0], mm * apart


def side(letters: str) -> str:
    """PLUS' letters as the side of the probe: the axis that runs far from it (F) or near to it (N). "MFA" is PLUS'
    constant and says nothing of a volume."""
    at = max(letters.find("F"), letters.find("N"))
    if len(letters) != 3 or at < 0 or letters == "MFA":
        return ""
    return ("-" if letters[at] == "F" else "+") + "xyz"[at]


def patched(path: Path, fields: dict[str, str]) -> Any:
    """A copy of a MetaImage that ITK reads wrongly or not at all: of four dimensions with a matrix and places of three,
    as SUPRA writes it, or compressed without CompressedDataSize; None: it needs none."""
    numbers = fields.get("transformmatrix", "").split()
    is_of_three = fields.get("ndims") == "4" and len(numbers) == 9
    is_unsized = fields.get("compresseddata", "").lower() in ("true", "t", "1") and "compresseddatasize" not in fields
    if not is_of_three and not is_unsized:
        return None
    data = path.read_bytes()
    head, line, rest = data.partition(b"ElementDataFile")
    value, _, voxels = rest.partition(b"\n")
    skipped = int(fields.get("headersize", 0))
    if b"LOCAL" not in value.upper():
        name = os.fsdecode(value.split(b"=", 1)[1].strip())
        value, voxels = b" = LOCAL", (path.parent / name).read_bytes()[max(skipped, 0) :]
    elif skipped > 0:
        voxels = data[skipped:]
    lines = _in_four(fields, numbers) if is_of_three else []
    lines += [f"CompressedDataSize = {len(voxels)}"] if is_unsized else []
    lines += ["HeaderSize = 0"] if skipped > 0 else []
    written = {line.split(" =")[0].encode() for line in lines}
    kept = [part for part in head.splitlines() if re.split(rb"[=:]", part)[0].strip() not in written]
    copy = tempfile.NamedTemporaryFile(suffix=".mha")  # noqa: SIM115  # lives as long as its reader
    encoded = [line.encode() for line in lines]
    copy.write(b"\n".join([*kept[:2], *encoded, *kept[2:]]) + b"\n" + line + value + b"\n" + voxels)
    copy.flush()
    return copy


def _in_four(fields: dict[str, str], numbers: list[str]) -> list[str]:
    """Fields of three numbers with a fourth."""
    matrix = np.eye(4)
    matrix[:3, :3] = np.reshape([float(n) for n in numbers], (3, 3))
    lines = [f"TransformMatrix = {' '.join(str(n) for n in matrix.ravel())}"]
    for name, more in (("Offset", "0"), ("ElementSpacing", "1"), ("CenterOfRotation", "0")):
        told = fields.get(name.lower(), "").split()
        lines += [f"{name} = {' '.join([*told, more][:4])}"] if told else []
    return lines


def left_over(path: Path, fields: dict[str, str], needed: int) -> int:
    """Bytes that a file holds behind its voxels, which need so many with a NIfTI's header; 0 where that is not known,
    as of a data file."""
    name, there = path.name.lower(), path.stat().st_size
    if fields.keys() & {"datafile", "byteskip", "lineskip"}:
        return 0
    if name.endswith(".nii.gz") or fields.get("encoding") in ("gzip", "gz"):
        there = _said_by_gzip(path)
    elif name.endswith(".vtk"):
        there -= _end_of_head(path, rb"\nBINARY\r?\n.*?\nLOOKUP_TABLE[^\n]*\n", there)
        with open(path, "rb") as file:
            file.seek(-max(0, there - needed), os.SEEK_END)
            behind = file.read(64).strip()
        if not behind or behind.startswith(b"METADATA"):  # as VTK's own writer puts it there
            return 0
    elif fields.get("encoding") == "raw":
        there -= _end_of_head(path, rb"\n\r?\n", there)
    elif not name.endswith(".nii"):
        return 0
    return max(0, there - needed)


def _end_of_head(path: Path, end: bytes, otherwise: int) -> int:
    """Where a header ends that ends so."""
    with open(path, "rb") as file:
        found = re.search(end, file.read(1 << 16), re.DOTALL)
    return found.end() if found else otherwise


def _said_by_gzip(path: Path) -> int:
    """Bytes that are packed in a file, by its last four; 0 if that is more than deflate can pack."""
    with open(path, "rb") as file:
        file.seek(-4, os.SEEK_END)
        (inside,) = struct.unpack("<I", file.read(4))
    return inside if inside <= 1032 * path.stat().st_size else 0


def first_bytes(path: Path) -> bytes:
    with open(path, "rb") as file:
        return file.read(512)
