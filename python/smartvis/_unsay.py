# SPDX-License-Identifier: MIT
"""Takes out of a file that ITK wrote what its source did not say: ITK writes 1 mm, and the patient's axes, for whatever
it knows nothing of."""

from __future__ import annotations

import gzip
import re
import struct
from pathlib import Path

_ALIGNED = 2  # a NIfTI code: axes of some other file. 0 would lose where the volume lies


def unsay(path: Path, spacing: bool, place: bool) -> None:
    """Of a NRRD, MetaImage or NIfTI: the `spacing`, how it lies in the patient (`place`), or both. Where its voxels lie
    stays, unless their distance is not known."""
    name, data = path.name.lower(), path.read_bytes()
    if name.endswith((".nii", ".nii.gz")):
        packed = name.endswith(".gz")
        nifti = _of_nifti(bytearray(gzip.decompress(data) if packed else data), spacing, place)
        data = gzip.compress(nifti, mtime=0) if packed else nifti
    elif name.endswith((".nrrd", ".nhdr")):
        head, blank, voxels = data.partition(b"\n\n")
        head = re.sub(rb"\nspace: [^\n]*", b"\nspace: 3D-right-handed", head) if place else head
        head = re.sub(rb"\nspace(?: directions| origin)?: [^\n]*", b"", head) if spacing else head
        data = head + blank + voxels
    elif name.endswith((".mha", ".mhd")):
        head, last, voxels = data.partition(b"\nElementDataFile")
        head = re.sub(rb"\nAnatomicalOrientation = [^\n]*", b"\nAnatomicalOrientation = ???", head) if place else head
        head = re.sub(rb"\nElementSpacing = [^\n]*", b"", head) if spacing else head
        data = head + last + voxels
    path.write_bytes(data)


def _of_nifti(nifti: bytearray, spacing: bool, place: bool) -> bytes:
    if place:
        nifti[252:256] = struct.pack("<hh", _ALIGNED, _ALIGNED)  # qform_code, sform_code
    if spacing:
        nifti[123:124] = bytes(1)  # xyzt_units
        nifti[252:256] = bytes(4)
    return bytes(nifti)
