# SPDX-License-Identifier: MIT
"""DICOM as users have it, of one scan: kinds, colour spaces, transfer syntaxes."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np


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


def coloured(path: Path, voxels: np.ndarray, planes: int) -> None:
    """Grey in YBR_FULL by RLE, of pixels or of planes: pydicom packs these as if they were pixels."""
    import pydicom

    enhanced(path, voxels)
    data = pydicom.dcmread(path)
    ybr = np.stack([voxels, np.full_like(voxels, 128), np.full_like(voxels, 128)], -1)
    data.SamplesPerPixel, data.PhotometricInterpretation, data.PlanarConfiguration = 3, "YBR_FULL", planes
    data.PixelData = (np.moveaxis(ybr, -1, 1) if planes else ybr).tobytes()
    data.compress(pydicom.uid.RLELossless, generate_instance_uid=False)
    data.save_as(path)


def by_table(path: Path, voxels: np.ndarray, entries: int = 256) -> None:
    """Its pixels stand for values of a table, which turns them round."""
    import pydicom

    enhanced(path, 255 - voxels)
    data, item = pydicom.dcmread(path), pydicom.Dataset()
    item.LUTDescriptor, item.ModalityLUTType = [256, 0, 12], "US"
    item.add_new(0x00283006, "OW", np.arange(256, dtype="<u2")[::-1][:entries].tobytes())
    data.ModalityLUTSequence = [item]
    data.save_as(path)
