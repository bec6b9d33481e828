# SPDX-License-Identifier: MIT
"""What names and headers hold acts on no terminal, whichever door shows it."""

import re
from pathlib import Path

import pytest
import SimpleITK as sitk
from conftest import layers

from smartvis.cli import main


def test_names_act_on_no_terminal(tmp_path: Path, capsys) -> None:
    """ESC and BEL, in a name and in a header's field that is told."""
    folder = tmp_path / "study" / "\x1b]0;title\x07"
    folder.mkdir(parents=True)
    good = folder / "good\x1b[2J.nrrd"
    sitk.WriteImage(sitk.GetImageFromArray(layers((40, 36, 36))), str(good))
    header = "NRRD0005\ntype: uchar\ndimension: 3\nsizes: 4 4 4\nencoding: raw\nspacings: 1\x1b[31m 1 1\x07,5\n\n"
    (folder / "bad\x9b.nrrd").write_text(header)
    out = tmp_path / "out"
    assert main(["clip", str(good), str(folder / "bad\x9b.nrrd"), "--out", str(out)]) == 3
    assert main(["batch", str(folder), "--out", str(out), "--workers", "1"]) == 1
    with pytest.raises(SystemExit):
        main(["clip", str(good), "--\x1b[2J"])
    told = "".join(capsys.readouterr())
    assert "good\\x1b[2J.nrrd" in told and "bad\\xc2\\x9b" not in told
    for text in (told, (out / "table.csv").read_text(), (out / "index.html").read_text()):
        assert "good\\x1b[2J.nrrd" in text and not re.search("[\x00-\x09\x0b-\x1f\x7f-\x9f]", text), text
