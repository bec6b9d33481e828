# SPDX-License-Identifier: MIT
"""The command-line module of 3D Slicer and MITK: what it says of itself, how ctk-cli runs it, what becomes of its
results, and what it says when something is wrong."""

import os
import re
import stat
import subprocess
import sys
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import ctk_cli
import numpy as np
import pytest
import SimpleITK as sitk
from conftest import LONG, layers
from ctk_cli.execution import popenCLIExecutable

import smartvis
from smartvis import _module, _runtime
from smartvis._products import depth_image
from smartvis.slicer import main

PROGRAM = str(Path(sys.executable).with_name("smartvis-slicer"))
RESULTS = {"clipped": ".nrrd", "segmentation": ".nrrd", "model": ".ply", "depthmap": ".nrrd"}


@pytest.fixture(scope="module")
def scan(tmp_path_factory) -> Path:
    """Turned, shifted, and with another distance along each axis."""
    image = sitk.GetImageFromArray(layers((64, 56, 56)))
    image.SetSpacing((0.5, 0.6, 0.7))
    image.SetOrigin((5, -6, 7))
    image.SetDirection((0, 1, 0, -1, 0, 0, 0, 0, 1))
    sitk.WriteImage(image, str(path := tmp_path_factory.mktemp("scan") / "scan & <1>.nrrd"))
    return path


@pytest.fixture(scope="module")
def description() -> str:
    said = subprocess.run([PROGRAM, "--xml"], check=True, capture_output=True, text=True, timeout=LONG)
    assert said.stderr == ""
    return said.stdout


# What CTK's schema (ctkCmdLineModule.xsd) wants, in our own words: MITK loads nothing else. Patterns of elements, each
# with a blank behind it.
EXECUTABLE = (
    "(category )?title description (version )?(documentation-url )?(license )?(contributor )?(acknowledgements )?"
    "(parameters )+"
)
PARAMETER = "name (flag (longflag )?|longflag |index )description label (default )?(channel )?"
SCALAR, VECTOR, CHOICE = ("integer", "float", "double"), "-vector", "-enumeration"
ATTRIBUTES = {
    "image": {"type": {"scalar", "label", "tensor", "diffusion-weighted", "vector", "model"}, "fileExtensions": None},
    "geometry": {"type": {"fiberbundle", "model"}, "fileExtensions": None},
}


def in_order(element: ET.Element, pattern: str) -> bool:
    return re.fullmatch(pattern, "".join(f"{child.tag} " for child in element)) is not None


def faults(root: ET.Element) -> Iterator[str]:
    if root.tag != "executable" or not in_order(root, EXECUTABLE):
        yield "executable"
    names = []
    for group in root.findall("parameters"):
        if [child.tag for child in group][:2] != ["label", "description"] or len(group) < 3:
            yield "parameters"
        if group.attrib not in ({}, {"advanced": "true"}):
            yield f"attributes {group.attrib}"
        for item in list(group)[2:]:
            yield from faults_of(item)
            names.append(item.findtext("name", ""))
    if len(set(names)) != len(names):
        yield "a name twice"


def faults_of(item: ET.Element) -> Iterator[str]:
    name = item.findtext("name", "")
    has_limits = item.tag in SCALAR or (item.tag.endswith(VECTOR) and item.tag != "string-vector")
    more = "(constraints )?" if has_limits else "(element )+" if item.tag.endswith(CHOICE) else ""
    if not in_order(item, PARAMETER + more):
        yield f"{name}: {[child.tag for child in item]}"
    if not re.fullmatch("[_a-zA-Z][_a-zA-Z0-9]*", name):
        yield f"{name}: is no name"
    if not re.fullmatch("-?-?[_a-zA-Z][_a-zA-Z0-9]*", item.findtext("longflag", "x")):
        yield f"{name}: is no flag"
    if item.findtext("channel", "input") not in ("input", "output"):
        yield f"{name}: no channel"
    for key, value in item.attrib.items():
        allowed = ATTRIBUTES.get(item.tag, {}).get(key, set())
        if allowed is not None and value not in allowed:
            yield f"{name}: {key}={value}"
    elements = [element.text for element in item.findall("element")]
    if elements and item.findtext("default") not in elements:
        yield f"{name}: its default is none of its values"
    limits = item.find("constraints")
    if limits is not None:
        low, high, step = (float(limits.findtext(part, "nan")) for part in ("minimum", "maximum", "step"))
        if not (low <= float(item.findtext("default", "nan")) <= high and step > 0):
            yield f"{name}: limits"


