# SPDX-License-Identifier: MIT
"""What tests share. SV_SOURCE_DIR and SV_BUILD_DIR are the repository and its build folder."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
import SimpleITK as sitk

import smartvis

SOURCE = Path(os.environ["SV_SOURCE_DIR"])
BUILD = Path(os.environ["SV_BUILD_DIR"])
os.environ.setdefault("SMARTVIS_HOST_SIM", str(BUILD / "host_sim"))

LONG = 800  #: seconds that only what hangs takes, however busy the machine; CTest ends a test after 1500

SKIN, FLUID, FETUS = 100, 10, 200


def layers(shape: tuple[int, int, int], near: float = 0.2, far: float = 0.6) -> np.ndarray:
    """Skin, fluid, fetus; the fluid is slices near .. far of the depth, tilted a little along x."""
    slices, height, width = shape
    z, _, x = np.mgrid[:slices, :height, :width]
    tilt = x / width * 0.1 * slices
    volume = np.full(shape, FETUS, np.uint8)
    volume[z < far * slices + tilt] = FLUID
    volume[z < near * slices + tilt] = SKIN
    return volume


def host_sim(*arguments: object) -> None:
    """Runs host_sim, which must succeed."""
    subprocess.run([str(BUILD / "host_sim"), *map(str, arguments)], check=True, capture_output=True, timeout=LONG)


def host(*arguments: object) -> tuple[int, str]:
    ended = subprocess.run(
        [str(BUILD / "host_sim"), *map(str, arguments)], capture_output=True, text=True, timeout=LONG, check=False
    )
    return ended.returncode, ended.stdout + ended.stderr


def write_dicom(folder: Path, image: sitk.Image, series: str = "1.2.3.4", step: float = 0.0) -> list[Path]:
    """A DICOM series of the image's slices in its place; file names run against their order. The rear half lies `step`
    mm further behind."""
    folder.mkdir(exist_ok=True)
    writer = sitk.ImageFileWriter()
    writer.KeepOriginalImageUIDOn()
    direction = np.array(image.GetDirection()).reshape(3, 3)
    files = []
    for z in range(image.GetSize()[2]):
        place = image.TransformIndexToPhysicalPoint((0, 0, z)) + step * direction[:, 2] * (2 * z >= image.GetSize()[2])
        tags = {"0008|0060": "OT", "0020|000e": series, "0008|0018": f"{series}.{z}", "0020|0013": str(z),
                "0020|0032": "\\".join(f"{p:.8g}" for p in place),
                "0020|0037": "\\".join(f"{d:g}" for d in (*direction[:, 0], *direction[:, 1]))}  # fmt: skip
        slice_ = image[:, :, z]
        for tag, value in tags.items():
            slice_.SetMetaData(tag, value)
        files.append(folder / f"{series}_{999 - z}.dcm")
        writer.SetFileName(str(files[-1]))
        writer.Execute(slice_)
    return files


@pytest.fixture
def volume() -> np.ndarray:
    """Its cross-section is a square: at 1 mm the machine's grid is the volume's own."""
    return layers((64, 56, 56))


@pytest.fixture(scope="session")
def d01() -> smartvis.Scene:
    return smartvis.scene("D01", size=96)
