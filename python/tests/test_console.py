# SPDX-License-Identifier: MIT
"""``smartvis console``: formats that the machine does not read are the same volume in its console."""

import signal
import subprocess
import sys
from urllib.parse import unquote

import numpy as np
import SimpleITK as sitk
from conftest import LONG, SOURCE, host, layers, write_dicom
from makers import two_places
from makers_dicom import far_probe

from smartvis import clip
from smartvis import scene as of_scene
from smartvis.console import volumes

sys.path.insert(0, str(SOURCE / "tests" / "host_sim" / "console"))
from console_client import Address, Page  # type: ignore[import-not-found]


def smartvis(*arguments):
    return subprocess.Popen(
        [sys.executable, "-m", "smartvis", "console", *map(str, arguments)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


def test_formats_are_one_volume(tmp_path):
    image = sitk.GetImageFromArray(layers((40, 32, 24)))
    image.SetSpacing((0.9, 0.7, 1.1))
    for name in ("a.nii.gz", "b.nrrd"):
        sitk.WriteImage(image, str(tmp_path / name))
    write_dicom(tmp_path / "study", image)
    began = smartvis(tmp_path / "a.nii.gz", tmp_path / "b.nrrd", tmp_path / "study")
    try:
        line = began.stdout.readline()
        assert line.startswith("Console  http://127.0.0.1:"), line + began.stderr.read()
        address = Address(line.split()[1])
        page = Page(address, timeout=LONG)
        files = [(one["folder"], one["path"]) for one in page.must("hello")["files"]]
        assert files == [(0, "a.mha"), (0, "b.mha"), (0, "study.mha")] and unquote(address.first) == "file=0:a.mha"
        drawn = []
        for folder, path in files:
            frame = page.show(source={"folder": folder, "path": path, "from": "probe"}, views=["full", "across"])
            assert frame["type"] == "frame", frame
            assert frame["source"]["voxels"] == [24, 32, 40] and frame["source"]["mm"]
            assert np.isclose(frame["source"]["voxel_mm"], 1.1, atol=1e-4)
            drawn.append({view: one[5] for view, one in page.pictures.items()})
        assert drawn[0] == drawn[1] == drawn[2]
        page.close()
        began.send_signal(signal.SIGTERM)
        began.wait(LONG)
        assert began.returncode == 128 + signal.SIGTERM
    finally:
        began.kill()
        began.communicate()


def test_what_a_file_says_of_probe_and_place_is_told(tmp_path):
    """The fan's apex, and which of two places counts."""
    scan = of_scene("D01", size=96).full[::2]
    far_probe(tmp_path / "far.dcm", scan)
    two_places(tmp_path / "two.nii", scan)
    clipped = clip(str(tmp_path / "far.dcm")).beams
    told = {name: (host("info", file)[1], what) for file, name, what in volumes([str(tmp_path / "far.dcm")])}
    assert f"beams: {clipped}\n" in told["far.mha"][0] and told["far.mha"][1] == ""
    began = smartvis(tmp_path / "two.nii")
    try:
        assert began.stdout.readline().startswith("Console  ")
    finally:
        began.terminate()
        said = began.communicate(timeout=LONG)[1]
    assert said.startswith("two.mha: Its qform and its sform disagree, by 30 degrees")


def test_what_is_no_volume_is_told(tmp_path):
    (tmp_path / "x.nii").write_text("no volume")
    began = smartvis(tmp_path / "x.nii")
    said = began.communicate(timeout=LONG)
    assert began.returncode == 3 and "x.nii" in said[1] and said[0] == ""