def test_the_description_is_as_ctk_and_mitk_want_it(description: str) -> None:
    assert description.startswith("<?xml")  # Slicer wants nothing before that
    root = ET.fromstring(description)
    assert list(faults(root)) == []
    assert [group.findtext("label") for group in root.findall("parameters")] == [
        "Scan and results", "Clipping", "Advanced"]  # fmt: skip
    for item in root.iter("image"):  # the rules find what is wrong
        item.insert(0, item[-1])
    assert any("scan" in fault for fault in faults(root))


def test_every_usual_parameter_of_the_plugin_is_a_field(description: str) -> None:
    root = ET.fromstring(description)
    for key, parameter in smartvis.parameters().items():
        items = [i for group in root.findall("parameters") for i in group if i.findtext("name") == key]
        assert len(items) == (not parameter.expert), key
        for item in items:
            assert item.findtext("label") == parameter.label and item.findtext("description") == parameter.help
            assert parameter.encode(item.findtext("default")) == pytest.approx(parameter.encode(parameter.default))


def test_a_switch_can_be_turned_both_ways() -> None:
    facts: dict[str, Any] = {
        "key": "drop",
        "label": "Drop",
        "unit": "",
        "help": "?",
        "group": "",
        "type": "bool",
        "default": True,
    }
    facts |= {"minimum": 0, "maximum": 1, "display": (0, 1), "step": 1, "choices": (), "numbers": (), "primary": False}
    item = _module.of_plugin(smartvis.Parameter(**facts, expert=False, fixed=False, adjustable=False, id=1))
    assert (item.tag, item.elements, item.default) == ("integer-enumeration", ("0", "1"), "1")


def command_of(module: ctk_cli.CLIModule, given: dict[str, str]) -> list[str]:
    """The command as a program builds it that has the form: every field with a value, and its default else."""
    arguments, options, outputs = module.classifyParameters()
    assert [a.name for a in arguments] == ["scan"] and not outputs
    command = [module.path]
    for option in options:
        value = given.get(option.name, option.default)
        if value is not None:
            command += [option.longflag, str(value)]
    return [*command, given["scan"]]


def progress_in(output: str) -> list[float]:
    """From what CTK reads of the output, which must be XML."""
    root = ET.fromstring(f"<module-root>{output}</module-root>")
    assert [e.tag for e in root].count("filter-start") == [e.tag for e in root].count("filter-end")
    return [float(e.text or "nan") for e in root.findall("filter-progress")]


