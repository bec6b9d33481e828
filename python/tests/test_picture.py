# SPDX-License-Identifier: MIT
"""Pictures of a result: those that host_sim draws of the same volume with its own run of the plugin."""

import numpy as np
import pytest
import SimpleITK as sitk
from conftest import host_sim

import smartvis
from smartvis import HostError


def pixels(png: bytes, folder) -> np.ndarray:
    (folder / "read.png").write_bytes(png)
    return sitk.GetArrayFromImage(sitk.ReadImage(str(folder / "read.png"))).astype(int)


def test_a_picture_is_the_one_of_the_host(d01: smartvis.Scene, tmp_path) -> None:
    host_sim("scenes", "D01", "--size", 96, "--export", "--out", tmp_path)
    how = ["--lowres", 96, "--frames", 1, "--setting", "smartvis", "--picture", 256, "--out", tmp_path]
    host_sim("run", "--volume", tmp_path / "D01_full.mha", *how)
    for kind in ("result", "full", "depthmap"):
        ours = pixels(d01.clip().picture(kind=kind, size=256).png, tmp_path)
        theirs = pixels((tmp_path / f"{kind}.png").read_bytes(), tmp_path)
        if kind == "depthmap":  # its title names the plugin
            ours, theirs = ours[60:], theirs[60:]
        assert ours.shape == theirs.shape and theirs.std() > 10
        assert np.abs(ours - theirs).max() <= 2  # depths come by millimetres, in float32


def test_a_turned_and_oblong_volume_is_drawn_where_it_was_clipped(d01: smartvis.Scene, tmp_path) -> None:
    """What the host renders of the full volume with our map is what it renders of the volume that we clipped."""
    part = d01.full[:, 10:80, :60].astype(np.int16)
    for view in (None, (0, 0.2, 1)):
        result = smartvis.clip(part, d01.spacing, view=view, window=(0, 255), scanned=part > 0)
        ours = pixels(result.picture(kind="result", size=256).png, tmp_path)
        clipped = np.where(result.mask() | (part == 0), part, 1)
        nothing = smartvis.clip(np.zeros_like(part) + 9, d01.spacing, view=view, window=(0, 255))
        assert not nothing.clips
        theirs = pixels(nothing.picture(clipped, kind="full", size=256).png, tmp_path)
        full = pixels(result.picture(kind="full", size=256).png, tmp_path)
        near, far = (np.abs(other - ours).mean() for other in (theirs, full))
        assert near < 0.35 * far, (near, far)


def test_a_picture_is_png_for_notebooks_and_files(d01: smartvis.Scene, tmp_path, monkeypatch, capsys) -> None:
    opened: list[str] = []

    def never(link: str) -> bool:
        opened.append(link)
        return False

    monkeypatch.setattr("webbrowser.open", never)
    result = d01.clip()
    picture = result.picture(kind="slices", size=128)
    result.show(kind="slices", size=128)
    assert picture._repr_png_() == picture.save(tmp_path / "p.png").read_bytes()
    height, width, _ = pixels(picture.png, tmp_path).shape
    assert repr(picture) == f"<Picture of {width} x {height} pixels>" and width > 4 * 128
    assert len(opened) == 1 and opened[0].startswith("file:///")
    assert opened[0].removeprefix("file://") in capsys.readouterr().out  # nothing opened it: where it is


def test_what_cannot_be_drawn_is_told(d01: smartvis.Scene, monkeypatch) -> None:
    result = d01.clip()
    with pytest.raises(ValueError, match="kind='photo' is none of panel, slices"):
        result.picture(kind="photo")
    with pytest.raises(ValueError, match="volume has shape"):
        result.picture(d01.full[1:])
    monkeypatch.setenv("SMARTVIS_HOST_SIM", "/nowhere/host_sim")
    with pytest.raises(HostError, match="SMARTVIS_HOST_SIM=/nowhere/host_sim.*smartvis.quick_look"):
        result.picture()


def test_a_result_is_one_line(volume: np.ndarray) -> None:
    result = smartvis.clip(volume, spacing=(0.5, 0.5, 0.8), method="wall")
    mean = result.depth_mm[result.depth > 0].mean()
    share = 100 * np.mean(result.depth > 0)
    assert repr(result) == f"<Result OK: 28 x 28 rays of 51 slices, {share:.0f} % clipped, {mean:.1f} mm deep>"
    assert "voxels deep" in repr(smartvis.clip(volume, method="wall"))
    blank = smartvis.clip(np.full((32, 32, 32), 150, np.uint8))
    assert repr(blank).startswith("<Result NO_SURFACE: 32 x 32 rays of 32 slices, 0 % clipped; Too little was scanned")
    assert "\n" not in repr(blank)
