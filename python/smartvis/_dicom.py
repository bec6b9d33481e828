# SPDX-License-Identifier: MIT
"""DICOM: which pictures of a file or folder make up a volume, where they lie, and how large they are."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _images, _pixels, _transducer
from ._errors import FileError

_UNEVEN = 0.05  # of the distance between slices
_CINE = ("1.2.840.10008.5.1.4.1.1.3", "1.2.840.10008.5.1.4.1.1.3.1")  # classes of ultrasound over time
# Of what was made of a scan: segmentations and their like, maps of values, radiotherapy.
_MADE_OF_ONE = ("1.2.840.10008.5.1.4.1.1.66.", "1.2.840.10008.5.1.4.1.1.30", "1.2.840.10008.5.1.4.1.1.481.")
_ASKEW = 0.02  # of directions' products, which writers round
_CENTIMETRES = 3  # of an ultrasound region's units
_ROUNDED = 0.02  # of a length that is said twice
_OTHERS = ("CT", "MR", "PT", "NM", "XA", "RF", "MG", "CR", "DX")  # modalities that are no ultrasound


@dataclass
class Frame:
    """One picture. What nobody says is None."""

    path: Path
    index: int  #: in the file
    count: int  #: of pictures in the file
    size: tuple[int, int]
    place: NDArray[np.float64] | None = None  #: of its first pixel, mm
    across: NDArray[np.float64] | None = None  #: directions along a row and down a column
    in_patient: bool = False  #: place and directions are of the patient, not of the machine
    own: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None  #: both in the volume's own frame of reference
    pixel: tuple[float, float] | None = None  #: mm along a row, down a column
    in_region: tuple[float, float] | None = None  #: the same by the ultrasound region, if there is one
    aspect: float | None = None  #: how much longer a pixel is down a column than along a row, as the file says it
    modality: str = ""
    apart: float | None = None  #: mm between slices, as the file says it
    said: _transducer.Said | None = None  #: of the probe
    table: _pixels.Table | None = None  #: of the values that its pixels stand for
    marks: dict[str, Any] = field(default_factory=dict)  #: what may tell volumes apart, in the order of trust


@dataclass
class Volume:
    """Pictures that lie behind one another."""

    name: str
    frames: list[Frame]
    spacing: tuple[float, float, float] | None
    origin: NDArray[np.float64]
    direction: NDArray[np.float64]  #: columns
    in_patient: bool
    probe: _transducer.Probe = _transducer.UNKNOWN
    told: str = ""  #: what a user may take otherwise than we do, in sentences


_PICTURES = {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff"}  # what slices are saved as


def volumes(files: Sequence[Path], where: Path, whole_file: bool = False) -> list[Volume]:
    """The volumes that the files make up, of a folder `where`, or that is the one file that was named (`whole_file`).
    FileError: none, or pictures that make up none."""
    groups: dict[Any, list[Frame]] = defaultdict(list)
    for path in files:
        for key, frame in _frames(path, whole_file):
            groups[key].append(frame)
    found = [volume for number, frames in enumerate(groups.values()) for volume in _divide(frames, number, len(groups))]
    if not found:
        pictures = sum(path.suffix.lower() in _PICTURES for path in files)
        other = f", but {pictures} pictures, which tell no length: save them as one TIFF file" if pictures else ""
        none = "the folder has no DICOM series" if files else "there is no file in the folder"
        raise FileError(f"{where}: {'is no picture' if whole_file else none + other}")
    return found


def _frames(path: Path, whole_file: bool) -> list[tuple[Any, Frame]]:
    pydicom = _images.pydicom()
    try:
        data = pydicom.dcmread(path, stop_before_pixels=True)
        if "Rows" not in data or "Columns" not in data:
            return []
        return _frames_of(path, data, whole_file)
    except pydicom.errors.InvalidDicomError:
        return []
    except (ValueError, TypeError, AttributeError, KeyError, IndexError, NotImplementedError, EOFError) as error:
        raise FileError(f"{path}: its DICOM header is damaged: {type(error).__name__}") from None


def _frames_of(path: Path, data: Any, whole_file: bool) -> list[tuple[Any, Frame]]:
    kind, count = str(data.get("SOPClassUID", "")), int(data.get("NumberOfFrames", 1) or 1)
    groups = data.get("PerFrameFunctionalGroupsSequence")
    if kind in _CINE:
        raise FileError(f"{path}: SOP class {kind} holds pictures over time, not a volume")
    if kind.startswith(_MADE_OF_ONE):
        if whole_file:
            raise FileError(f"{path}: it is no scan, but made of one ({data['SOPClassUID'].value.name})")
        return []  # beside the scan, in the folder of a study
    if whole_file and count == 1:
        raise FileError(f"{path}: it is one picture of a DICOM series; name the folder that holds them all")
    for name, inverted in (("PhotometricInterpretation", "MONOCHROME1"), ("PresentationLUTShape", "INVERSE")):
        if data.get(name) == inverted:  # which nobody below turns round
            raise FileError(f"{path}: its grey is inverted ({inverted}): convert it to MONOCHROME2")
    if groups and len(groups) != count:
        raise FileError(f"{path}: it has {count} pictures and says where {len(groups)} of them lie")
    said, table = _transducer.Said.of(data), _pixels.table_of(data, path)
    shared = (data.get("SharedFunctionalGroupsSequence") or [None])[0]
    series = str(data.get("SeriesInstanceUID", ""))
    out = []
    for index in range(count):
        layers = [part for part in (groups[index] if groups else None, shared, data) if part is not None]
        frame = Frame(path, index, count, (int(data.Columns), int(data.Rows)))
        _where(frame, layers)
        _how_large(frame, layers)
        _which(frame, layers, index)
        frame.modality = str(data.get("Modality", ""))
        frame.said, frame.table = said, table
        directions = () if frame.across is None else tuple(np.round(frame.across.ravel(), 4))
        out.append(((series if count == 1 else str(path), frame.size, directions), frame))
    return out


def _first(layers: Sequence[Any], sequence: str, name: str) -> Any:
    """A value of a functional group, of the picture's own or the shared ones; or of the picture itself."""
    for layer in layers:
        items = layer.get(sequence)
        value = items[0].get(name) if items else layer.get(name)
        if value is not None and value != "":
            return value
    return None


