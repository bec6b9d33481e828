# SPDX-License-Identifier: MIT
"""DICOM as users have it, of one scan: kinds, colour spaces, transfer syntaxes."""

import io
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import SimpleITK as sitk
from PIL import Image  # type: ignore[import-not-found]


def enhanced(
    path: Path, voxels: np.ndarray, times: int = 1, measures: bool = True, missing: int = -1, grey: str = "MONOCHROME2",
    step: Sequence[float] = (0.0, 0.0, 2.5), across: Sequence[float] = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0),
    of_class: str = "6.2",
) -> None:  # fmt: skip
    """An Enhanced US Volume: spacing in the shared functional groups, place and time in those of each frame. Without a
    `step` only how thick they are."""
    from pydicom.dataset import Dataset, FileMetaDataset
    from pydicom.uid import ExplicitVRLittleEndian, generate_uid

    def of(**fields: Any) -> Dataset:
        made = Dataset()
        for name, value in fields.items():
            setattr(made, name, value)
        return made

    where = [(t, z) for t in range(times) for z in range(48) if (t, z) != (0, missing)]
    shared = of(PlaneOrientationVolumeSequence=[of(ImageOrientationVolume=list(across))])
    if measures:
        apart = {"SpacingBetweenSlices": 2.5} if step else {}
        shared.PixelMeasuresSequence = [of(PixelSpacing=[1.25, 1.25], SliceThickness=2.5, **apart)]
    frames = [
        of(
            FrameContentSequence=[of(TemporalPositionIndex=t + 1, DimensionIndexValues=[t + 1, z + 1])],
            PlanePositionVolumeSequence=[of(ImagePositionVolume=[part * z for part in step])] if step else [],
        )
        for t, z in where
    ]
    kind = f"1.2.840.10008.5.1.4.1.1.{of_class}"
    data = of(SOPClassUID=kind, SOPInstanceUID=generate_uid(), Modality="US", SeriesInstanceUID=generate_uid())
    data.SamplesPerPixel, data.PhotometricInterpretation, data.NumberOfFrames = 1, grey, len(where)
    data.Rows, data.Columns, data.BitsAllocated, data.BitsStored, data.HighBit = 96, 96, 8, 8, 7
    data.PixelRepresentation, data.PixelData = 0, b"".join(voxels[z].tobytes() for _, z in where)
    data.SharedFunctionalGroupsSequence, data.PerFrameFunctionalGroupsSequence = [shared], frames
    data.file_meta = FileMetaDataset()
    data.file_meta.MediaStorageSOPClassUID, data.file_meta.TransferSyntaxUID = kind, ExplicitVRLittleEndian
    data.file_meta.MediaStorageSOPInstanceUID = data.SOPInstanceUID
    data.save_as(path, enforce_file_format=True)


def folder_of(path: Path, voxels: np.ndarray) -> None:
    path.mkdir()
    enhanced(path / "segments.dcm", voxels, of_class="66.4")  # of a study, beside its volumes
    for number in range(2):
        enhanced(path / f"t{number}.dcm", voxels)


def changed(path: Path, voxels: np.ndarray, *how: Callable[[Any], None], **fields: Any) -> None:
    """The same with other fields, and then by pydicom: `how` is told the data set."""
    import pydicom

    enhanced(path, voxels)
    data = pydicom.dcmread(path)
    for name, value in fields.items():
        setattr(data, name, value)
    for one in how:
        one(data)
    data.save_as(path)


def region(delta: float, down: int = 3) -> Any:
    """An ultrasound region of a whole picture, with pixels of `delta` cm; `down`: the code of another unit."""
    import pydicom

    made = pydicom.Dataset()
    made.RegionLocationMinX0 = made.RegionLocationMinY0 = 0
    made.RegionLocationMaxX1 = made.RegionLocationMaxY1 = 95
    made.PhysicalUnitsXDirection, made.PhysicalUnitsYDirection = 3, down
    made.PhysicalDeltaX = made.PhysicalDeltaY = delta
    return made


def ybr_of(grey: np.ndarray) -> np.ndarray:
    return np.stack([grey, np.full_like(grey, 128), np.full_like(grey, 128)], -1)


