# SPDX-License-Identifier: MIT
"""clip() and Result: where the surface lies, what is kept, any camera, and what is said of bad input."""

import re
from pathlib import Path

import numpy as np
import pytest
import SimpleITK as sitk
from conftest import FETUS, FLUID, SKIN, host_sim, layers

import smartvis
from smartvis import Outcome


class Nifti1Image:
    """As nibabel has it: its array is [x, y, z]."""

    __module__ = "nibabel.nifti1"
    affine = np.eye(4)

    def __init__(self, voxels: np.ndarray) -> None:
        self.voxels = voxels

    def __array__(self, dtype: object = None, copy: object = None) -> np.ndarray:
        return self.voxels


class Image:
    """As ITK's own Python has it, which SimpleITK does not take."""

    __module__ = "itk.itkImagePython"

    def CopyInformation(self) -> None: ...  # noqa: N802

    def GetSpacing(self) -> None: ...  # noqa: N802


def test_arrays_of_x_y_z_are_asked_about_and_their_images_refused(volume: np.ndarray) -> None:
    asked = smartvis.clip(np.asfortranarray(volume), (1, 1, 1))
    assert "Its first axis is the fastest in memory: is it [x, y, z]?" in asked.doubt
    assert not smartvis.clip(np.asfortranarray(volume).T.copy().T[::-1], (1, 1, 1)).doubt  # some other order
    assert not smartvis.clip(volume, (1, 1, 1)).doubt
    with pytest.raises(ValueError, match=r"nibabel's Nifti1Image, whose axes are x, y, z.*\[z, y, x\]"):
        smartvis.clip(Nifti1Image(volume.T))
    with pytest.raises(ValueError, match="itk's Image, expected an image of SimpleITK"):
        smartvis.clip(Image())


def test_an_image_in_cm_is_refused_and_its_file_is_scaled(tmp_path: Path, volume: np.ndarray) -> None:
    """ITK 5.4 leaves the lengths of a MetaImage in its DistanceUnits, and notes the unit."""
    path = tmp_path / "cm.mha"
    lines = "NDims = 3\nDistanceUnits = cm\nElementSpacing = 0.08 0.08 0.05\nElementType = MET_UCHAR\n"
    size = " ".join(map(str, volume.shape[::-1]))
    path.write_bytes(f"{lines}DimSize = {size}\nElementDataFile = LOCAL\n".encode() + volume.tobytes())
    with pytest.raises(ValueError, match="ITK_VoxelUnits of the image is 'cm', expected mm"):
        smartvis.clip(sitk.ReadImage(str(path)))
    assert np.array_equal(smartvis.clip(path).depth_mm, smartvis.clip(volume, (0.8, 0.8, 0.5)).depth_mm)


def test_apply_mask_and_millimetres(volume: np.ndarray) -> None:
    """On a grid of cubes of 0.8 mm, other than the volume's own."""
    result = smartvis.clip(volume, spacing=(0.8, 0.8, 0.5), lowres=56, method="wall")
    assert result.depth.shape == (56, 56) and result.camera.shape[0] == 40
    z = np.arange(64)[:, None, None] * 0.5 + 0.25  # mm from the front
    kept = z >= result.depth_mm + 0.4
    assert np.array_equal(result.mask(), kept)
    clipped = result.apply(volume, fill=7)
    assert np.array_equal(clipped, np.where(kept, volume, 7))
    assert not (clipped[:, 8:-8, 8:-8] == SKIN).any()
    assert (clipped[-1] == FETUS).all()
    assert np.allclose(result.depth_mm, result.depth * 0.8)
    other = result.apply(volume.astype(np.float32) / 2)
    assert other.dtype == np.float32 and np.array_equal(other, np.where(kept, volume / 2, FLUID / 2))