def test_ctk_cli_runs_it_and_results_lie_on_the_scan(tmp_path: Path, scan: Path, caplog) -> None:
    """With the default of every field given it is what `smartvis.clip` finds, to the bit."""
    module = ctk_cli.CLIModule(PROGRAM)
    assert module.title == "SmartVis" and not caplog.records
    files = {name: str(tmp_path / f"{name}{suffix}") for name, suffix in RESULTS.items()}
    command = command_of(module, {"scan": str(scan)} | files)
    with popenCLIExecutable(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        output, errors = process.communicate(timeout=LONG)
    assert process.returncode == 0 and errors == ""
    progress = progress_in(output)
    assert progress == sorted(progress) and progress[0] == 0 and progress[-1] == 1 and len(set(progress)) == 7
    assert ", OK, " in output and "assumed" in output  # at which side the probe was

    image = sitk.ReadImage(str(scan))
    expected = smartvis.clip(image)
    made = {name: sitk.ReadImage(files[name]) for name in RESULTS if name != "model"}
    assert np.array_equal(sitk.GetArrayFromImage(made["clipped"]), sitk.GetArrayFromImage(expected.apply(image)))
    assert np.array_equal(sitk.GetArrayFromImage(made["segmentation"]), expected.mask())
    assert np.array_equal(sitk.GetArrayFromImage(made["depthmap"])[0], expected.depth_mm)
    for name, there in (("clipped", image), ("segmentation", image), ("depthmap", depth_image(image, expected))):
        for get in ("GetSpacing", "GetOrigin", "GetDirection"):
            assert np.allclose(getattr(made[name], get)(), getattr(there, get)(), atol=1e-5), (name, get)
    assert b"\ncomment SPACE=LPS UNIT=mm\n" in Path(files["model"]).read_bytes()[:300]


def test_fields_reach_the_plugin(tmp_path: Path, scan: Path, capsys) -> None:
    depth, said = tmp_path / "depth.nrrd", tmp_path / "said.params"
    more = ["--q", "0.2", "--direction", "-0.1,0,1", "--spacing", "0.6,0.6,0.7", "--probe", "-z"]
    assert main([*more, "--depthmap", str(depth), "--returnparameterfile", str(said), str(scan)]) == 0
    image = sitk.ReadImage(str(scan))
    image.SetSpacing((0.6, 0.6, 0.7))
    expected = smartvis.clip(image, view=(-0.1, 0, 1), probe="-z", q=0.2)
    assert np.array_equal(sitk.GetArrayFromImage(sitk.ReadImage(str(depth)))[0], expected.depth_mm)
    lines = said.read_text().splitlines()
    assert [line.split(" = ")[0] for line in lines] == ["outcome", "beams", "note"]
    assert lines[0].startswith("outcome = OK, ") and lines[1] == f"beams = {expected.beams}"


def test_why_nothing_is_clipped_is_said(tmp_path: Path, capsys) -> None:
    """Not as an error: the results are there, with nothing cut away."""
    image = sitk.GetImageFromArray(np.full((48, 48, 48), 120, np.uint8))
    sitk.WriteImage(image, str(scan := tmp_path / "solid.nrrd"))
    files = ["--segmentation", str(tmp_path / "kept.nrrd"), "--returnparameterfile", str(tmp_path / "said.params")]
    assert main([*files, str(scan)]) == 0
    said = capsys.readouterr()
    why = re.search(r"Why: (.*)", said.out)
    assert "NO_SURFACE" in said.out and why is not None and said.err == ""
    assert f"note = {why[1]}" in (tmp_path / "said.params").read_text()
    assert (sitk.GetArrayFromImage(sitk.ReadImage(str(tmp_path / "kept.nrrd"))) == 1).all()


WRONG = {
    "nothing is there": (3, ["--clipped", "{o}/a.nrrd", "{o}/none.nrrd"], r"none\.nrrd: .*no such file"),
    "no scan": (3, ["--clipped", "{o}/a.nrrd", "{o}/text.nrrd"], r"text\.nrrd: "),
    "no scan named": (2, ["--clipped", "{o}/a.nrrd"], "no scan is given"),
    "no result": (2, ["{s}"], "no result is asked for: choose Clipped volume, Segmentation, Model, Depthmap"),
    "no such option": (2, ["--knob", "1", "--clipped", "{o}/a.nrrd", "{s}"], "unrecognized arguments: --knob"),
    "a value out of range": (2, ["--q", "9", "--clipped", "{o}/a.nrrd", "{s}"], "q is 9, expected 0 to 1.5"),
    "no such choice": (2, ["--method", "best", "--clipped", "{o}/a.nrrd", "{s}"], "method='best' is none of mean"),
    "no number": (2, ["--window", "low", "--clipped", "{o}/a.nrrd", "{s}"], "--window: 'low', expected 2 numbers"),
    "no such side": (2, ["--probe", "-w", "--clipped", "{o}/a.nrrd", "{s}"], "--probe: invalid choice: '-w'"),
    "a model of another kind": (2, ["--model", "{o}/a.vtp", "{s}"], r"a\.vtp: models are written as \.ply"),
    "a format of nobody": (6, ["--clipped", "{o}/a.xyz", "{s}"], r"a\.xyz: "),
    "no folder": (6, ["--clipped", "{o}/text.nrrd/a.nrrd", "{s}"], r"a\.nrrd: "),
    "nobody knows the patient": (3, ["--view", "anterior", "--clipped", "{o}/a.nrrd", "{o}/own.nrrd"], "no view ant"),
}


@pytest.mark.parametrize(("code", "words", "sentence"), WRONG.values(), ids=WRONG)
def test_an_error_is_one_sentence_and_a_code(
    tmp_path: Path, scan: Path, code: int, words: list[str], sentence: str, capsys
) -> None:
    (tmp_path / "text.nrrd").write_text("no scan at all\n")
    sitk.WriteImage(sitk.GetImageFromArray(layers((48, 48, 48))), str(tmp_path / "own.nrrd"))
    ended = main([word.format(o=tmp_path, s=scan) for word in words])
    said = capsys.readouterr()
    assert ended == code and re.search(sentence, said.err) and len(said.err.splitlines()) == 1, said.err
    assert 1.0 not in progress_in(said.out)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["own.nrrd", "text.nrrd"]


def test_a_sequence_is_refused(tmp_path: Path, capsys) -> None:
    frames = [sitk.GetImageFromArray(layers((48, 48, 48)))] * 2
    sitk.WriteImage(sitk.JoinSeries(frames), str(tmp_path / "beat.nii"))
    assert main(["--clipped", str(tmp_path / "a.nrrd"), str(tmp_path / "beat.nii")]) == 3
    assert "holds 2 volumes" in capsys.readouterr().err


def test_it_is_put_where_slicer_looks(tmp_path: Path, description: str, monkeypatch, capsys) -> None:
    """Slicer runs it among its own Python and libraries, which would keep another Python from starting."""
    folder = tmp_path / "my modules"
    assert main(["--install", str(folder)]) == 0
    assert str(folder) in capsys.readouterr().out
    program = folder / "SmartVis"  # no dot in it, for it to be taken for a program
    assert sorted(p.name for p in folder.iterdir()) == ["SmartVis", "SmartVis.xml"]
    assert stat.S_IMODE(program.stat().st_mode) == 0o755
    (tmp_path / "numpy.py").write_text("raise SystemExit('of Slicer')\n")
    for name in ("PYTHONHOME", "PYTHONPATH", "LD_LIBRARY_PATH"):
        monkeypatch.setenv(name, str(tmp_path))
    own = subprocess.run([PROGRAM, "--xml"], check=False, capture_output=True, text=True, timeout=LONG)
    assert own.returncode != 0
    said = subprocess.run([program, "--xml"], check=True, capture_output=True, text=True, timeout=LONG, cwd=tmp_path)
    assert said.stdout == description

    beside, before = (ET.fromstring(text) for text in ((folder / "SmartVis.xml").read_text(), description))
    *same, back = beside.findall("parameters")
    assert [ET.tostring(g).strip() for g in same] == [ET.tostring(g).strip() for g in before.findall("parameters")]
    for item in list(back)[2:]:  # for Slicer an index would be an argument, and a missing one an error
        assert item.tag == "string" and item.findtext("channel") == "output"
        assert item.find("index") is None and item.find("longflag") is None


def test_it_is_put_there_on_windows(tmp_path: Path, monkeypatch, capsys) -> None:
    monkeypatch.setattr(_runtime, "WINDOWS", True)
    monkeypatch.setenv("PYTHONHOME", r"C:\Own")
    monkeypatch.setattr("smartvis._process.python", lambda: r"C:\My Python\python.exe")
    assert main(["--install", str(tmp_path)]) == 0
    lines = (tmp_path / "SmartVis.bat").read_bytes().decode().split("\r\n")
    assert r"set PYTHONHOME=C:\Own" in lines and "set LD_LIBRARY_PATH=" + os.environ.get("LD_LIBRARY_PATH", "") in lines
    assert lines[-2] == r'"C:\My Python\python.exe" -P -m smartvis.slicer %*'


def test_a_folder_that_cannot_be_made_is_told(tmp_path: Path, capsys) -> None:
    (tmp_path / "file").write_text("")
    assert main(["--install", str(tmp_path / "file" / "modules")]) == 6
    assert f"{tmp_path / 'file' / 'modules'}: " in capsys.readouterr().err
