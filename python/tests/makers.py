# SPDX-License-Identifier: MIT
"""Files as users have them, of one scan of 96 x 96 x 48 voxels: MetaImage, NRRD, NIfTI, VTK, pictures."""

import gzip
import shutil
import struct
import zlib
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import SimpleITK as sitk
import tifffile
from conftest import host

Make = Callable[[Path, np.ndarray], None]
SPACING = (1.25, 1.25, 2.5)
MM = "ElementSpacing = 1.25 1.25 2.5"


def written(voxels: np.ndarray, path: Path, spacing: tuple[float, ...] = SPACING) -> None:
    image = sitk.GetImageFromArray(voxels)
    image.SetSpacing(spacing)
    sitk.WriteImage(image, str(path))


def meta(
    path: Path, voxels: np.ndarray, *lines: str, kind: str = "MET_UCHAR", frames: int = 1, data: str = "LOCAL"
) -> None:
    many = f" {frames}" if frames > 1 else ""
    head = [f"NDims = {3 + (frames > 1)}", f"DimSize = 96 96 48{many}", *lines, f"ElementType = {kind}"]
    path.write_bytes("\n".join([*head, f"ElementDataFile = {data}", ""]).encode() + voxels.tobytes() * frames)


def nrrd(path: Path, voxels: np.ndarray, *lines: str, sizes: str = "96 96 48", by: str = "raw") -> None:
    head = ["NRRD0005", "type: uchar", f"dimension: {len(sizes.split())}", f"sizes: {sizes}", f"encoding: {by}", *lines]
    path.write_bytes("\n".join([*head, "", ""]).encode() + voxels.tobytes())


def odd_apart(path: Path, voxels: np.ndarray, length: float) -> None:
    """A NIfTI whose distances are 0 or no number, for which ITK says 1 mm."""
    written(voxels, path)
    data = bytearray(path.read_bytes())
    data[80:92], data[252:256] = 3 * struct.pack("<f", length), bytes(4)
    path.write_bytes(data)


def labelled(path: Path, voxels: np.ndarray) -> None:
    """A NIfTI whose intent is that of labels."""
    written(voxels, path)
    data = bytearray(path.read_bytes())
    data[68:70] = struct.pack("<h", 1002)
    path.write_bytes(data)


def longer(path: Path, voxels: np.ndarray) -> None:
    """Two planes more than the header says."""
    image = sitk.GetImageFromArray(voxels)
    image.SetSpacing(SPACING)
    packed = path.name.startswith("packed_") or path.suffix == ".gz"
    sitk.WriteImage(image, str(path), useCompression=packed)
    data, more = path.read_bytes(), voxels[:2].tobytes()
    begin = data.index(b"\x1f\x8b") if packed else len(data)
    inside = gzip.compress(gzip.decompress(data[begin:]) + more) if packed else more
    path.write_bytes(data[:begin] + inside)


def block(path: Path, voxels: np.ndarray) -> None:
    """A NRRD whose values are no numbers."""
    nrrd(path, voxels, "block size: 1")
    path.write_bytes(path.read_bytes().replace(b"uchar", b"block"))


def deflated(path: Path, voxels: np.ndarray) -> None:
    """A compressed MetaImage that does not say of how many bytes."""
    meta(path, voxels[:0], MM, "CompressedData = True")
    path.write_bytes(path.read_bytes() + zlib.compress(voxels.tobytes()))


def within(path: Path, voxels: np.ndarray) -> None:
    """A NIfTI whose voxels begin with its header."""
    written(voxels, path)
    data = bytearray(path.read_bytes())
    data[108:112] = bytes(4)
    path.write_bytes(data)


def packed(path: Path, voxels: np.ndarray) -> None:
    path.write_bytes(gzip.compress(voxels.tobytes()))


def pictures_in(path: Path, voxels: np.ndarray) -> None:
    path.mkdir()
    for number, plane in enumerate(voxels[:3]):
        sitk.WriteImage(sitk.GetImageFromArray(plane), str(path / f"{number}.png"))


def vtk(path: Path, voxels: np.ndarray, of: str, more: int) -> None:
    """Legacy VTK as text: values of points, or of cells, of which each row has one less."""
    z, y, x = voxels.shape
    head = f"# vtk DataFile Version 3.0\nscan\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS {x + more} {y + more} "
    head += f"{z + more}\nSPACING 1.25 1.25 2.5\nORIGIN 0 0 0\n{of} {voxels.size}\nSCALARS v unsigned_char 1\n"
    rows = "\n".join(" ".join(map(str, row)) for row in voxels.reshape(-1, x))
    path.write_text(f"{head}LOOKUP_TABLE default\n{rows}\n")


def reworded(path: Path, voxels: np.ndarray, word: str, other: str) -> None:
    """Legacy VTK of points with another word."""
    vtk(path, voxels, "POINT_DATA", 0)
    path.write_text(path.read_text().replace(word, other))