def test_surface_is_the_depthmap_in_millimetres(volume: np.ndarray) -> None:
    result = smartvis.clip(volume, spacing=(0.8, 0.8, 0.5), lowres=56, method="wall")
    vertices, faces = result.surface()
    clips = result.depth > 0
    y, x = np.nonzero(clips)  # a slice of the map is 0.8 mm thick, its first one begins where the volume does
    assert np.allclose(vertices, np.stack([x * 0.8, y * 0.8, result.depth[y, x] * 0.8 + 0.15], -1), atol=1e-4)
    assert faces.shape == (2 * 55 * 55 if clips.all() else len(faces), 3) and faces.max() == len(vertices) - 1
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    assert (np.cross(b - a, c - a)[:, 2] < 0).all()  # all faces look at the viewer


def test_nothing_to_clip_keeps_everything() -> None:
    blank = np.full((32, 32, 32), 150, np.uint8)
    result = smartvis.clip(blank, spacing=(1, 1, 1))
    assert result.outcome is Outcome.NO_SURFACE and not result.clips
    assert result.mask().all() and np.array_equal(result.apply(blank), blank)
    assert len(result.surface()[0]) == 0


AXES = [(0, 0, 1), (0, 0, -1), (0, 1, 0), (0, -1, 0), (1, 0, 0), (-1, 0, 0)]


@pytest.mark.parametrize("direction", AXES)
def test_views_along_an_axis_are_exact(volume: np.ndarray, direction: tuple[int, int, int]) -> None:
    """The volume is turned so that its front lies where the camera looks from: the map must be the same."""
    camera = smartvis.look(volume.shape, (1, 1, 1), direction)
    straight = smartvis.clip(volume, spacing=(1, 1, 1), method="wall")
    # A volume that this camera sees as `volume`: the inverse of what the camera does to arrays.
    order, reverse = camera._axes()
    turned = np.ascontiguousarray(np.flip(volume, reverse).transpose(np.argsort(order)))
    seen = smartvis.clip(turned, spacing=(1, 1, 1), view=direction, method="wall")
    assert np.array_equal(seen.depth, straight.depth)
    assert np.array_equal(np.flip(seen.mask().transpose(order), reverse), straight.mask())


def test_a_turned_view_clips_along_its_own_rays() -> None:
    volume = layers((72, 64, 64))
    tilt = np.deg2rad(12)
    direction = np.array([np.sin(tilt), 0, np.cos(tilt)])
    result = smartvis.clip(volume, spacing=(1, 1, 1), view=direction, method="wall")
    assert result.clips and result.depth.shape != (64, 64)
    inner = np.s_[:, 16:-16, 16:-16]
    clipped = result.apply(volume)[inner]
    assert not (clipped == SKIN).any()
    lost = (volume[inner] == FETUS) & (clipped == 0)
    assert lost.mean() < 0.002
    vertices, _ = result.surface()
    middle = vertices[np.abs(vertices[:, :2] - 31.5).max(axis=1) < 16]
    index = np.rint(middle[:, ::-1]).astype(int)
    assert np.mean(volume[tuple(index.T)] == FLUID) > 0.97


def test_a_turned_camera_sees_what_lies_there() -> None:
    """Against SciPy's own resampling, at the same grid."""
    from scipy.ndimage import affine_transform

    volume = layers((40, 36, 32))
    camera = smartvis.look(volume.shape, (1, 1.5, 2), (0.3, -0.2, 1))
    # From voxel indices (x, y, z) of the volume to those of the camera: both grids have one middle.
    matrix = camera.rotation * np.array(camera.source_spacing) / np.array(camera.spacing)[:, None]
    middle, own = ((np.array(shape[::-1]) - 1.0) / 2.0 for shape in (volume.shape, camera.shape))
    offset = own - matrix @ middle
    back = np.linalg.inv(matrix)
    theirs = affine_transform(volume, back[::-1, ::-1], (-back @ offset)[::-1], camera.shape, order=1)
    inside = affine_transform(np.ones(volume.shape), back[::-1, ::-1], (-back @ offset)[::-1], camera.shape, order=1)
    assert np.abs(camera.see(volume).astype(int) - theirs)[inside > 0.999].mean() < 1.0
    x, y, z = camera.to_volume_mm(np.array([0.0, 0.0, 0.0]))
    assert np.allclose(matrix @ (np.array([x, y, z]) / camera.source_spacing) + offset, 0, atol=1e-9)


