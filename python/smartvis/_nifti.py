# SPDX-License-Identifier: MIT
"""What a NIfTI's own header says, of which SimpleITK hands on one half."""

from __future__ import annotations

import math
import struct
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _content

_BYTES = 348
FIRST = 352  # byte of a voxel at the least, in a file that holds header and voxels
_LABELS = 1002  # NIFTI_INTENT_LABEL
_TURNED = 0.1  # degrees, and ...
_APART = 0.1  # ... mm, that are worth a word


@dataclass
class Header:
    """Places map indices to mm: right, front, head, in which NIfTI counts."""

    apart: tuple[float, ...]  #: mm along the axes
    qform: NDArray[np.float64] | None  #: [3, 4]; None: its code is 0
    sform: NDArray[np.float64] | None
    is_labels: bool  #: its values are labels, not a picture's
    begins: float  #: byte of the first voxel, of a file that holds both; else 352


def header(path: Path) -> Header | None:
    """None: there is none that can be read, which its reader says better."""
    try:
        beside = path.name.lower().endswith((".img", ".img.gz"))
        head = _content.unpacked(Path(str(path).replace(".img", ".hdr")) if beside else path, _BYTES)
        order = "<" if head[:2] > head[2:4] else ">"
        (intent,) = struct.unpack_from(f"{order}h", head, 68)
        sizes = struct.unpack_from(f"{order}8f", head, 76)
        (begins,) = struct.unpack_from(f"{order}f", head, 108)
        codes = struct.unpack_from(f"{order}2h", head, 252)
        turn = struct.unpack_from(f"{order}6f", head, 256)
        rows = np.array(struct.unpack_from(f"{order}12f", head, 280)).reshape(3, 4)
    except (OSError, EOFError, struct.error, zlib.error):
        return None
    qform = _of_quaternion(turn[:3], turn[3:], sizes) if codes[0] > 0 else None
    sform = rows if codes[1] > 0 else None
    return Header(sizes[1:4], qform, sform, intent == _LABELS, begins if head[344:347] == b"n+1" else FIRST)


def lacks_lengths(head: Header) -> bool:
    """Whether a distance is 0 or no number, for which ITK says 1 mm."""
    return any(length == 0 or not math.isfinite(length) for length in head.apart)


def two_places(head: Header, image: Any) -> str:
    """That its two ways to say where voxels lie disagree, by how much, and which the image has; "" if they agree."""
    if head.qform is None or head.sform is None or not np.isfinite([head.qform, head.sform]).all():
        return ""
    q, s = (_directions(place) for place in (head.qform, head.sform))
    mirrored = np.linalg.det(q) * np.linalg.det(s) < 0
    angle = math.degrees(math.acos(min(1.0, max(-1.0, (np.trace(q.T @ s) - 1) / 2))))
    far = float(np.linalg.norm(head.qform[:, 3] - head.sform[:, 3]))
    if not mirrored and angle < _TURNED and far < _APART:
        return ""
    here = np.diag([-1, -1, 1]) @ np.reshape(image.GetDirection(), (-1, 3))[:3]
    is_q = np.abs(here - q).max() < np.abs(here - s).max() or (angle < _TURNED and _starts_at(head.qform, image))
    counts = "qform counts, as in ITK and 3D Slicer; nibabel, and what stands on it, takes the sform"
    how = f"by {angle:.3g} degrees and {far:.3g} mm at the first voxel"
    return (
        f"Its qform and its sform disagree, {'one is the mirror image of the other' if mirrored else how}: the "
        f"{counts if is_q else 'sform counts, as in ITK, 3D Slicer and nibabel'}."
    )


def _starts_at(place: NDArray[np.float64], image: Any) -> bool:
    x, y, z = image.GetOrigin()[:3]
    return bool(np.allclose(place[:, 3], (-x, -y, z), atol=_APART / 2))


def _of_quaternion(bcd: tuple[float, ...], offset: tuple[float, ...], sizes: tuple[float, ...]) -> Any:
    b, c, d = bcd
    a = math.sqrt(max(0.0, 1.0 - (b * b + c * c + d * d)))
    turn = np.array(
        [
            [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
            [2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)],
            [2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c],
        ]
    )
    scale = np.array([sizes[1], sizes[2], sizes[3] * (-1 if sizes[0] < 0 else 1)])
    return np.column_stack([turn * scale, offset])


def _directions(place: NDArray[np.float64]) -> NDArray[np.float64]:
    lengths = np.linalg.norm(place[:, :3], axis=0)
    return place[:, :3] / np.where(lengths > 0, lengths, 1)
