# SPDX-License-Identifier: MIT
"""Reads volumes with SimpleITK, and writes images, in a process of its own (`_process`): foreign libraries may die."""

from __future__ import annotations

import errno
import glob
import gzip
import math
import os
import re
import zlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _content, _dicom, _geometry, _host, _images, _kretz, _nifti, _pixels
from ._complaints import RIGHT_ANGLES, no_warning, reason, unreadable
from ._errors import DeviceError, FileError, HostError
from ._volume import checked_spacing

_HEADER = 1 << 24  # bytes of a header's text at most, as in the host
_MOST_VOXELS = 1 << 31  # of a volume, as in the host
_KEPT_VOXELS = 1 << 28
_FAR = 1e9  # of any number of a geometry: ITK squares them
_ASKEW = 1e-3  # of directions, as in the host
_PATIENT = re.compile(r"left|right|[LR][AP]S", re.IGNORECASE)  # of a NRRD's spaces


class Reader:
    """The volumes of one file, or of a folder of DICOM. Kretz volumes in it are files of their own. It runs in a
    process of its own (`_process`)."""

    def __init__(self, path: str, mirror: bool = False) -> None:
        """FileError: not readable, or no volume. `mirror`: as of host_sim, for Kretz volumes."""
        self.path = Path(path)
        self._mirror = mirror
        self._kretz: tuple[int, Any] | None = None  # the volume that was read last, and its number
        self._reader: Any = None
        self._unchecked = self.path.suffix.lower() in (".mha", ".mhd")
        self._host_says_patient = False
        self._host_lacks_spacing = False
        self._told: list[str] = []  # what a user may take otherwise than we do
        self._whole: Any = None
        self._dicom: list[_dicom.Volume] = []
        self._scale = 1.0  # mm of the file's unit
        self._fields: dict[str, str] = {}
        self._notes: dict[str, str] = {}  # what others wrote beside the format's own fields
        self._nifti: _nifti.Header | None = None
        self.count = 1
        try:
            self._open()
        except OSError as error:
            raise unreadable(self.path, error) from None
        except RuntimeError as error:
            self._ask_host()  # its reason is the better one
            raise FileError(f"{self.path}: {reason(error)}") from None

    def _open(self) -> None:
        sitk = _images.sitk()
        if not self.path.exists():
            raise FileError(f"{self.path}: no such file or folder")
        if self.path.is_dir():
            self._open_folder()
            return
        if not self.path.is_file():
            raise FileError(f"{self.path}: not a regular file")
        if _kretz.is_one(self.path):
            self._kretz = (0, self._read_kretz(0))
            return
        if _kretz.is_dicom(self.path):
            self._dicom = _dicom.volumes([self.path], self.path, whole_file=True)
            self.count = len(self._dicom)
            return
        _content.check(self.path)
        self._fields, self._notes = _header(self.path)
        self._nifti = _nifti.header(self.path) if _content.is_nifti(self.path) else None
        self._check_scan()
        if _content.is_tiff(self.path):
            _geometry.check_pages(self.path)
        _geometry.check_marks(self.path, self._fields)
        self._ask_host()
        over_time = _geometry.check_kinds(self.path, self._fields)
        self._scale = _geometry.unit(self.path, self._fields, self._notes)
        self._patched = _geometry.patched(self.path, self._fields)
        reader = self._reader = sitk.ImageFileReader()
        reader.SetFileName(self._patched.name if self._patched else str(self.path))
        if self.path.suffix in (".MHA", ".MHD"):  # ITK looks at the name first
            reader.SetImageIO("MetaImageIO")
        with no_warning(self.path):
            reader.ReadImageInformation()
        size, values = reader.GetSize(), reader.GetNumberOfComponents()
        self._believable(reader)
        if len(size) == 4 and values == 1:
            self.count = size[3]
        elif len(size) == 3 and values > 1 and over_time:
            self.count = values
        elif len(size) != 3:
            raise FileError(f"{self.path}: it has {len(size)} dimensions, expected a volume")
        elif values not in (1, 3, 4):
            raise FileError(f"{self.path}: its voxels have {values} values each: save the one of tissue as a file")

    def _check_scan(self) -> None:
        """FileError for what was made of a scan, and says so."""
        what = "a label map" if self._nifti and self._nifti.is_labels else ""
        what = "a segmentation of 3D Slicer" if "segment0_id" in self._notes else what
        if what:
            raise FileError(f"{self.path}: it is no scan, but made of one ({what})")
        if self._nifti and not self._nifti.begins >= _nifti.FIRST:
            raise FileError(f"{self.path}: vox_offset is {self._nifti.begins:g}, expected {_nifti.FIRST} at least")

    def _open_folder(self) -> None:
        for inside in self.path.iterdir():
            if inside.exists() and not inside.is_file() and not inside.is_dir():
                raise FileError(f"{inside}: not a regular file")
            if inside.exists() and not os.access(inside, os.R_OK):  # GDCM would leave the slice out
                raise FileError(f"{inside}: cannot be read: {os.strerror(errno.EACCES)}")
        files = sorted(path for path in self.path.iterdir() if path.is_file() and not _kretz.is_one(path))
        self._dicom = _dicom.volumes(files, self.path)
        self.count = len(self._dicom)

    def _read_kretz(self, number: int) -> Any:
        try:
            image, self.count = _kretz.read(self.path, number, self._mirror)
        except HostError as error:
            raise _of_host(self.path, error) from None
        return image

    def _believable(self, reader: Any) -> None:
        """FileError for geometries that ITK takes without a word, and for more voxels than the file can hold."""
        size, spacing, origin = reader.GetSize(), reader.GetSpacing(), reader.GetOrigin()
        if len(size) >= 3:
            try:
                checked_spacing(spacing[:3])
            except ValueError as error:
                raise FileError(f"{self.path}: {error}") from None
        self._numbers_that_hold(reader)
        axes = np.reshape(reader.GetDirection(), (len(size), len(size)))
        if np.abs(axes.T @ axes - np.eye(len(size))).max() > _ASKEW:
            raise FileError(f"{self.path}: {RIGHT_ANGLES}")
        if not np.isfinite(origin).all():
            raise FileError(f"{self.path}: origin={origin}, expected finite numbers")
        if math.prod(size[:3]) > _MOST_VOXELS:
            raise FileError(f"{self.path}: size={size}, expected at most {_MOST_VOXELS} voxels")
        name, there = self.path.name.lower(), self.path.stat().st_size
        # Of NIfTI the type in the file: values that are scaled become others.
        type_name = _images.sitk().GetPixelIDValueAsString(reader.GetPixelID())
        bits = int((re.findall(r"(\d+)-bit", type_name) or ["8"])[0]) * reader.GetNumberOfComponents()
        first = 0.0
        if reader.HasMetaDataKey("bitpix") and reader.HasMetaDataKey("vox_offset"):
            bits, first = int(reader.GetMetaData("bitpix")), float(reader.GetMetaData("vox_offset"))
        needed = math.prod(size) * bits // 8 + int(first)
        over = _geometry.left_over(self.path, self._fields, needed)
        self._told += [f"It holds {over} bytes more than its header says."] if over else []
        if name.endswith(".gz") or "gz" in self._fields.get("encoding", ""):
            there = there * 1032  # the best that deflate can do
        elif not name.endswith((".nii", ".vtk")) or b"ASCII" in _geometry.first_bytes(self.path):
            return
        if name.endswith(".nii.gz") and needed <= there:
            there = _inflated(self.path)
        if needed > there and "datafile" not in self._fields:
            raise FileError(f"{self.path}: size={size} needs {needed} bytes, the file holds {there} at most")

    def _numbers_that_hold(self, reader: Any) -> None:
        """FileError for numbers of the geometry that ITK cannot compute with: it takes 1 mm without a word then. A
        NRRD's NaN belongs to an axis that is none of space."""
        said = {name: value for name, value in self._fields.items() if name in ("spacings", "spacedirections")}
        nifti = [f"pixdim[{axis}]" for axis in (1, 2, 3)] + ["srow_x", "srow_y", "srow_z"]
        said |= {name: reader.GetMetaData(name) for name in nifti if reader.HasMetaDataKey(name)}
        for name, value in said.items():
            for number in re.findall(r"[-+]?(?:inf|nan|[.\d]+(?:e[-+]?\d+)?)", value.lower()):
                if abs(float(number)) > _FAR or ("nan" in number and name in nifti):
                    raise FileError(f"{self.path}: {name} is '{value}', expected finite numbers of {_FAR:g} at most")

    def _ask_host(self) -> None:
        """FileError if host_sim, which reads all of a MetaImage and is stricter than ITK, refuses the file."""
        if not self._unchecked:
            return
        try:
            said = _host.run(["info", "--", str(self.path)])
            self._host_says_patient = "\n  in the patient: not said" not in said
            self._host_lacks_spacing = "does not say how far apart" in said
            letters = re.search(r"^  (AnatomicalOrientation says .*)$", said, re.MULTILINE)
            self._told += [letters[1]] if letters else []
        except HostError as error:
            if "give a window" not in str(error):  # said of values that were all read; clip says so, too
                raise _of_host(self.path, error) from None
        self._unchecked = False

    @property
    def knows_patient(self) -> bool:
        """True if the file says how the volume lies in the patient: the directions of its images are his then. Known
        once a volume was read."""
        if self._dicom:
            return self._dicom[0].in_patient
        if self._kretz is not None or self.path.suffix.lower() in (".mha", ".mhd"):
            return self._host_says_patient
        return self._claims_place() and not self._is_identity()

    def _is_identity(self) -> bool:
        """ITK's own axes, which it writes for whatever says nothing."""
        read = self._reader
        n = read.GetDimension()
        axes = np.reshape(read.GetDirection(), (n, n))[:3, :3]
        return bool(np.allclose(axes, np.eye(3)))

    def _claims_place(self) -> bool:
        """Whether the file's words, true or written for want of better, are those of the patient's axes."""
        said, read = self._fields, self._reader
        if self.path.suffix.lower() in (".mha", ".mhd"):
            matrix = any(name in said for name in ("transformmatrix", "rotation", "orientation"))
            letters = said.get("anatomicalorientation", "?")
            return matrix and not letters.startswith("?")
        if read.HasMetaDataKey(_images.FILE_NOTES) and read.GetMetaData(_images.FILE_NOTES) == _images.UNPLACED:
            return False  # a result of ours, perhaps written anew by another program
        codes = [read.GetMetaData(code) for code in ("qform_code", "sform_code") if read.HasMetaDataKey(code)]
        return any(code.strip() != "0" for code in codes) or bool(_PATIENT.match(said.get("space", "")))

    def _says_place(self) -> bool:
        """Whether results may say what ITK writes: where the axes are ITK's own, as much as the file does."""
        if self._kretz is not None or self._reader is None or self.knows_patient:
            return self.knows_patient
        return self._claims_place() and self._is_identity()

    def read(self, number: int = 0) -> Any:
        """Volume `number` as a SimpleITK image of 3 dimensions with one value a voxel."""
        status = f"seq_frame{number:04d}_imagestatus"
        if self._reader is not None and self._notes.get(status, "").upper() == "INVALID":
            raise FileError(f"{self.path}: ImageStatus of volume {number} is INVALID")
        try:
            image = self._read_any(number)
        except OSError as error:
            raise unreadable(self.path, error) from None
        except RuntimeError as error:
            raise FileError(f"{self.path}: {reason(error)}") from None
        told = [*self._told, _nifti.two_places(self._nifti, image) if self._nifti else ""]
        if not self._says_place():
            image.SetMetaData(_images.PLACE, "1")
        if any(told):
            image.SetMetaData(_images.TOLD, " ".join(filter(None, told)))
        return image

    def _read_any(self, number: int) -> Any:
        if self._dicom:
            return self._read_dicom(self._dicom[number])
        if self._kretz is not None:
            if self._kretz[0] != number:
                self._kretz = (number, self._read_kretz(number))
            return self._kretz[1]
        with no_warning(self.path):
            return self._said(self._grey(self._read(number)))

    def _said(self, image: Any) -> Any:
        """Lengths in mm, and a note where the file says none; the probe's side, where it says that."""
        lengths = [self._scale * length for length in image.GetSpacing()]
        if "ndims" not in self._fields:  # what ITK computes from directions is off in its last digits
            lengths = [float(f"{length:.12g}") for length in lengths]
        image.SetSpacing(lengths)
        image.SetOrigin([self._scale * length for length in image.GetOrigin()])
        tiff = _geometry.tiff_spacing(self.path) if _content.is_tiff(self.path) else ()
        other = tiff or _geometry.in_other_words(self.path, self._fields)
        if other:
            image.SetSpacing([self._scale * length for length in other])
        said = other or _geometry.says_spacing(self.path, self._fields, self._reader, self._nifti)
        if tiff is None or not said or self._host_lacks_spacing:
            image.SetMetaData(_images.NOT_SAID, "1")
        side = _geometry.side(self._fields.get("ultrasoundimageorientation", ""))
        if side:
            image.SetMetaData(_images.PROBE, side)
        return image

    def _grey(self, image: Any) -> Any:
        """Grey that was saved in equal channels; a fourth one may hold anything."""
        if image.GetNumberOfComponentsPerPixel() not in (3, 4):
            return image
        voxels = _images.sitk().GetArrayViewFromImage(image)
        if not (np.array_equal(voxels[..., 0], voxels[..., 1]) and np.array_equal(voxels[..., 0], voxels[..., 2])):
            raise FileError(
                f"{self.path}: it is in colour: its {voxels.shape[-1]} channels differ. Convert it to grey first, in "
                "3D Slicer with Vector to Scalar Volume"
            )
        return _images.sitk().VectorIndexSelectionCast(image, 0)

    def _voxels_of(self, file: str) -> NDArray[Any]:
        """Of a DICOM file, [z, y, x]."""
        sitk = _images.sitk()
        whole = sitk.ReadImage(file)
        try:
            voxels: NDArray[Any] = sitk.GetArrayFromImage(self._grey(whole))
        except FileError:
            planes = _pixels.grey_of_planes(Path(file))
            if planes is None:
                raise
            return planes
        return voxels.reshape(-1, *voxels.shape[-2:])

    def _read_dicom(self, volume: _dicom.Volume) -> Any:
        sitk = _images.sitk()
        files = list(dict.fromkeys(str(frame.path) for frame in volume.frames))
        if len(files) == len(volume.frames) > 1:
            reader = sitk.ImageSeriesReader()
            reader.SetFileNames(files)
            voxels = sitk.GetArrayFromImage(self._grey(reader.Execute()))
        else:
            arrays = {file: self._voxels_of(file) for file in files}
            voxels = np.stack([arrays[str(frame.path)][frame.index] for frame in volume.frames])
        voxels = _pixels.by_table(voxels, [frame.table for frame in volume.frames], volume.frames[0].path)
        image = sitk.GetImageFromArray(voxels)
        image.SetSpacing(volume.spacing or (1.0, 1.0, 1.0))
        image.SetOrigin(volume.origin.tolist())
        image.SetDirection(volume.direction.ravel().tolist())
        self._told = [volume.told]
        if volume.spacing is None:
            image.SetMetaData(_images.NOT_SAID, "1")
        if volume.probe.side is not None:
            image.SetMetaData(_images.PROBE, volume.probe.side)
        if volume.probe.apex is not None:
            image.SetMetaData(_images.APEX, " ".join(map(repr, volume.probe.apex)))
        return image

    def _read(self, number: int) -> Any:
        if self._reader.GetDimension() == 4:
            return self._read_of_four(number)
        if self.count == 1:
            return self._reader.Execute()
        if self._whole is None:
            self._whole = self._reader.Execute()
        return _images.sitk().VectorIndexSelectionCast(self._whole, number)

    def _read_of_four(self, number: int) -> Any:
        """A file that is compressed is unpacked for every read, so what is not too large is read once."""
        size = list(self._reader.GetSize())
        part, first = [*size[:3], 0], [0, 0, 0, number]
        if self._whole is None and int(np.prod(size)) <= _KEPT_VOXELS:
            self._whole = self._reader.Execute()
        if self._whole is not None:
            return _images.sitk().Extract(self._whole, part, first)
        self._reader.SetExtractSize(part)
        self._reader.SetExtractIndex(first)
        return self._reader.Execute()


