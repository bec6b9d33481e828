# SPDX-License-Identifier: MIT
"""A result in a notebook, as files, in an image's world, and as a quick look of whatever was clipped."""

import base64
import re
from pathlib import Path

import numpy as np
import pytest
import SimpleITK as sitk
from conftest import layers

import smartvis
from smartvis import _images
from smartvis._errors import OutputError

LEFT_HANDED = (-1, 0, 0, 0, 0, 1, 0, -1, 0)


def image_of(volume: np.ndarray, directions: tuple = (0, 0, 1, 1, 0, 0, 0, 1, 0)) -> sitk.Image:
    image = sitk.GetImageFromArray(volume)
    image.SetSpacing((0.8, 0.9, 1.1))
    image.SetOrigin((10, -20, 30))
    image.SetDirection(directions)
    return image


def test_a_notebook_shows_picture_depth_and_reason(volume: np.ndarray, monkeypatch: pytest.MonkeyPatch) -> None:
    for size, result in ((256, smartvis.clip(volume, (1, 1, 1))), (None, smartvis.clip(volume * 0 + 9, (10, 10, 10)))):
        if size is None:  # without a host
            monkeypatch.setenv("SMARTVIS_HOST_SIM", "/nowhere/host_sim")
        html = result._repr_html_()
        png = base64.b64decode(re.findall(r'src="data:image/png;base64,([^"]+)"', html)[0])
        assert png[:8] == b"\x89PNG\r\n\x1a\n"
        said = re.findall("<figcaption>(.*)</figcaption>", html)[0]
        assert result.outcome.name in said and f"{100 * (result.depth > 0).mean():.0f} % clipped" in said
        assert (" mm deep" in said) == result.clips and (result.clips or "560 mm" in said or "640 mm" in said)


def test_a_png_of_pixels_is_that(tmp_path: Path, volume: np.ndarray) -> None:
    result = smartvis.clip(volume, (1, 1, 1))
    assert result.save(tmp_path / "look.png") == [tmp_path / "look.png"]
    there = sitk.GetArrayFromImage(sitk.ReadImage(str(tmp_path / "look.png")))
    assert np.array_equal(there, smartvis.quick_look(volume, result))


@pytest.mark.parametrize("of", ["array", "image"])
def test_what_is_saved_is_the_result(tmp_path: Path, of: str) -> None:
    voxels = layers((40, 36, 32)).astype(np.int16) - 50
    given = image_of(voxels) if of == "image" else voxels
    result = smartvis.clip(given, None if of == "image" else (0.8, 0.9, 1.1))
    (path,) = result.save(tmp_path / "clipped.nrrd")
    there = sitk.ReadImage(str(path))
    assert np.array_equal(sitk.GetArrayFromImage(there), result.apply(voxels))
    assert there.GetSpacing() == pytest.approx((0.8, 0.9, 1.1))
    assert there.GetOrigin() == pytest.approx((10, -20, 30) if of == "image" else (0, 0, 0))
    with np.load(result.save(tmp_path / "maps.npz")[0]) as maps:
        assert all(np.array_equal(maps[name], getattr(result, name)) for name in ("depth", "depth_mm", "status"))
    names = [path.name for path in result.save(tmp_path / "all")]
    assert names == ["result_clipped.nrrd", "result_depth.nrrd", "result_mesh.ply", "result_look.png"]
    assert all((tmp_path / "all" / name).stat().st_size > 100 for name in names)
    assert result.save(str(tmp_path / "mesh.ply"))[0].read_bytes() == (tmp_path / "all" / names[2]).read_bytes()


@pytest.mark.parametrize("name", ["result.foo", "result.jpg", "result.vol"])
def test_no_volume_is_written_as_what_cannot_hold_it(tmp_path: Path, volume: np.ndarray, name: str) -> None:
    words = f"{name}: no volume is written by this suffix, but by .nrrd "
    with pytest.raises(OutputError, match=re.escape(words)):
        smartvis.clip(volume, (1, 1, 1)).save(tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_an_unknown_spacing_stays_unknown(tmp_path: Path, volume: np.ndarray) -> None:
    (path,) = smartvis.clip(volume).save(tmp_path / "clipped.nrrd")
    assert not smartvis.clip(path).spacing_known


def looks_at_the_camera(vertices: np.ndarray, faces: np.ndarray, forward: np.ndarray) -> bool:
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    return bool((np.cross(b - a, c - a) @ forward < 0).all())


@pytest.mark.parametrize("directions", [(0, 0, 1, 1, 0, 0, 0, 1, 0), LEFT_HANDED])
def test_the_surface_of_an_image_lies_in_its_world(directions: tuple) -> None:
    voxels = layers((40, 36, 32))
    image = image_of(voxels, directions)
    result = smartvis.clip(image, view=(0.1, 0, 1))
    vertices, faces = result.surface()
    plain, plain_faces = smartvis.clip(voxels, image.GetSpacing(), view=(0.1, 0, 1)).surface()
    world = [image.TransformContinuousIndexToPhysicalPoint((at / image.GetSpacing()).tolist()) for at in plain]
    assert len(vertices) > 500 and np.allclose(vertices, world)
    forward = np.array(directions, float).reshape(3, 3) @ result.camera.rotation[2]
    assert looks_at_the_camera(vertices, faces, forward) and faces.shape == plain_faces.shape
    seen = smartvis.clip(image, view="anterior").camera  # along left-handed axes its own are left-handed, too
    mesh = seen.surface(np.full(seen.shape[1:], seen.shape[0] / 2, np.float32), directions)
    forward = np.array(directions, float).reshape(3, 3) @ seen.rotation[2]
    assert len(mesh[1]) > 500 and looks_at_the_camera(*mesh, forward)


def test_a_quick_look_takes_what_clip_took(tmp_path: Path) -> None:
    voxels = layers((40, 36, 32))
    image = image_of(voxels)
    sitk.WriteImage(image, str(tmp_path / "v.nrrd"))
    result = smartvis.clip(image)
    expected = smartvis.quick_look(voxels, result)
    for volume in (image, tmp_path / "v.nrrd", np.ma.masked_less(voxels, 0), None):
        assert np.array_equal(smartvis.quick_look(volume, result), expected)
    numbers = voxels.astype(np.float32) * 3 - 100
    window = smartvis.clip(numbers, image.GetSpacing(), window=(-100, 665))
    assert np.array_equal(smartvis.quick_look(numbers, window), expected)
    with pytest.raises(ValueError, match=r"volume has shape \(39, 36, 32\), what was clipped had \(40, 36, 32\)"):
        smartvis.quick_look(voxels[1:], result)


def test_the_voxels_of_an_image_outlive_it() -> None:
    voxels = layers((40, 36, 32))
    views = [_images.array(image_of(voxels)) for _ in range(20)]
    others = [np.full(voxels.shape, n, np.uint8) for n in range(20)]
    assert all(np.array_equal(view, voxels) for view in views) and len(others) == 20
    assert not views[0].flags.writeable