def coloured(path: Path, pixels: np.ndarray, space: str = "YBR_FULL", planes: int = 0, rle: bool = False) -> None:
    """Grey in a colour space, pixel by pixel or plane by plane. By RLE, pydicom packs planes as if they were pixels."""
    import pydicom

    def pack(data: Any) -> None:
        if rle:
            data.compress(pydicom.uid.RLELossless, generate_instance_uid=False)

    data = (np.moveaxis(pixels, -1, 1) if planes else pixels).tobytes()
    how = {"SamplesPerPixel": 3, "PhotometricInterpretation": space, "PlanarConfiguration": planes, "PixelData": data}
    changed(path, pixels[..., 0], pack, **how)


def halved(path: Path, voxels: np.ndarray) -> None:
    """YBR_FULL_422: two pixels share their colours."""
    pairs = voxels.reshape(*voxels.shape[:2], -1, 2)
    pixels = np.concatenate([pairs, np.full_like(pairs, 128)], -1)
    how = {"SamplesPerPixel": 3, "PhotometricInterpretation": "YBR_FULL_422", "PlanarConfiguration": 0}
    changed(path, voxels, **how, PixelData=pixels.tobytes())


def palette(path: Path, voxels: np.ndarray) -> None:
    """A pixel is the number of a colour, all of which are grey, the brightest first."""

    def add(data: Any) -> None:
        for n in (1, 2, 3):
            data.add_new((0x28, 0x1100 + n), "US", [256, 0, 16])
            data.add_new((0x28, 0x1200 + n), "OW", (np.arange(256, dtype="<u2") * 257)[::-1].tobytes())

    changed(path, voxels, add, PhotometricInterpretation="PALETTE COLOR", PixelData=(255 - voxels).tobytes())


def stored(path: Path, voxels: np.ndarray, above: int = 0) -> None:
    """12 of 16 bits; old files keep an overlay in the bits above."""
    words = voxels.astype("<u2") * 16 | (above << 12) * (np.indices(voxels.shape)[1] % 2).astype("<u2")
    how = {"BitsAllocated": 16, "BitsStored": 12, "HighBit": 11}
    changed(path, voxels, **how, PixelData=words.astype("<u2").tobytes())


def transferred(path: Path, voxels: np.ndarray, syntax: str) -> None:
    """In another transfer syntax: its name in pydicom."""
    import pydicom

    def set_to(data: Any) -> None:
        data.file_meta.TransferSyntaxUID = getattr(pydicom.uid, syntax)

    changed(path, voxels, set_to)


def packed_by(path: Path, voxels: np.ndarray, by: str) -> None:
    """Without loss by GDCM, which SimpleITK writes with."""
    import pydicom

    writer = sitk.ImageFileWriter()
    writer.SetFileName(str(path))
    writer.UseCompressionOn()
    writer.SetCompressor(by)
    writer.Execute(sitk.GetImageFromArray(voxels))
    made = pydicom.dcmread(path)

    def take(data: Any) -> None:
        data.file_meta.TransferSyntaxUID = made.file_meta.TransferSyntaxUID
        data["PixelData"] = made["PixelData"]

    changed(path, voxels, take)


def lossy(path: Path, voxels: np.ndarray) -> None:
    """JPEG, as machines send it: what was not scanned is no longer 0 all over."""
    import pydicom

    def pack(data: Any) -> None:
        frames = []
        for plane in voxels:
            with io.BytesIO() as file:
                Image.fromarray(plane).save(file, "JPEG", quality=95)
                frames.append(file.getvalue())
        data.file_meta.TransferSyntaxUID = pydicom.uid.JPEGBaseline8Bit
        data.PixelData = pydicom.encaps.encapsulate(frames)
        data["PixelData"].is_undefined_length = True

    changed(path, voxels, pack)