def _count(value: Any) -> float:
    """What volumes are in order of: of what is no number, all are equal."""
    return float(value) if isinstance(value, int | float) else 0.0


def _numbers(value: Any, count: int) -> NDArray[np.float64] | None:
    if value is None:
        return None
    numbers = np.array([float(part) for part in value])
    return numbers if len(numbers) == count and np.isfinite(numbers).all() else None


def _where(frame: Frame, layers: Sequence[Any]) -> None:
    place = _numbers(_first(layers, "PlanePositionSequence", "ImagePositionPatient"), 3)
    across = _numbers(_first(layers, "PlaneOrientationSequence", "ImageOrientationPatient"), 6)
    frame.in_patient = across is not None
    own_place = _numbers(_first(layers, "PlanePositionVolumeSequence", "ImagePositionVolume"), 3)
    own_across = _numbers(_first(layers, "PlaneOrientationVolumeSequence", "ImageOrientationVolume"), 6)
    if own_place is not None and own_across is not None:
        frame.own = (own_place, own_across.reshape(2, 3))
    frame.place = own_place if place is None else place
    across = own_across if across is None else across
    frame.across = None if across is None else across.reshape(2, 3)
    if frame.across is not None and np.abs(frame.across @ frame.across.T - np.eye(2)).max() > _ASKEW:
        raise FileError(
            f"{frame.path}: its rows and columns run along {', '.join(f'{part:g}' for part in frame.across.ravel())}, "
            "expected directions of length 1 at right angles"
        )


