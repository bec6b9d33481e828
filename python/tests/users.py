# SPDX-License-Identifier: MIT
"""What users have, and what is right of it or said: one table. test_kinds has its rows in Python, test_doors at every
door that takes the format."""

import numpy as np
import tifffile
from conftest import layers
from makers import (
    MM,
    SPACING,
    Make,
    beat,
    big_endian,
    block,
    deep,
    deflated,
    fan,
    in_db,
    in_members,
    labelled,
    longer,
    meta,
    mirrored,
    named,
    nifti,
    nrrd,
    odd_apart,
    of_two_sizes,
    packed,
    pictures_in,
    placed,
    reworded,
    two_places,
    vtk,
    within,
    written,
)
from makers_dicom import (
    by_table,
    changed,
    coloured,
    enhanced,
    far_probe,
    folder_of,
    halved,
    last_at,
    last_turned,
    lossy,
    packed_by,
    palette,
    region,
    series,
    stored,
    transferred,
    with_flow,
    without_places,
    ybr_of,
)


def expected(name: str, voxels: np.ndarray) -> np.ndarray:
    """The levels that a plugin is to get: of dB by the range of what was scanned, else the voxels as they are."""
    if name == "outside.mha":
        return np.where(voxels, np.maximum(voxels, 17), 0).astype(np.uint8)
    if name == "white.nrrd":
        return np.where(voxels, np.minimum(voxels, 254), 0).astype(np.uint8)
    if name.startswith(("db", "inf", "stored", "big")):
        low, high = voxels[voxels > 0].min(), voxels.max()
        levels = np.floor((voxels.astype(float) - low) / (float(high) - low) * 255 + 0.5)
        return np.where(voxels, np.maximum(levels, 1), 0).astype(np.uint8)
    return voxels