def test_rotations_of_scipy_and_matrices_agree() -> None:
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_euler("xy", [10, 20], degrees=True)
    ours = smartvis.look((8, 8, 8), (1, 1, 1), turn).rotation
    assert np.allclose(ours, smartvis.look((8, 8, 8), (1, 1, 1), turn.as_matrix().T).rotation)
    assert np.allclose(ours[2], turn.apply([0, 0, 1]))


def test_scanned_ranges_masks_and_auto_agree(volume: np.ndarray) -> None:
    fan = volume.copy()
    fan[:5] = 0
    fan[58:] = 0
    first, end = np.full((56, 56), 5), np.full((56, 56), 58)
    by_maps = smartvis.clip(fan, (1, 1, 1), scanned=(first, end), method="wall")
    by_mask = smartvis.clip(fan, (1, 1, 1), scanned=fan > 0, method="wall")
    by_itself = smartvis.clip(fan, (1, 1, 1), scanned="auto", method="wall")
    assert by_maps.clips
    assert np.array_equal(by_maps.depth, by_mask.depth) and np.array_equal(by_maps.depth, by_itself.depth)
    by_numpy = smartvis.clip(np.ma.masked_equal(fan, 0), (1, 1, 1), method="wall")
    part = np.arange(fan.size).reshape(fan.shape) == 60 * 56 * 56
    for mask in (False, part):  # beside what a mask hides, zeros count as without one
        assert np.array_equal(smartvis.clip(np.ma.array(fan, mask=mask), (1, 1, 1)).depth, by_maps.depth)
    lost = np.where(fan > 0, fan, np.nan) / 200
    by_nan = smartvis.clip(lost, (1, 1, 1), window=(0, 255 / 200), method="wall")
    assert np.array_equal(by_numpy.depth, by_maps.depth) and np.array_equal(by_nan.depth, by_maps.depth)
    everything = smartvis.clip(fan, (1, 1, 1), scanned="all", method="wall")
    assert not np.array_equal(everything.depth, by_maps.depth)


@pytest.mark.parametrize(
    ("keywords", "words"),
    [
        ({"method": "guess"}, "method='guess' is none of mean,"),
        *(({"keep": [mark]}, "keep=") for mark in ((1, 2), (1, 2, 3, 0), (1, 2, 3, 4, 5), (1, np.nan, 3))),
        ({"view": "anterior"}, "view='anterior': an array does not say how the patient lies"),
        ({"view": "above"}, "view='above' is none of probe, anterior"),
        ({"knob": 1}, "no parameter 'knob'"),
        ({"q": "half"}, "q='half' is not a number"),
        ({"spacing": (1, 1)}, "spacing=(1, 1)"),
        *(({"spacing": wrong}, f"spacing={wrong}, expected (x, y, z): mm between voxels") for wrong in (0.5, "mm")),
        ({"window": 5}, "window=5, expected two finite numbers"),
        ({"keep": 5}, "keep=5, expected a list of (x, y, z)"),
        ({"remove": [5]}, "remove=[5], expected a list of (x, y, z)"),
        *(({"lowres": wrong}, f"lowres={wrong}, expected a whole number of pixels") for wrong in (1.5, -1)),
        ({"q": None}, "q=None is not a number"),
        ({"spacing": (1, 0, 1)}, "spacing=(1, 0, 1)"),
        ({"spacing": (1, 1e308, 1)}, "spacing=(1, 1e+308, 1)"),
        ({"scanned": (np.full((56, 56), np.nan), np.full((56, 56), 64))}, "scanned is nan at [0, 0]"),
        ({"view": (0, 0, 0)}, "is no direction"),
        ({"view": np.diag([1, 1, -1])}, "mirror image"),
        ({"view": [1, 2, 3, 4]}, "neither a direction"),
        ({"probe": "above"}, "probe='above' is none of -z, +z"),
        ({"scanned": "fan"}, "scanned='fan'"),
        ({"scanned": np.ones((2, 2, 2), bool)}, "scanned has shape (2, 2, 2)"),
        ({"scanned": (np.ones((2, 2)), np.ones((2, 2)))}, "scanned maps of (2, 2)"),
        ({"window": (5, 5)}, "window=(5, 5), expected two finite numbers, the lower first"),
        ({"window": (np.nan, 5)}, "window=(nan, 5), expected two finite numbers"),
        ({"window": (1, 2, 3)}, "window=(1, 2, 3), expected two finite numbers"),
    ],
)
def test_wrong_values_are_named(volume: np.ndarray, keywords: dict, words: str) -> None:
    with pytest.raises(ValueError, match=re.escape(words)):
        smartvis.clip(volume, **({"spacing": (1, 1, 1)} | keywords))