def series(path: Path, voxels: np.ndarray, of_class: str) -> None:
    """A picture a file, with its place."""
    import pydicom

    path.mkdir()
    enhanced(path / "all.dcm", voxels, of_class=of_class)
    data = pydicom.dcmread(path / "all.dcm")
    (path / "all.dcm").unlink()
    for name in ("NumberOfFrames", "SharedFunctionalGroupsSequence", "PerFrameFunctionalGroupsSequence"):
        delattr(data, name)
    data.PixelSpacing, data.SliceThickness, data.ImageOrientationPatient = [1.25, 1.25], 2.5, [1, 0, 0, 0, 1, 0]
    for z, plane in enumerate(voxels):
        data.SOPInstanceUID = data.file_meta.MediaStorageSOPInstanceUID = pydicom.uid.generate_uid()
        data.ImagePositionPatient, data.InstanceNumber, data.PixelData = [-10, -20, 30 + 2.5 * z], z, plane.tobytes()
        data.save_as(path / f"{z:03d}.dcm")


def without_places(path: Path, voxels: np.ndarray) -> None:
    """A Secondary Capture of many frames, which says at its top how far apart all is."""

    def drop(data: Any) -> None:
        del data.SharedFunctionalGroupsSequence, data.PerFrameFunctionalGroupsSequence

    changed(path, voxels, drop, PixelSpacing=[1.25, 1.25], SpacingBetweenSlices=2.5,
            SOPClassUID="1.2.840.10008.5.1.4.1.1.7.2")  # fmt: skip


def with_flow(path: Path, voxels: np.ndarray) -> None:
    """Each plane twice: tissue, and what flows there."""
    import pydicom

    enhanced(path, voxels, times=2)
    data = pydicom.dcmread(path)
    for number, frame in enumerate(data.PerFrameFunctionalGroupsSequence):
        kind = pydicom.Dataset()
        kind.DataType = "TISSUE_INTENSITY" if number < 48 else "FLOW_VELOCITY"
        frame.ImageDataTypeSequence = [kind]
        frame.FrameContentSequence[0].TemporalPositionIndex = 1
    data.PixelData = voxels.tobytes() + np.full_like(voxels, 128).tobytes()
    data.save_as(path)


def by_offset(path: Path, times: Sequence[np.ndarray], dice: np.random.Generator) -> None:
    """Volumes whose frames lie in any order and say their time in seconds alone, as the standard wants it of Enhanced
    US Volumes."""
    import pydicom

    enhanced(path, times[0], times=len(times))
    data = pydicom.dcmread(path)
    frames = data.PerFrameFunctionalGroupsSequence
    for number, frame in enumerate(frames):
        offset = pydicom.Dataset()
        offset.TemporalPositionTimeOffset = round(9.96 + 0.04 * (number // 48), 2)
        frame.TemporalPositionSequence = [offset]
        del frame.FrameContentSequence[0].TemporalPositionIndex
    order = dice.permutation(len(frames))
    data.PerFrameFunctionalGroupsSequence = [frames[number] for number in order]
    data.PixelData = np.concatenate(times)[order].tobytes()
    data.save_as(path)


def last_turned(path: Path, voxels: np.ndarray) -> None:
    """A picture of another direction behind those of a volume."""
    import pydicom

    def turn(data: Any) -> None:
        across = pydicom.Dataset()
        across.ImageOrientationVolume = [0, 1, 0, 0, 0, 1]
        data.PerFrameFunctionalGroupsSequence[-1].PlaneOrientationVolumeSequence = [across]

    changed(path, voxels, turn)


def last_at(path: Path, voxels: np.ndarray, place: Sequence[float]) -> None:
    """Its last slice lies elsewhere."""

    def move(data: Any) -> None:
        data.PerFrameFunctionalGroupsSequence[-1].PlanePositionVolumeSequence[0].ImagePositionVolume = list(place)

    changed(path, voxels, move)


def far_probe(path: Path, voxels: np.ndarray) -> None:
    """Its slices run towards the probe, and it says where the apex of the fan is."""
    changed(path, voxels[::-1], UltrasoundAcquisitionGeometry="APEX", ApexPosition=[59.0, 59.0, 180.0])


def by_table(path: Path, voxels: np.ndarray, entries: int = 256) -> None:
    """Its pixels stand for values of a table, which turns them round."""
    import pydicom

    item = pydicom.Dataset()
    item.LUTDescriptor, item.ModalityLUTType = [256, 0, 12], "US"
    item.add_new(0x00283006, "OW", np.arange(256, dtype="<u2")[::-1][:entries].tobytes())
    changed(path, 255 - voxels, ModalityLUTSequence=[item])
