# SPDX-License-Identifier: MIT
"""What a frame came to, and how to use it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from enum import Enum
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from . import _images
from ._picture import Picture, render
from ._view import Camera

_Volume = TypeVar("_Volume")  # an array of any type, or an image


class Outcome(Enum):
    """What a frame came to; values are those of smartvis_plugin.h."""

    OK = 0  #: every pixel has a surface
    NO_SURFACE = 1  #: too little fluid, or nothing in the way: nothing is clipped
    PARTIAL = 2  #: some pixels have no surface; they clip nothing


@dataclass
class Statistics:
    """Counts of one frame, and what only some methods know (else None)."""

    rays: int = 0
    points: int = 0  #: rays that the surface rests on; 0 if the method does not count them
    unfilled: int = 0  #: pixels without a surface
    fluid_threshold: float | None = None  #: 0 .. 1, methods with a confidence
    open_rays: int | None = None  #: rays with fluid behind tissue, methods with a confidence
    bone_threshold: float | None = None  #: 0 .. 1, methods that start from points
    volume_max: float | None = None  #: 0 .. 1, methods that start from points
    passes: int | None = None  #: of the reconstruction, methods that start from points


def smallest(values: NDArray[Any]) -> Any:
    """The smallest of an array's finite values; 0 if it has none."""
    finite = values[np.isfinite(values)] if values.dtype.kind == "f" else values
    return finite.min() if finite.size else values.dtype.type(0)


@dataclass(repr=False)
class Result:
    """The clipping depthmap of one volume.

    Maps are arrays [y, x] as the camera sees the volume, on the grid that the plugin got: `camera` says how both lie.
    """

    depth: NDArray[np.float32]  #: slices along the view; 0 or less clips nothing
    status: NDArray[np.uint8]  #: 0 no point, 1 the surface rests on this ray, 2 it says "clip nothing"
    confidence: NDArray[np.float32] | None  #: 0 .. 1, None if the method has none
    outcome: Outcome
    statistics: Statistics
    camera: Camera = field(repr=False)  #: how map and volume lie to one another
    spacing_known: bool = True  #: False: no spacing was given, and millimetres are voxels
    source: Any = None  #: the volume that was clipped: the caller's own, not a copy
    window: tuple[float, float] | None = None  #: of its values, as given to `clip`
    why: str = ""  #: why nothing is clipped, or a doubtful surface, in words for who holds the probe
    try_this: dict[str, str] = field(default_factory=dict)  #: the setting that takes the doubtful surface all the same
    doubt: str = ""  #: what is not plausible about the volume's size, or not known
    beams: str = ""  #: how they ran, from where, and how sure that is; "" if the probe's axes were given

    def __repr__(self) -> str:
        slices, height, width = self.camera.shape
        cut = self.depth > 0
        mean = f", {self.depth_mm[cut].mean():.1f} {'mm' if self.spacing_known else 'voxels'} deep" if cut.any() else ""
        what = f"{width} x {height} rays of {slices} slices, {100 * cut.mean():.0f} % clipped{mean}"
        doubt = self.doubt if self.spacing_known and self.doubt != self.why else ""
        return f"<Result {self.outcome.name}: {'; '.join(filter(None, (what, self.why, doubt)))}>"

    @property
    def clips(self) -> bool:
        """True if the map may be used: it clips something."""
        return self.outcome is not Outcome.NO_SURFACE

    @property
    def depth_mm(self) -> NDArray[np.float32]:
        """The depth in millimetres from the middle of the first slice; in voxels if no spacing is known."""
        return (self.depth.astype(np.float64) * self.camera.spacing[2]).astype(np.float32)

    def copy(self) -> Result:
        """A result that owns its maps: a Clipper overwrites its own with the next volume."""
        maps = {name: getattr(self, name) for name in ("depth", "status", "confidence")}
        own: dict[str, Any] = {name: None if of is None else of.copy() for name, of in maps.items()}
        return replace(self, **own, statistics=replace(self.statistics))

    def mask(self) -> NDArray[np.bool_]:
        """True where a voxel of the volume is kept, in the volume's own shape."""
        if not self.clips:
            return np.ones(self.camera.source_shape, bool)
        return self.camera.behind(self.depth)

    def apply(self, volume: _Volume, fill: float | None = None) -> _Volume:
        """The clipped volume: a copy in which what hides the fetus holds `fill`. None: 0 in uint8, in other types the
        volume's smallest value, so that black stays black.

        `volume` is an array of the shape that was clipped, of any type, or a SimpleITK image of that size; an
        image comes back as an image with its spacing, origin and directions.
        """
        if _images.is_image(volume):
            clipped: _Volume = _images.like(volume, self._apply(_images.array(volume), fill))
            return clipped
        return self._apply(np.asarray(volume), fill)  # type: ignore[return-value]

    def _apply(self, volume: NDArray[Any], fill: float | None) -> NDArray[Any]:
        if volume.shape != self.camera.source_shape:
            raise ValueError(f"volume has shape {volume.shape}, what was clipped had {self.camera.source_shape}")
        if fill is None:
            fill = 0 if volume.dtype == np.uint8 else smallest(volume)
        elif volume.dtype.kind in "ui":
            least, most = np.iinfo(volume.dtype).min, np.iinfo(volume.dtype).max
            if not (least <= fill <= most and fill == int(fill)):
                raise ValueError(f"fill={fill}, expected a value of {volume.dtype}")
        return np.where(self.mask(), volume, volume.dtype.type(fill))

    def picture(self, volume: Any = None, kind: str = "panel", size: int = 512) -> Picture:
        """A picture by the host's renderer, as PNG, seen along the rays of the surface. `volume`: what to draw, of the
        shape that was clipped; None: that volume. `kind`: "panel" (full volume and result), "slices", "result", "full"
        or "depthmap"; `size`: pixels of a square in it.

        HostError: host_sim is not there, or cannot draw it. `quick_look` needs no host.
        """
        depth = self.depth if self.clips else np.zeros_like(self.depth)
        return render(self.camera, depth, self.source if volume is None else volume, kind, size, self.window)

    def show(self, volume: Any = None, kind: str = "panel", size: int = 512) -> None:
        """Opens `picture`."""
        self.picture(volume, kind, size).show()

    def _repr_html_(self) -> str:
        """For a notebook: the picture, how deep, why, and what is doubted."""
        from ._products import figure_of

        return figure_of(self)

    def save(self, path: str | Path) -> list[Path]:
        """Writes the result by the name's suffix: .png the picture of `quick_look`, .npz the maps, .ply the mesh of
        what is left, and of .nrrd, .mha, .nii.gz and others the clipped volume. Without one it is a folder for all that
        `smartvis clip` writes. The files' names."""
        from ._products import save

        return save(self, Path(path))

    def surface(self) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """The clipping surface as triangles: vertices in mm and faces, whose front looks at the camera; those of
        host_sim's surface.ply.

        A vertex is a pixel that clips in the volume; cells that are steps have no faces. Of a SimpleITK image they lie
        in its world; of an array along x, y, z from the centre of voxel (0, 0, 0). Both are empty if nothing is
        clipped.
        """
        if not self.clips:
            return np.empty((0, 3)), np.empty((0, 3), np.int64)
        if not _images.is_image(self.source):
            return self.camera.surface(self.depth)
        return self.camera.surface(self.depth, self.source.GetDirection(), self.source.GetOrigin())
