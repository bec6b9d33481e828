# SPDX-License-Identifier: MIT
"""SimpleITK images in, SimpleITK images out."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._errors import extra_module


def sitk() -> Any:
    return extra_module("SimpleITK", "SimpleITK", "files")


def pydicom(part: str = "") -> Any:
    return extra_module(f"pydicom{part}", "pydicom", "files", "DICOM")


def is_image(volume: Any) -> bool:
    """True for an image of SimpleITK. ValueError for those of libraries that count [x, y, z], and of ITK itself."""
    name = f"{type(volume).__module__.partition('.')[0]}'s {type(volume).__name__}"
    if hasattr(volume, "affine"):
        raise ValueError(
            f"the volume is {name}, whose axes are x, y, z: give its file's name, or its array as [z, y, x] (.T) with "
            "spacing=(x, y, z)"
        )
    is_one = hasattr(volume, "CopyInformation") and hasattr(volume, "GetSpacing")
    if is_one and not isinstance(volume, sitk().Image):
        raise ValueError(f"the volume is {name}, expected an image of SimpleITK: give its file's name, or its array")
    return is_one


NOT_SAID = "smartvis_spacing_not_said"  #: a key of images whose file does not say its spacing


PROBE = "smartvis_probe_side"  #: of images whose file says at which side the probe was


APEX = "smartvis_apex"  #: of images whose file says where the lines met that scanned it


PLACE = "smartvis_place_not_said"  #: of images whose file does not say how they lie in the patient


FILE_NOTES = "ITK_FileNotes"  #: the one field that ITK hands on from every format to every other
UNPLACED = "SmartVis: not the axes of a patient"  #: what results say there of such images


TOLD = "smartvis_told"  #: what is to be told of an image's file, in sentences


UNIT = "ITK_VoxelUnits"  #: ITK's note of a MetaImage's DistanceUnits, in which spacing and origin stay


KRETZ = "smartvis_kretz"  #: of Cartesian copies: the Kretz file, the volume's number and whether it is mirrored


def parts(image: Any) -> tuple[Any, ...]:
    """What an image consists of, for another process: voxels, spacing, origin, direction, our own notes."""
    notes = {
        key: image.GetMetaData(key) for key in (NOT_SAID, PLACE, PROBE, APEX, TOLD, KRETZ) if image.HasMetaDataKey(key)
    }
    vector = image.GetNumberOfComponentsPerPixel() > 1
    voxels = sitk().GetArrayFromImage(image)
    return voxels, vector, image.GetSpacing(), image.GetOrigin(), image.GetDirection(), notes


def whole(voxels: Any, vector: bool, spacing: Any, origin: Any, direction: Any, notes: dict[str, str]) -> Any:
    """The image of these parts."""
    image = sitk().GetImageFromArray(voxels, isVector=vector)
    image.SetSpacing(spacing)
    image.SetOrigin(origin)
    image.SetDirection(direction)
    for key, value in notes.items():
        image.SetMetaData(key, value)
    return image


class Said(NamedTuple):
    """What an image's file says beside its geometry."""

    side: str | None = None  #: at which the probe was
    apex: tuple[float, ...] | None = None  #: where the lines met, mm from the corner along the volume's axes
    told: str = ""  #: what is to be told of the file


NOTHING_SAID = Said()


def said(image: Any) -> Said:
    """Of an image that a `Source` read; nothing of others."""
    side, apex, told = (image.GetMetaData(key) if image.HasMetaDataKey(key) else "" for key in (PROBE, APEX, TOLD))
    return Said(side or None, tuple(map(float, apex.split())) or None, told)


def kretz(image: Any) -> tuple[str, int, bool] | None:
    """The file and the volume in it that a Cartesian copy was made of, and whether that was mirrored."""
    if not image.HasMetaDataKey(KRETZ):
        return None
    number, mirror, path = image.GetMetaData(KRETZ).split(" ", 2)
    return path, int(number), mirror == "1"


def says_spacing(image: Any) -> bool:
    """False if the file that it was read from does not say how far apart voxels are; it has 1 mm then."""
    return not image.HasMetaDataKey(NOT_SAID)


def check_unit(image: Any) -> None:
    """ValueError: its lengths are not in mm, as SimpleITK's own reader leaves them."""
    unit = image.GetMetaData(UNIT) if image.HasMetaDataKey(UNIT) else "mm"
    if unit not in ("mm", "?"):
        raise ValueError(f"{UNIT} of the image is '{unit}', expected mm: give the name of its file, which is scaled")


class _Voxels:
    """The base of an array that shows an image's memory: it keeps the image alive, which SimpleITK's view does not."""

    def __init__(self, image: Any) -> None:
        self.image = image
        self.__array_interface__ = sitk().GetArrayViewFromImage(image).__array_interface__


def array(image: Any) -> NDArray[Any]:
    """The voxels [z, y, x]: a view into the image, which lives as long."""
    if image.GetDimension() != 3 or image.GetNumberOfComponentsPerPixel() != 1:
        raise ValueError(
            f"the image has {image.GetDimension()} dimensions and {image.GetNumberOfComponentsPerPixel()} values "
            "a voxel, expected 3 and 1"
        )
    return np.asarray(_Voxels(image))


def of(volume: NDArray[Any], spacing: Any) -> Any:
    """An array as an image, at the origin; `spacing` is None if nobody knows it."""
    image = sitk().GetImageFromArray(volume.astype(np.uint8) if volume.dtype == bool else volume)
    if spacing is None:
        image.SetMetaData(NOT_SAID, "1")
    else:
        image.SetSpacing([float(length) for length in spacing])
    return image


def axes(image: Any) -> NDArray[np.float64]:
    """Where x, y and z lead in the image's world, as columns."""
    return np.array(image.GetDirection(), np.float64).reshape(3, 3)


def in_world(image: Any, mm: NDArray[np.float64]) -> NDArray[np.float64]:
    """Places in mm from the centre of voxel (0, 0, 0) along x, y and z, in the image's world."""
    return np.asarray(mm @ axes(image).T + np.array(image.GetOrigin()))


def like(image: Any, voxels: NDArray[Any]) -> Any:
    """`voxels` as an image with the geometry of `image`, known or not."""
    made = sitk().GetImageFromArray(voxels.astype(np.uint8) if voxels.dtype == bool else voxels)
    made.CopyInformation(image)
    return says_no_more(made, image)


def says_no_more(made: Any, image: Any) -> Any:
    """`made` of an image, with what that one does not say."""
    for key in (NOT_SAID, PLACE):
        if image.HasMetaDataKey(key):
            made.SetMetaData(key, image.GetMetaData(key))
    return made
