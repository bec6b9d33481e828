# SPDX-License-Identifier: MIT
"""Saved pictures as DICOM: a secondary capture, or one of many frames."""

from __future__ import annotations

import datetime
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _images
from ._errors import FileError, extra_module
from ._files import whole
from ._version import FULL

_ONE = "1.2.840.10008.5.1.4.1.1.7"  # Secondary Capture Image Storage
_MANY = "1.2.840.10008.5.1.4.1.1.7.4"  # Multi-frame True Color Secondary Capture Image Storage
_EXPLICIT = "1.2.840.10008.1.2.1"  # the transfer syntax
_FRAME_MS = 80.0  # where a picture does not say it
_MOST = 2**32 - 2  # bytes of pixels that a file without compression holds
#: What a scan says of its patient and study; what it does not say stays empty, as DICOM lets it.
_OF_THE_SCAN = (
    ("PatientName", ""), ("PatientID", ""), ("PatientBirthDate", ""), ("PatientSex", ""), ("StudyInstanceUID", None),
    ("StudyDate", ""), ("StudyTime", ""), ("ReferringPhysicianName", ""), ("StudyID", ""), ("AccessionNumber", ""),
)  # fmt: skip
_WHOSE = ("PatientID", "PatientName", "StudyInstanceUID")


def pictures(paths: Sequence[str]) -> tuple[NDArray[np.uint8], float]:
    """All pictures, animated ones included, as [n, y, x, RGB], and how long each is shown, ms. FileError: a file is no
    picture, or another one is larger."""
    image = extra_module("PIL.Image", "Pillow", "files", "a picture")
    found: list[NDArray[np.uint8]] = []
    shown, total = 0.0, 0
    for path in paths:
        try:
            with image.open(path, formats=("PNG",)) as picture:
                for number in range(getattr(picture, "n_frames", 1)):
                    picture.seek(number)
                    found.append(np.asarray(picture.convert("RGB")))
                    shown, total = shown or float(picture.info.get("duration", 0)), total + found[-1].nbytes
                    if total > _MOST:
                        raise FileError(f"{path}: more than 4 GiB of pixels in all")
        except (OSError, SyntaxError, ValueError, image.DecompressionBombError) as error:
            raise FileError(f"{path}: is no PNG that can be read ({error})") from None
        if found[-1].shape != found[0].shape:
            own, first = (f"{one.shape[1]} x {one.shape[0]}" for one in (found[-1], found[0]))
            raise FileError(f"{path}: has {own} pixels, and {paths[0]} {first}: frames of a file are equally large")
    return np.stack(found), shown or _FRAME_MS


def _headers(path: Path) -> Iterator[Any]:
    """Those of a DICOM file, or of all of a folder."""
    pydicom = _images.pydicom()
    for file in sorted(one for one in path.rglob("*") if one.is_file()) if path.is_dir() else [path]:
        try:
            yield pydicom.dcmread(file, stop_before_pixels=True)
        except (pydicom.errors.InvalidDicomError, OSError, ValueError, AttributeError, KeyError):
            continue


def _scan(path: Path | None) -> Any:
    """The header of a scan. FileError: its files are of several patients or studies, so that nobody knows whose the
    pictures are."""
    if path is None:
        return _images.pydicom().Dataset()
    scan: Any = None
    for header in _headers(path):
        scan = header if scan is None else scan
        for key in _WHOSE:
            if header.get(key) != scan.get(key):
                raise FileError(f"{path}: its files differ in {key}; name the file that the pictures were made of")
    if scan is None:
        raise FileError(f"{path}: is no DICOM, so it says nothing of a patient")
    return scan


def _described(scan: Any, many: bool, frame_ms: float) -> Any:
    """All but the pixels."""
    pydicom = _images.pydicom()
    out, new, now = pydicom.Dataset(), pydicom.uid.generate_uid, datetime.datetime.now()
    for key, usual in _OF_THE_SCAN:
        value = scan.get(key, usual)
        setattr(out, key, new() if value is None else value)
    if encoding := scan.get("SpecificCharacterSet", "" if len(scan) else "ISO_IR 192"):
        out.SpecificCharacterSet = encoding
    out.SOPClassUID, out.SOPInstanceUID, out.SeriesInstanceUID = _MANY if many else _ONE, new(), new()
    out.Modality, out.SeriesNumber, out.InstanceNumber = "OT", 1, 1
    out.Manufacturer, out.SoftwareVersions, out.SeriesDescription = (
        "SmartVis",
        FULL,
        "For research, not a medical device",
    )
    out.ConversionType, out.ImageType, out.PatientOrientation = "WSD", ["DERIVED", "SECONDARY"], ""
    out.BurnedInAnnotation = "YES"  # a caption names the file, and who knows what a file is called
    out.LossyImageCompression = "00"
    out.DateOfSecondaryCapture = out.ContentDate = now.strftime("%Y%m%d")
    out.TimeOfSecondaryCapture = out.ContentTime = now.strftime("%H%M%S")
    if many:
        out.FrameIncrementPointer, out.FrameTime = 0x00181063, frame_ms
        out.PresentationLUTShape = "IDENTITY"
    return out


def write(paths: Sequence[str], out: Path, of: Path | None = None) -> Path:
    """Saved pictures as one DICOM file: of one picture a secondary capture, of several, or of an animated one, a
    multi-frame one. `of`: the DICOM scan that they were made of, which says whose they are; without it nobody does."""
    frames, frame_ms = pictures(paths)
    count, height, width, _ = frames.shape
    data = _described(_scan(of), count > 1, frame_ms)
    if count > 1:
        data.NumberOfFrames = count
    data.Rows, data.Columns = height, width
    data.SamplesPerPixel, data.PhotometricInterpretation, data.PlanarConfiguration = 3, "RGB", 0
    data.BitsAllocated = data.BitsStored = 8
    data.HighBit, data.PixelRepresentation = 7, 0
    pixels = frames.tobytes()
    data.PixelData = pixels + b"\0" * (len(pixels) % 2)
    data["PixelData"].VR = "OB"
    pydicom = _images.pydicom()
    data.file_meta = pydicom.dataset.FileMetaDataset()
    data.file_meta.TransferSyntaxUID = _EXPLICIT
    return whole(out, lambda part: data.save_as(part, enforce_file_format=True))
