# SPDX-License-Identifier: MIT
"""What an Enhanced US Volume says of its probe (DICOM PS3.3 C.8.24.2): where its lines met, and where its face was."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

_INSIDE = 0.5  # an apex in the box tells a side if it lies in the outer half of the way to it


class Probe(NamedTuple):
    """What is known of it in a volume's own axes; None: not said."""

    side: str | None
    apex: tuple[float, ...] | None  #: mm from the volume's corner


UNKNOWN = Probe(None, None)


@dataclass
class Said:
    """In mm of the volume's frame of reference."""

    apex: NDArray[np.float64] | None
    to_probe: NDArray[np.float64] | None  #: the matrix from there to the transducer's frame of reference

    @classmethod
    def of(cls, data: Any) -> Said:
        """Of a file's header."""
        has_apex = data.get("UltrasoundAcquisitionGeometry") == "APEX"
        apex = _numbers(data.get("ApexPosition") if has_apex else None, 3)
        matrix = _numbers(data.get("VolumeToTransducerMappingMatrix"), 16)
        if matrix is not None and not _is_rigid(matrix.reshape(4, 4)):
            matrix = None
        return cls(apex, None if matrix is None else matrix.reshape(4, 4))

    def seen(
        self,
        first: tuple[NDArray[np.float64], NDArray[np.float64]],
        step: NDArray[np.float64],
        spacing: tuple[float, float, float],
        size: tuple[int, int, int],
    ) -> Probe:
        """In the axes of a volume whose first plane has this place and these directions, and whose others lie along
        `step` from there. The mapping tells the side if it is there; else the apex does."""
        place, across = first
        normal = np.cross(*across)
        axes = np.stack([*across, normal * np.sign(normal @ step)])
        box = np.array(spacing) * size

        def here(point: NDArray[np.float64]) -> NDArray[np.float64]:
            return axes @ (point - place) + np.array(spacing) / 2

        apex = None if self.apex is None else here(self.apex)
        side = None if apex is None else _beyond(apex / box * 2 - 1, box)
        if self.to_probe is not None:
            turn, shift = self.to_probe[:3, :3], self.to_probe[:3, 3]
            side = _facing(axes @ turn[1], here(-turn.T @ shift) / box * 2 - 1)
        return Probe(side, None if apex is None or side is None else tuple(float(part) for part in apex))


def _numbers(value: Any, count: int) -> NDArray[np.float64] | None:
    try:
        numbers = np.array([float(part) for part in value])
    except (TypeError, ValueError):
        return None
    return numbers if len(numbers) == count and np.isfinite(numbers).all() else None


def _is_rigid(matrix: NDArray[np.float64]) -> bool:
    turn = matrix[:3, :3]
    return bool(np.allclose(turn @ turn.T, np.eye(3), atol=1e-3) and np.allclose(matrix[3], (0, 0, 0, 1)))


def _beyond(at: NDArray[np.float64], box: NDArray[np.float64]) -> str | None:
    """The side that a point lies behind, of a box from -1 to 1 along each axis, or that it lies close to."""
    behind = (np.abs(at) - 1) * box
    axis = int(behind.argmax() if behind.max() > 0 else np.abs(at).argmax())
    return _name(axis, at[axis]) if abs(at[axis]) > _INSIDE else None


def _facing(depth: NDArray[np.float64], face: NDArray[np.float64]) -> str:
    """The side at which a transducer's face is whose normal is `depth`, in either sense."""
    axis = int(np.abs(depth).argmax())
    return _name(axis, face[axis] if abs(face[axis]) > _INSIDE else -depth[axis])


def _name(axis: int, at: float) -> str:
    return ("+" if at > 0 else "-") + "xyz"[axis]