def _how_large(frame: Frame, layers: Sequence[Any]) -> None:
    pixel = _numbers(_first(layers, "PixelMeasuresSequence", "PixelSpacing"), 2)
    for name in ("ImagerPixelSpacing", "NominalScannedPixelSpacing"):  # of secondary captures
        pixel = _numbers(layers[-1].get(name), 2) if pixel is None else pixel
    frame.in_region = _of_region(layers[-1].get("SequenceOfUltrasoundRegions"))
    if pixel is None and frame.in_region:
        pixel = np.array(frame.in_region[::-1])
    if pixel is not None and (pixel > 0).all():
        frame.pixel = (float(pixel[1]), float(pixel[0]))
    aspect = _numbers(layers[-1].get("PixelAspectRatio"), 2)
    if aspect is not None and (aspect > 0).all():
        frame.aspect = float(aspect[0] / aspect[1])
    apart = _first(layers, "PixelMeasuresSequence", "SpacingBetweenSlices")  # how thick they are says nothing of it
    if apart is not None and float(apart) > 0:
        frame.apart = float(apart)


def _of_region(regions: Any) -> tuple[float, float] | None:
    """mm of a pixel by a picture's only ultrasound region."""
    if not regions or len(regions) != 1:
        return None
    region = regions[0]
    if not _CENTIMETRES == region.get("PhysicalUnitsXDirection") == region.get("PhysicalUnitsYDirection"):
        return None
    lengths = abs(10 * float(region.PhysicalDeltaX)), abs(10 * float(region.PhysicalDeltaY))
    return lengths if all(lengths) else None


def _which(frame: Frame, layers: Sequence[Any], index: int) -> None:
    content = "FrameContentSequence"
    number = layers[-1].get("InstanceNumber")
    frame.marks = {
        "time": _first(layers, content, "TemporalPositionIndex") or layers[-1].get("TemporalPositionIdentifier"),
        "time offset": _first(layers, "TemporalPositionSequence", "TemporalPositionTimeOffset"),
        "stack": _first(layers, content, "StackID"),
        "kind": str(_first(layers, "ImageDataTypeSequence", "DataType") or layers[-1].get("ImageType", "")),
        "trigger time": layers[-1].get("TriggerTime"),
        "acquisition": layers[-1].get("AcquisitionNumber"),
        "acquisition time": _first(layers, content, "FrameAcquisitionDateTime") or layers[-1].get("AcquisitionTime"),
        "content time": layers[-1].get("ContentTime"),
        "order": (int(number) if number is not None and str(number) else 0, index),
    }


# ------------------------------------------------------------------------------------------------ volumes


def _divide(frames: list[Frame], number: int, groups: int) -> list[Volume]:
    """Pictures of one series and direction: one volume, or several of the same places."""
    series = f"series {number + 1}" if groups > 1 else ""
    frames.sort(key=lambda frame: (frame.marks["order"], str(frame.path)))
    if any(frame.place is None or frame.across is None for frame in frames):
        return [_volume(frames, series, placed=False)]
    along = {id(frame): round(_depth(frame), 3) for frame in frames}
    places = len(set(along.values()))
    if places == len(frames):
        return [_volume(frames, series)]
    if places == 1:
        raise FileError(
            f"{frames[0].path}: it and others, {len(frames)} pictures, lie at one place: they make up no volume"
        )
    seen: dict[float, int] = defaultdict(int)
    for frame in frames:
        frame.marks["turn"] = seen[along[id(frame)]]
        seen[along[id(frame)]] += 1
    for mark in frames[0].marks:
        if mark == "order":
            continue
        parts: dict[Any, list[Frame]] = defaultdict(list)
        for frame in frames:
            parts[str(frame.marks[mark])].append(frame)
        if all(len({along[id(f)] for f in part}) == len(part) == places for part in parts.values()):
            in_turn = sorted(parts.items(), key=lambda one: _count(one[1][0].marks[mark]))
            return [_volume(part, f"{series}{', ' if series else ''}{mark} {value}") for value, part in in_turn]
    raise FileError(
        f"{frames[0].path}: it and others, {len(frames)} pictures, lie at {places} places, some more often than "
        "others: which of them make up a volume is not said"
    )


def _depth(frame: Frame) -> float:
    assert frame.place is not None and frame.across is not None
    return float(frame.place @ np.cross(*frame.across))