RIGHT: dict[str, Make] = {  # clipped as the plain file is
    "enhanced.dcm": enhanced,
    "times.dcm": lambda path, v: enhanced(path, v, times=3),
    "folder": folder_of,
    "outside.mha": lambda path, v: meta(path, np.where(v, expected(path.name, v), np.uint8(16)), MM),
    "white.nrrd": lambda path, v: written(np.where(v, expected(path.name, v), np.uint8(255)), path),
    "db_nan.mha": lambda path, v: meta(path, in_db(v, np.nan), MM, kind="MET_FLOAT"),
    "db_999.mha": lambda path, v: meta(path, in_db(v, -999), MM, kind="MET_FLOAT"),
    "inf.nrrd": lambda path, v: written(in_db(v, -np.inf), path),
    "grey.mha": lambda path, v: meta(path, np.repeat(v[..., None], 3, -1), MM, "ElementNumberOfChannels = 3"),
    "rgb.nrrd": lambda path, v: nrrd(
        path, np.repeat(v[..., None], 4, -1), "space: LPS", "kinds: RGBA-color domain domain domain",
        "space directions: none (1.25,0,0) (0,1.25,0) (0,0,2.5)", sizes="4 96 96 48"),
    "last.nrrd": lambda path, v: nrrd(
        path, np.stack([v, v]), "kinds: domain domain domain list", "spacings: 1.25 1.25 2.5 nan", sizes="96 96 48 2"),
    "ome.tif": lambda path, v: tifffile.imwrite(path, v, ome=True, metadata={"axes": "ZYX"} | {
        f"PhysicalSize{axis}": 1e3 * length for axis, length in zip("XYZ", SPACING, strict=True)}),
    "um.nrrd": lambda path, v: nrrd(
        path, v, "space: LPS", "space directions: (1250,0,0) (0,1250,0) (0,0,2500)", 'space units: "um" "um" "um"'),
    "cm.nrrd": lambda path, v: nrrd(
        path, v, "space: LPS", "space directions: (.125,0,0) (0,.125,0) (0,0,.25)", 'space units: "cm" "cm" "cm"'),
    "plus.mha": lambda path, v: meta(
        path, v, MM, "TransformMatrix = 1 0 0 0 1 0 0 0 1", "Kinds = domain domain domain",
        "AnatomicalOrientation = RAI", "UltrasoundImageOrientation = MFA", "Seq_Frame0000_ImageStatus = OK"),
    "supra.mha": lambda path, v: meta(
        path, v, MM + " 1", "TransformMatrix = 1 0 0 0 1 0 0 0 1", "Seq_Frame0000_Timestamp = 1",
        "Seq_Frame0001_Timestamp = 2", frames=2),
}  # fmt: skip
RIGHT |= {  # colour spaces and transfer syntaxes
    "rgb.dcm": lambda path, v: coloured(path, np.repeat(v[..., None], 3, -1), "RGB"),
    "rgb_planes.dcm": lambda path, v: coloured(path, np.repeat(v[..., None], 3, -1), "RGB", 1),
    "ybr.dcm": lambda path, v: coloured(path, ybr_of(v)),
    "ybr_planes.dcm": lambda path, v: coloured(path, ybr_of(v), planes=1),
    "ybr_rle.dcm": lambda path, v: coloured(path, ybr_of(v), rle=True),
    "ybr_rle_planes.dcm": lambda path, v: coloured(path, ybr_of(v), planes=1, rle=True),
    "ybr_422.dcm": halved,
    "palette.dcm": palette,
    "stored12.dcm": stored,
    "stored12_overlay.dcm": lambda path, v: stored(path, v, above=15),
    "deflated.dcm": lambda path, v: transferred(path, v, "DeflatedExplicitVRLittleEndian"),
    "implicit.dcm": lambda path, v: transferred(path, v, "ImplicitVRLittleEndian"),
    "jpeg2000.dcm": lambda path, v: packed_by(path, v, "JPEG2000"),
    "jpeg_lossless.dcm": lambda path, v: packed_by(path, v, "JPEG"),
    "series": lambda path, v: series(path, v, "6.1"),
    "captures": lambda path, v: series(path, v, "7"),
    "many_frames.dcm": without_places,
    "motion.dcm": lambda path, v: changed(path, v, SequenceOfUltrasoundRegions=[region(0.0625, 4)]),  # down is time
    "regions.dcm": lambda path, v: changed(path, v, SequenceOfUltrasoundRegions=[region(0.0625)] * 2),  # whose?
}
RIGHT |= {
    "big.nii": big_endian,
    "points.vtk": lambda path, v: vtk(path, v, "POINT_DATA", 0),
    "50%d.nrrd": lambda path, v: written(v, path),
    "members.nii.gz": in_members,
    "limits.nrrd": lambda path, v: nrrd(
        path, v, "axis mins: 0 0 0", "axis maxs: 120 118.75 120", "centerings: cell node cell"
    ),
    "centers.nrrd": lambda path, v: nrrd(  # the format's own name of this field (Teem 1.9); ITK 5.4 knows both
        path, v, "axis mins: 0 0 0", "axis maxs: 120 118.75 120", "centers: cell node cell"
    ),
    "notes.nrrd": lambda path, v: nrrd(  # behind ":=" anybody writes anything
        path, v, "spacings: 1.25 1.25 2.5", 'space units:="cm" "cm" "cm"', "DistanceUnits:=cm", "space:=time"
    ),
    "noted.nrrd": lambda path, v: nrrd(  # as SimpleITK 2.5 writes a MetaImage of DistanceUnits = cm
        path,
        v,
        "space: left-posterior-superior",
        "space directions: (.125,0,0) (0,.125,0) (0,0,.25)",
        "ITK_InputFilterName:=MetaImageIO",
        "ITK_VoxelUnits:=cm",
    ),
    "aspect.vtk": lambda path, v: reworded(path, v, "SPACING", "ASPECT_RATIO"),
}
SAID: dict[str, tuple[Make, int, str]] = {  # a code, and the sentence
    "nospace.mha": (meta, 0, "does not say how far apart its voxels are"),
    "nospace.nrrd": (nrrd, 0, "does not say how far apart its voxels are"),
    "pages.tif": (lambda path, v: written(v, path), 0, "does not say how far apart its voxels are"),
    "bare.dcm": (lambda path, v: enhanced(path, v, measures=False), 0, "does not say how far apart"),
    "metres.mha": (lambda path, v: meta(path, v, "ElementSpacing = 1.25e-3 1.25e-3 2.5e-3"), 0, "spacing in metres?"),
    "zero.nii": (lambda path, v: odd_apart(path, v, 0), 0, "does not say how far apart its voxels are"),
    "nan.nii": (lambda path, v: odd_apart(path, v, np.nan), 0, "does not say how far apart its voxels are"),
    "made.seg.nrrd": (
        lambda path, v: nrrd(path, v, "spacings: 1.25 1.25 2.5", "Segment0_ID:=Segment_1", "Segment0_Name:=tissue"), 3,
        "it is no scan, but made of one (a segmentation of 3D Slicer)"),
    "within.nii": (within, 3, "vox_offset is 0, expected 352 at least"),
    "block.nrrd": (block, 3, "its values are of type block, expected numbers"),
    "labels.nii": (labelled, 3, "it is no scan, but made of one (a label map)"),
    "oblique.dcm": (
        lambda path, v: enhanced(path, v, across=(1, 0, 0, 0.1, 1, 0)), 3,
        "its rows and columns run along 1, 0, 0, 0.1, 1, 0, expected directions of length 1 at right angles"),
    "over_time.nrrd": (
        lambda path, v: nrrd(path, v, "spacings: 1.25 1.25 nan", "kinds: domain domain time"), 3,
        "it holds 48 pictures over time"),
    "amid.nrrd": (
        lambda path, v: nrrd(path, np.stack([v, v], 2), "kinds: domain time domain domain", sizes="96 2 96 48"), 3,
        "axis 2 is time, expected the last one"),
    "none.nrrd": (
        lambda path, v: nrrd(path, v, "space: LPS", "space directions: (1.25,0,0) (0,1.25,0) none"), 0,
        "does not say how far apart its voxels are"),
    "thick.dcm": (lambda path, v: enhanced(path, v, step=()), 0, "does not say how far apart its voxels are"),
    "zero.nrrd": (lambda path, v: nrrd(path, v, "spacings: 0 0 0"), 3, "a spacing is 0, expected lengths above 0"),
    "rast.nrrd": (
        lambda path, v: nrrd(path, v, "space: RAST", "space directions: (1.25,0,0,0) (0,1.25,0,0) (0,0,2.5,0)"), 3,
        "its space is 'RAST', expected one of three dimensions, without time"),
    "both.nrrd": (
        lambda path, v: nrrd(path, v, "spacings: 2 2 2", "space: LPS", "space directions: (1,0,0) (0,1,0) (0,0,1)"), 3,
        "it has spacings and space directions, of which only one may be there"),
    "first.nrrd": (
        lambda path, v: nrrd(path, np.stack([v, v], -1), "kinds: time domain domain domain", sizes="2 96 96 48"), 3,
        "axis 1 is time, expected the last one"),
    "space_first.nrrd": (
        lambda path, v: nrrd(
            path, np.stack([v] * 5, -1), "kinds: time space space space", "space: LPS",
            "space directions: none (1.25,0,0) (0,1.25,0) (0,0,2.5)", sizes="5 96 96 48"), 3,
        "axis 1 is time, expected the last one"),
    "field.vtk": (
        lambda path, v: reworded(path, v, "SCALARS v unsigned_char 1\nLOOKUP_TABLE default",
                                 f"FIELD FieldData 1\nv 1 {v.size} unsigned_char"), 3,
        "its values are in a FIELD, expected SCALARS"),
    "rectilinear.vtk": (
        lambda path, v: reworded(path, v, "STRUCTURED_POINTS", "RECTILINEAR_GRID"), 3,
        "its dataset is RECTILINEAR_GRID, expected STRUCTURED_POINTS"),
    "pixels.tif": (
        lambda path, v: tifffile.imwrite(
            path, v, imagej=True, resolution=(1, 1), metadata={"spacing": 1, "unit": "pixel", "axes": "ZYX"}), 0,
        "does not say how far apart its voxels are"),
    "ome_pixels.tif": (
        lambda path, v: tifffile.imwrite(path, v, ome=True, metadata={"axes": "ZYX"} | {
            f"PhysicalSize{axis}{what}": said for axis in "XYZ" for what, said in (("", 1), ("Unit", "pixel"))}), 0,
        "does not say how far apart its voxels are"),
    "sizes.tif": (
        of_two_sizes, 3, "its pages are of 96 x 96 and 48 x 48 pixels: save those of the volume as a file"),
    "askew.nrrd": (
        lambda path, v: nrrd(path, v, "space: LPS", "space directions: (1.25,0,0) (.4,1.25,0) (0,0,2.5)"), 3,
        "its axes are not at right angles"),
    "two.nrrd": (
        lambda path, v: nrrd(path, np.stack([v, v], -1), "kinds: vector domain domain domain", sizes="2 96 96 48"), 3,
        "its voxels have 2 values each"),
    "times.tif": (
        lambda path, v: tifffile.imwrite(path, np.stack([v, v]), imagej=True, metadata={"axes": "TZYX"}), 3,
        "its pages are of 2 times"),
    "white.tif": (lambda path, v: tifffile.imwrite(path, v, photometric="miniswhite"), 3, "its grey is inverted"),
    "packed.mha.gz": (packed, 3, "it is compressed as a whole"),
    "colour.nrrd": (
        lambda path, v: nrrd(path, np.stack([v, v // 2, v], -1), "kinds: RGB-color domain domain domain",
                             sizes="3 96 96 48"), 3, "it is in colour"),
    "feet.nrrd": (
        lambda path, v: nrrd(path, v, "space: LPS", "space directions: (1,0,0) (0,1,0) (0,0,1)",
                             'space units: "ft" "ft" "ft"'), 3, "its lengths are in 'ft'"),
    "lost.dcm": (lambda path, v: enhanced(path, v, times=2, missing=5), 3, "which of them make up a volume is not"),
    "few.dcm": (
        lambda path, v: changed(path, v, lambda data: data.PerFrameFunctionalGroupsSequence.pop()), 3,
        "it has 48 pictures and says where 47 of them lie"),
    "zero.dcm": (
        lambda path, v: changed(path, v, lambda data: setattr(
            data.SharedFunctionalGroupsSequence[0].PixelMeasuresSequence[0], "PixelSpacing", [1.25, 0])), 0,
        "does not say how far apart its voxels are"),
    "gap.dcm": (lambda path, v: enhanced(path, v, missing=5), 3, "slices are missing or not evenly spaced"),
    "near.dcm": (lambda path, v: last_at(path, v, (0, 0, 116)), 3, "it lies 1 mm behind the slice before it, others"),
    "turned.dcm": (last_turned, 3, "no other of its pictures lies along picture 48: no volume"),
    "slipped.dcm": (lambda path, v: last_at(path, v, (0.5, 0, 117.5)), 3, "lie 0.5 mm beside the one before"),
    "beside.dcm": (lambda path, v: enhanced(path, v, step=(0.5, 0, 2.5)), 3, "lie 0.5 mm beside the one before"),
    "place.dcm": (lambda path, v: enhanced(path, v, step=(0, 0, 0)), 3, "48 pictures, lie at one place"),
    "white.dcm": (lambda path, v: enhanced(path, v, grey="MONOCHROME1"), 3, "its grey is inverted"),
    "inverse.dcm": (lambda path, v: changed(path, v, PresentationLUTShape="INVERSE"), 3, "grey is inverted (INV"),
    "seg.dcm": (lambda path, v: enhanced(path, v, of_class="66.4"), 3, "but made of one (Segmentation Storage)"),
    "map.dcm": (lambda path, v: enhanced(path, v, of_class="30"), 3, "but made of one (Parametric Map Storage)"),
    "table.dcm": (lambda path, v: by_table(path, v, 200), 3, "its modality look-up table is damaged"),
    "bzip2.nrrd": (lambda path, v: nrrd(path, v, by="bzip2"), 3, "it is compressed with bzip2"),
    "lost.nrrd": (lambda path, v: nrrd(path, v, "data file: lost.raw"), 3, "its data file cannot be opened"),
    "early.nrrd": (lambda path, v: nrrd(path, v[:9]), 3, "its data end early"),
    "flat.nrrd": (lambda path, v: nrrd(path, v[0], sizes="96 96"), 3, "it has 2 dimensions"),
    "comma.nrrd": (lambda path, v: nrrd(path, v, "spacings: 1,25 1,25 2,5"), 3, "expected a point as decimal mark"),
    "nothing": (lambda path, v: path.mkdir(), 3, "there is no file in the folder"),
    "slices": (pictures_in, 3, "no DICOM series, but 3 pictures, which tell no length"),
}  # fmt: skip
NAMES: dict[str, tuple[Make, str]] = {  # a name that is not the content: the cause
    "gz.nii": (named(".nii.gz"), "by its content it is NIfTI in gzip, not by its name: let it end in .nii.gz"),
    "plain.nii.gz": (named(".nii"), "by its content it is NIfTI, not by its name: let it end in .nii"),
    "none": (named(".nii.gz"), "let it end in .nii.gz"),
    "meta.nrrd": (named(".mha"), "by its content it is MetaImage, not by its name: let it end in .mha"),
    "nrrd.mha": (named(".nrrd"), "by its content it is NRRD, not by its name: let it end in .nrrd"),
    "two.nii.gz": (named(".nii", nifti(540, b"n+2", 4), pack=True), "it is NIfTI-2, which is not read here"),
    "old.hdr": (named(".nii", nifti(348, b"", 0)), "it is Analyze 7.5, which does not say where left is"),
    "._a.nrrd": (named(".nii", b"\0\5\x16\7\0\2\0\0"), "it is what macOS keeps beside a file, not the file"),
    "._a.mha": (named(".nii", b"\0\5\x16\7\0\2\0\0"), "it is what macOS keeps beside a file, not the file"),
    "lfs.nrrd": (named(".nii", b"version https://git-lfs.github.com/spec/v1\n"), "it is a pointer of Git LFS"),
    "page.nii": (named(".nii", b"<!DOCTYPE html><html>"), "it is a web page"),
    "bare.dcm": (named(".nii", b"\x08\x00\x05\x00CS\x0a\x00ISO_IR 100"), "it is DICOM without its preamble"),
    "gz.nrrd": (named(".nrrd", pack=True), "it is compressed as a whole: unpack it first"),
    "empty.nii": (lambda path, v: path.touch(), "the file is empty"),
    "scan.gipl": (lambda path, v: written(v, path), "is none of NRRD, MetaImage, NIfTI, TIFF, VTK, DICOM and Kretz"),
    "cells.vtk": (lambda path, v: vtk(path, v, "CELL_DATA", 1), "its values belong to cells (CELL_DATA)"),
    "100%d.nhdr": (
        lambda path, v: written(v, path), "a data file's name has a %, which NRRD takes for a pattern of names"),
    "50%.mhd": (
        lambda path, v: meta(path, v, MM, data="50%.raw"), "expected a name without %, which MetaImage takes for a"),
}  # fmt: skip

PLACED: dict[str, tuple[Make, str]] = {  # where the volume lies, and where the probe was; what is said, "": nothing
    "turned.mha": (lambda path, v: placed(path, v, (0, 0, 1, 1, 0, 0, 0, 1, 0)), ""),
    "left.nrrd": (lambda path, v: placed(path, v, (-1, 0, 0, 0, 1, 0, 0, 0, 1)), ""),
    "letters.mha": (
        lambda path, v: meta(path, v, MM, "AnatomicalOrientation = LPI"),
        "only TransformMatrix counts"),
    "two.nii": (two_places, "disagree, by 30 degrees"),
    "box.mha": (lambda path, v: meta(path, layers((48, 96, 96)), MM), "nobody says where the probe was: -z is assumed"),
    "far.dcm": (far_probe, "a fan from +z: lines from"),
    "flow.dcm": (with_flow, ""),
    "lossy.dcm": (lossy, "Its corners hold dark noise"),
}  # fmt: skip
TOLD: dict[str, tuple[Make, str]] = {  # two truths in a file, and which counts; what is no scan of ours
    "region.dcm": (
        lambda path, v: changed(path, v, SequenceOfUltrasoundRegions=[region(-0.0625)]),
        "Its pixels are 1.25 x 1.25 mm large, by its ultrasound region 0.625 x 0.625: the first counts."),
    "apart.dcm": (
        lambda path, v: changed(path, v, lambda data: setattr(
            data.SharedFunctionalGroupsSequence[0].PixelMeasuresSequence[0], "SpacingBetweenSlices", 1.0)),
        "SpacingBetweenSlices says 1 mm, the places of its planes 2.5: the places count."),
    "mirrored.nii": (
        mirrored, ("Its qform and its sform disagree, one is the mirror image of the other: the qform counts, as in "
                   "ITK and 3D Slicer; nibabel, and what stands on it, takes the sform.")),
    "more.nrrd": (
        lambda path, v: nrrd(path, np.concatenate([v, v]), "spacings: 1.25 1.25 2.5"),
        "It holds 442368 bytes more than its header says."),
    **dict.fromkeys(
        ("more.nii", "more.nii.gz", "packed_more.nrrd", "more.vtk"),
        (longer, "It holds 18432 bytes more than its header says.")),
    "aspect.dcm": (
        lambda path, v: changed(path, v, PixelAspectRatio=["2", "1"]),
        "Its pixels are 1.25 x 1.25 mm large, by PixelAspectRatio 2 times as long as wide: the first counts."),
    "mr.dcm": (lambda path, v: changed(path, v, Modality="MR"), "Its modality is MR: it is no ultrasound."),
}  # fmt: skip
FURTHER: dict[str, tuple[Make, str]] = {  # what the machine reads, too; what is said, "": it is clipped as it is
    "plain.mha": (lambda path, v: meta(path, v, MM), ""),
    "PLAIN.MHA": (lambda path, v: meta(path, v, MM), ""),
    "deep.mha": (deep, ""),
    "deep.nrrd": (deep, ""),
    "signed.mha": (lambda path, v: meta(path, np.where(v, v.astype("<i2"), -32768), MM, kind="MET_SHORT"), ""),
    "most.mha": (lambda path, v: meta(path, np.where(v, v.astype("<u2") * 8, 4095), MM, kind="MET_USHORT"), ""),
    "said_cm.mha": (
        lambda path, v: meta(path, v, "ElementSpacing = .125 .125 .25", "DistanceUnits = cm"), ""),
    "furlong.mha": (
        lambda path, v: meta(path, v, MM, "DistanceUnits = furlong"),
        ":4: DistanceUnits is 'furlong', expected mm, cm, m, um or ?"),
    "deflated.mha": (deflated, ""),
    "lower.mha": (
        lambda path, v: meta(path, v, "elementspacing = 1.25 1.25 2.5"), "does not say how far apart its voxels are"),
    "listed.mha": (lambda path, v: meta(path, v, MM, "Kinds = domain domain list"), ""),
    "cm.mha": (lambda path, v: meta(path, v, "ElementSpacing = .125 .125 .25"), "its spacing in centimetres?"),
    "um.mha": (lambda path, v: meta(path, v, "ElementSpacing = 1250 1250 2500"), "its spacing in micrometres?"),
    "uneven.mha": (lambda path, v: meta(path, v, "ElementSpacing = .1 .1 2.5"), "times as long as another"),
    "zero.mha": (lambda path, v: meta(path, v, "ElementSpacing = 0 0 0"), "ElementSpacing is '0 0 0', expected"),
    "comma.mha": (lambda path, v: meta(path, v, "ElementSpacing = 1,25 1,25 2,5"), "is '1,25 1,25 2,5', expected"),
    "one_cm.mha": (lambda path, v: meta(path, v, "ElementSpacing = 1.25 1.25 .25"), "12 mm along z: is the spacing"),
    "transposed.mha": (
        lambda path, v: written(np.ascontiguousarray(v.T), path), "As a fan this fits with 2.5 x 1.25 x 1.25 mm"),
    "noise.mha": (
        lambda path, v: meta(path, np.where(v, v, np.arange(v.size, dtype=np.uint8).reshape(v.shape) % 3 + 1), MM),
        "Its corners hold dark noise"),
    "flow.mha": (
        lambda path, v: meta(path, np.repeat(v[..., None], 2, -1), MM, "ElementNumberOfChannels = 2"),
        "ElementNumberOfChannels is '2'"),
    "thick.nrrd": (lambda path, v: nrrd(path, v, "thicknesses: 1.25 1.25 2.5"), "does not say how far apart"),
    "beat.mhd": (beat, ""),
    "probe.vol": (fan, ""),
}  # fmt: skip