def _of_host(path: Path, error: HostError) -> FileError | DeviceError:
    if error.code is None:
        return FileError(f"{path}: this format is read by host_sim; NRRD, NIfTI and DICOM need no host. {error}")
    kind = DeviceError if isinstance(error, DeviceError) else FileError
    return kind(str(error).removeprefix("host_sim info: "))


def _header(path: Path) -> tuple[dict[str, str], dict[str, str]]:
    """The fields of a NRRD or MetaImage header and its notes, names in lower case without spaces. A NRRD's notes stand
    behind ":=", whatever their names; MetaImage does not part the two. FileError: a NRRD's data is not in its folder or
    below it, wherever links lead."""
    fields: dict[str, str] = {}
    notes: dict[str, str] = {}
    with open(path, "rb") as file:
        is_nrrd = file.read(4) == b"NRRD"
        file.seek(0)
        while (is_nrrd or path.suffix.lower() in (".mha", ".mhd")) and file.tell() < _HEADER:
            line = file.readline(_HEADER)
            found = re.match(rb"([^:=]+)(:=|[:=])\s*(.*)", line.strip())
            name = found[1].decode("ascii", "replace").replace(" ", "").lower() if found else ""
            if found and is_nrrd and found[2] == b":=":
                notes[name] = os.fsdecode(found[3])
                name = ""
            elif found:
                fields[name] = os.fsdecode(found[3])
            if name == "elementdatafile" or (is_nrrd and name == "datafile") or not (line.strip() if is_nrrd else line):
                break
        if is_nrrd and "datafile" in fields:
            listed = fields["datafile"].split()[:1] == ["LIST"]
            rest = file.read(_HEADER).splitlines() if listed else []
            _stay_below(path, [os.fsdecode(name) for name in rest] or [fields["datafile"]])
    return fields, notes if is_nrrd else fields


def _stay_below(header: Path, names: Sequence[str]) -> None:
    folder = header.parent.resolve()
    for name in names:
        files = [str(folder / name)]
        if "%" in name:  # a pattern of many names, and the numbers in them
            files += glob.glob(os.path.join(glob.escape(str(folder)), re.sub(r"%\d*d", "*", name.split()[0])))
        for file in map(Path, files):
            if not file.resolve().is_relative_to(folder) or (file.exists() and not file.is_file()):
                raise FileError(f"{header}: data file is '{name}', expected a regular file in the folder or below it")


def _inflated(path: Path) -> int:
    """The bytes that a gzip file holds. SimpleITK does not say when they end early or are damaged."""
    count = 0
    try:
        with gzip.open(path) as file:
            while piece := file.read(1 << 20):
                count += len(piece)
    except (OSError, EOFError, zlib.error) as error:
        raise FileError(f"{path}: {error}") from None
    return count