def _volume(frames: list[Frame], name: str, placed: bool = True) -> Volume:
    if len(frames) == 1 and frames[0].count == 1:
        raise FileError(f"{frames[0].path}: it is one picture of a DICOM series; the others are not there")
    if len(frames) == 1:
        raise FileError(
            f"{frames[0].path}: no other of its pictures lies along picture {frames[0].index + 1}: no volume"
        )
    if any(frame.pixel != frames[0].pixel for frame in frames):
        raise FileError(f"{frames[0].path}: pixels of one DICOM series differ in size")
    apart = frames[0].apart
    if placed:
        frames = sorted(frames, key=_depth)
        apart = _evenly(frames)
    pixel = frames[0].pixel
    direction = np.eye(3)
    if placed and frames[0].across is not None:
        row, column = frames[0].across
        direction = np.stack([row, column, np.cross(row, column)], axis=1)
    spacing = None if pixel is None or apart is None else (*pixel, apart)
    origin = frames[0].place if placed and frames[0].place is not None else np.zeros(3)
    probe = _transducer.UNKNOWN
    first, last = frames[0].own, frames[-1].own
    if placed and frames[0].said and first and last and spacing:
        probe = frames[0].said.seen(first, last[0] - first[0], spacing, (*frames[0].size, len(frames)))
    told = _said_twice(frames[0], apart if placed else None)
    return Volume(name, frames, spacing, origin, direction, placed and frames[0].in_patient, probe, told)


def _said_twice(frame: Frame, apart: float | None) -> str:
    """What its header says otherwise in another place, and which counts. `apart`: mm by the planes' places."""

    def differ(one: Sequence[float], other: Sequence[float]) -> bool:
        return any(abs(a - b) > _ROUNDED * max(a, b) for a, b in zip(one, other, strict=True))

    told = []
    if frame.pixel and frame.in_region and differ(frame.pixel, frame.in_region):
        (x, y), (region_x, region_y) = frame.pixel, frame.in_region
        told.append(
            f"Its pixels are {x:.4g} x {y:.4g} mm large, by its ultrasound region {region_x:.4g} x {region_y:.4g}: the "
            "first counts."
        )
    if frame.pixel and frame.aspect and differ([frame.pixel[1]], [frame.pixel[0] * frame.aspect]):
        x, y = frame.pixel
        told.append(
            f"Its pixels are {x:.4g} x {y:.4g} mm large, by PixelAspectRatio {frame.aspect:.4g} times as long as wide: "
            "the first counts."
        )
    if frame.apart and apart and differ([frame.apart], [apart]):
        told.append(
            f"SpacingBetweenSlices says {frame.apart:.4g} mm, the places of its planes {apart:.4g}: the places count."
        )
    if frame.modality in _OTHERS:
        told.append(f"Its modality is {frame.modality}: it is no ultrasound.")
    return " ".join(told)


def _evenly(frames: list[Frame]) -> float:
    """mm from slice to slice; FileError: not the same everywhere, and with one missing the rest lie in the wrong
    place; or slices beside each other."""
    steps = np.diff(np.array([frame.place for frame in frames]), axis=0)
    gaps = np.linalg.norm(steps, axis=1)
    usual = float(np.median(gaps))
    worst = int(np.abs(gaps - usual).argmax())
    if usual <= 0 or abs(gaps[worst] - usual) > _UNEVEN * usual:
        raise FileError(
            f"{frames[worst + 1].path}: it lies {gaps[worst]:.4g} mm behind the slice before it, others of the DICOM "
            f"series {usual:.4g} mm: slices are missing or not evenly spaced"
        )
    assert frames[0].across is not None
    aside = float(np.linalg.norm(steps @ frames[0].across.T, axis=1).max())
    if aside > _UNEVEN * usual:
        raise FileError(
            f"{frames[0].path}: slices of its DICOM series lie {aside:.4g} mm beside the one before: no box"
        )
    return round(float(gaps.mean()), 6)  # positions are decimal texts