def test_what_is_doubted_is_said_in_python(volume: np.ndarray) -> None:
    fan = smartvis.scene("D01", size=64)
    for result, said in (
        (smartvis.clip(volume, (10, 10, 10)), "spacing=(x, y, z) says it (mm)"),
        (smartvis.clip(volume), "spacing=(x, y, z) says it (mm)"),
        (smartvis.clip(fan.full, fan.spacing, probe="+z"), "is the probe there? probe='-z'"),
    ):
        assert said in result.doubt and "--" not in repr(result) + result.doubt


@pytest.mark.parametrize("fill", [256, -1, 0.5, np.nan])
def test_a_fill_that_the_type_cannot_hold_is_named(volume: np.ndarray, fill: float) -> None:
    result = smartvis.clip(volume, spacing=(1, 1, 1), method="wall")
    with pytest.raises(ValueError, match=f"fill={fill}, expected a value of uint8"):
        result.apply(volume, fill=fill)


def test_volumes_that_are_none_are_refused() -> None:
    with pytest.raises(ValueError, match=r"shape \(4, 4\)"):
        smartvis.clip(np.zeros((4, 4), np.uint8))
    with pytest.raises(ValueError, match="complex"):
        smartvis.clip(np.zeros((4, 4, 4), complex))
    with pytest.raises(ValueError, match="no voxel of it was scanned"):
        smartvis.clip(np.full((4, 5, 6), np.nan))
    with pytest.raises(ValueError, match="give a window"):
        smartvis.clip(np.array([-1.7e308, 1.7e308] * 32).reshape(4, 4, 4))


# Where x, y and z of the array lead in the patient: between his axes; and a left-handed scan.
DIRECTIONS = [(0.6, 0, 0.8, 0, -1, 0, 0.8, 0, -0.6), (-1, 0, 0, 0, 0, 1, 0, -1, 0)]


@pytest.mark.parametrize("place", ["probe", "anterior", "posterior", "left", "right", "superior", "inferior"])
@pytest.mark.parametrize("directions", DIRECTIONS)
def test_places_around_the_patient_are_those_of_the_host(tmp_path, volume, place: str, directions: tuple) -> None:
    """The host's maps lie in the patient with the axes of its camera."""
    image = sitk.GetImageFromArray(volume)
    image.SetDirection(directions)
    image.SetSpacing((1, 1, 1))
    sitk.WriteImage(image, str(tmp_path / "v.mha"))
    result = smartvis.clip(image, view=place, method="wall")
    in_patient = np.array(directions, float).reshape(3, 3) @ result.camera.rotation.T
    few = ["--frames", 1, "--setting", "smartvis", "--picture", 64, "--few-pictures", "--out", tmp_path]
    host_sim("run", "--volume", tmp_path / "v.mha", "--view", place, "--write", "depthmap", *few)
    theirs = np.array(sitk.ReadImage(str(tmp_path / "depthmap.mha")).GetDirection()).reshape(3, 3)
    assert np.allclose(in_patient, theirs, atol=1e-6)
