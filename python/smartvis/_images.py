# SPDX-License-Identifier: MIT
"""SimpleITK images in, SimpleITK images out."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._errors import MissingExtraError


def sitk() -> Any:
    try:
        import SimpleITK
    except ImportError:
        raise MissingExtraError("SimpleITK", "files", "this") from None
    return SimpleITK


def is_image(volume: object) -> bool:
    return hasattr(volume, "CopyInformation") and hasattr(volume, "GetSpacing")


def array(image: Any) -> NDArray[Any]:
    """The voxels [z, y, x]: a view into the image."""
    if image.GetDimension() != 3 or image.GetNumberOfComponentsPerPixel() != 1:
        raise ValueError(
            f"the image has {image.GetDimension()} dimensions and {image.GetNumberOfComponentsPerPixel()} values "
            "a voxel, expected 3 and 1"
        )
    return np.asarray(sitk().GetArrayViewFromImage(image))


def like(image: Any, voxels: NDArray[Any]) -> Any:
    """`voxels` as an image with the geometry of `image`."""
    made = sitk().GetImageFromArray(voxels.astype(np.uint8) if voxels.dtype == bool else voxels)
    made.CopyInformation(image)
    return made