def of_two_sizes(path: Path, voxels: np.ndarray) -> None:
    """A TIFF whose volume is followed by one of half the size."""
    with tifffile.TiffWriter(path) as file:
        for part in (voxels, voxels[:, ::2, ::2]):
            file.write(part, photometric="minisblack")


def in_members(path: Path, voxels: np.ndarray) -> None:
    """A NIfTI in gzip in three pieces, as pigz and bgzip write it."""
    written(voxels, path)
    data = gzip.decompress(path.read_bytes())
    third = len(data) // 3
    pieces = (data[:third], data[third : 2 * third], data[2 * third :])
    path.write_bytes(b"".join(map(gzip.compress, pieces)))


def named(suffix: str, head: bytes = b"", pack: bool = False) -> Make:
    """What is written as `suffix` under another name, or other bytes."""

    def make(path: Path, voxels: np.ndarray) -> None:
        written(voxels, path.parent / f"as{suffix}")
        data = head or (path.parent / f"as{suffix}").read_bytes()
        path.write_bytes(gzip.compress(data) if pack else data)

    return make


def nifti(size: int, mark: bytes, at: int) -> bytes:
    head = bytearray(600)
    head[:4], head[at : at + len(mark)] = struct.pack("<i", size), mark
    return bytes(head)


def in_db(voxels: np.ndarray, outside: float) -> np.ndarray:
    return np.where(voxels > 0, voxels / 4.0 - 60.0, outside).astype("<f4")


def placed(path: Path, voxels: np.ndarray, directions: Sequence[float] | np.ndarray) -> None:
    """In the patient, with axes as given."""
    image = sitk.GetImageFromArray(voxels)
    image.SetSpacing(SPACING)
    image.SetOrigin((10, -20, 30))
    image.SetDirection(directions)
    sitk.WriteImage(image, str(path))


def two_places(path: Path, voxels: np.ndarray) -> None:
    """A NIfTI whose sform is turned by 30 degrees against its qform."""
    placed(path, voxels, np.diag([-1.0, -1.0, 1.0]).ravel())
    data = bytearray(path.read_bytes())
    rows = np.array([[0.75**0.5, -0.5, 0, 10], [0.5, 0.75**0.5, 0, -20], [0, 0, 1, 30]]) * (*SPACING, 1)
    data[252:256], data[280:328] = struct.pack("<2h", 1, 2), rows.astype("<f4").tobytes()
    path.write_bytes(data)


def mirrored(path: Path, voxels: np.ndarray) -> None:
    """A NIfTI whose sform has x the other way round than its qform."""
    placed(path, voxels, np.diag([-1.0, -1.0, 1.0]).ravel())
    data = bytearray(path.read_bytes())
    rows = np.array([[-1.0, 0, 0, 10], [0, 1, 0, -20], [0, 0, 1, 30]]) * (*SPACING, 1)
    data[252:256], data[280:328] = struct.pack("<2h", 1, 2), rows.astype("<f4").tobytes()
    path.write_bytes(data)


def big_endian(path: Path, voxels: np.ndarray) -> None:
    """A NIfTI of 16 bits, as a machine with the other byte order writes it."""
    head = bytearray(352)
    struct.pack_into(">i", head, 0, 348)
    struct.pack_into(">8h", head, 40, 3, *voxels.shape[::-1], 1, 1, 1, 1)
    struct.pack_into(">2h", head, 70, 4, 16)
    struct.pack_into(">8f", head, 76, 1, *SPACING, 0, 0, 0, 0)
    struct.pack_into(">3f", head, 108, 352, 1, 0)
    head[123], head[344:348] = 2, b"n+1\0"
    path.write_bytes(head + voxels.astype(">i2").tobytes())


def beat(path: Path, voxels: np.ndarray) -> None:
    """Two volumes in a file beside the header."""
    meta(path, voxels[:0], f"{MM} 1", frames=2)
    data = path.with_suffix(".raw")
    path.write_bytes(path.read_bytes().replace(b"LOCAL", data.name.encode()))
    data.write_bytes(voxels.tobytes() + voxels[:, ::-1].tobytes())


def fan(path: Path, _: np.ndarray) -> None:
    """A Kretz volume."""
    host("scenes", "D01", "--size", 96, "--export", "--format", "vol", "--out", path.with_suffix(""))
    shutil.move(path.with_suffix("") / "D01_full.vol", path)
    shutil.rmtree(path.with_suffix(""))


def along_y(voxels: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(voxels.transpose(1, 0, 2)[:, ::-1])


def deep(path: Path, voxels: np.ndarray) -> None:
    """The depth runs along y, reversed: the probe is at +y."""
    written(along_y(voxels), path, (1.25, 2.5, 1.25))
