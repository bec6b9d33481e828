# SPDX-License-Identifier: MIT
"""What both sides know: what is to be read, and how what was read is judged."""

from __future__ import annotations

import itertools
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

RAS = np.diag([-1.0, -1.0, 1.0, 1.0])  # from the patient's left, back and head to right, front and head, and back
SUFFIXES = (".nrrd", ".mha", ".nii.gz")
NEAR_MM = 0.01  # NIfTI keeps places in single precision


@dataclass
class Truth:
    """Arrays [z, y, x], of a sequence [t, z, y, x]; places are from (x, y, z) of a voxel to mm, LPS."""

    scan: np.ndarray
    clipped: np.ndarray  #: of both volumes
    depth: np.ndarray
    mask: np.ndarray
    places: np.ndarray  #: of the scan, and of its depthmap
    vertices: np.ndarray
    faces: np.ndarray

    def save(self, folder: Path) -> None:
        """For processes of other environments."""
        np.savez(folder / "truth.npz", **asdict(self))

    @classmethod
    def load(cls, folder: Path) -> Truth:
        """What was saved there."""
        with np.load(folder / "truth.npz") as made:
            return cls(**dict(made))


def parts_of(place: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Origin, spacing and the columns of direction."""
    spacing = np.linalg.norm(place[:3, :3], axis=0)
    return place[:3, 3], spacing, place[:3, :3] / spacing


def far(expected: np.ndarray, place: np.ndarray, shape: tuple[int, ...]) -> float:
    """mm from where a voxel lies, of two at the corners and one amid."""
    last = np.array(shape[::-1], float) - 1
    voxels = np.stack([0 * last, np.floor(last * (0.1, 0.3, 0.7)), last]).T
    apart = (place - expected) @ np.concatenate([voxels, np.ones((1, 3))])
    return float(np.linalg.norm(apart[:3], axis=0).max())


def judged(values: np.ndarray, place: np.ndarray, came: np.ndarray, at: np.ndarray | None) -> str:
    """Of what is to be read, and what was. Who stores an axis the other way round, and says so, is right."""
    if came.shape != values.shape:
        return f"{' x '.join(map(str, came.shape[::-1]))} values"
    for steps in itertools.product((1, -1), repeat=3):
        if np.array_equal(came[tuple(slice(None, None, step) for step in steps)], values):
            break
    else:
        return "other values"
    if at is None:
        return "values, no place"
    turn = np.diag([*steps[::-1], 1.0])
    turn[:3, 3] = [(n - 1) * (step < 0) for n, step in zip(values.shape[::-1], steps[::-1], strict=True)]
    apart = far(place, at @ turn, values.shape)
    return "right" if apart < NEAR_MM else f"values, {apart:.0f} mm off"


def judged_mesh(truth: Truth, vertices: np.ndarray, faces: np.ndarray) -> str:
    """The corners' places, and which side of a face is the front: the volume inside is above 0."""
    if vertices.shape != truth.vertices.shape or len(faces) != truth.faces:
        return "another mesh"
    apart = float(np.abs(vertices - truth.vertices).max())
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    outwards = np.einsum("ij,ij->", a, np.cross(b, c)) > 0
    return ("right" if apart < NEAR_MM else f"{apart:.0f} mm off") + ("" if outwards else ", faces inwards")
