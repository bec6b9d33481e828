# SPDX-License-Identifier: MIT
"""Pictures of a result, drawn by the host's renderer."""

from __future__ import annotations

import struct
import sys
import tempfile
import webbrowser
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _host, _images, _metaimage
from ._errors import HostError
from ._view import Camera, on_square
from ._volume import to_uint8

KINDS = ("panel", "slices", "result", "full", "depthmap")


def png_of(rgb: NDArray[np.uint8]) -> bytes:
    """A picture [y, x, rgb] as PNG."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    height, width, _ = rgb.shape
    rows = np.pad(rgb.reshape(height, -1), ((0, 0), (1, 0)))  # a row begins with its filter: none
    head = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + head + chunk(b"IDAT", zlib.compress(rows.tobytes())) + chunk(b"IEND", b"")


class Picture:
    """A picture as PNG: a notebook shows it, `save` writes it."""

    def __init__(self, png: bytes) -> None:
        self.png = png

    def _repr_png_(self) -> bytes:
        return self.png

    def __repr__(self) -> str:
        width, height = struct.unpack(">II", self.png[16:24])
        return f"<Picture of {width} x {height} pixels>"

    def save(self, path: str | Path) -> Path:
        """Writes the PNG file."""
        path = Path(path)
        path.write_bytes(self.png)
        return path

    def show(self) -> None:
        """Opens it: in a notebook below the cell, else in what this machine opens pictures with."""
        ipython = sys.modules.get("IPython")  # a notebook has imported it
        if ipython is not None and hasattr(ipython.get_ipython(), "kernel"):
            ipython.display.display(self)
        else:
            with tempfile.NamedTemporaryFile(suffix=".png", delete=False) as file:
                file.write(self.png)
            if not webbrowser.open(Path(file.name).as_uri()):
                print(f"nothing here opens pictures; it is {file.name}")


def render(
    camera: Camera, depth: NDArray[np.float32], volume: Any, kind: str, size: int, window: tuple[float, float] | None
) -> Picture:
    """The volume with this surface (0: nothing clipped) as `host_sim run` draws it, seen along the camera's rays."""
    if kind not in KINDS:
        raise ValueError(f"kind='{kind}' is none of {', '.join(KINDS)}")
    if volume is None:
        raise ValueError("the result does not know its volume: give it, picture(volume)")
    voxels = to_uint8(_images.array(volume) if _images.is_image(volume) else np.asarray(volume), window)
    if voxels.shape != camera.source_shape:
        raise ValueError(f"volume has shape {voxels.shape}, what was clipped had {camera.source_shape}")
    try:
        _host.find()
    except HostError as error:
        raise HostError(f"{error}; smartvis.quick_look(volume, result) draws without it") from None
    depths = on_square(camera, depth)
    fine = camera.fine()
    with tempfile.TemporaryDirectory() as folder:
        _metaimage.write(Path(folder) / "volume.mha", fine.see(voxels), fine.spacing)
        _metaimage.write(Path(folder) / "surface.mha", depths)
        what = ["--volume", "volume.mha", "--map", "surface.mha", "--lowres", str(len(depths))]
        how = ["--frames", "1", "--setting", "smartvis", "--picture", str(size), "--panel", str(size)]
        few = ["--few-pictures"] if kind in ("result", "full") else []
        _host.run(["run", *what, *how, *few, "--out", "."], folder, picture="size")
        return Picture((Path(folder) / f"{kind}.png").read_bytes())
