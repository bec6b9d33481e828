# SPDX-License-Identifier: MIT
"""table.py FOLDER PAGE [--write]: asks every peer, one in a process, what it reads of ours and writes of the scan, and
ours what it reads of that; prints the table, and compares it with the one in PAGE, or puts it there. Exit code 1: the
page says something else. OURS, PEERS and SLICER are the environments' interpreters."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

HERE = Path(__file__).parent
ALL = (".nrrd", ".mha", ".nii.gz", ".seq.nrrd", "beat.mha")
KINDS = (*ALL, ".ply")
ONLY_READ = ("slicerio", "trimesh", "meshio", "pyigtl")
BEGIN, END = "<!-- printed by make peers -->\n", "<!-- to here -->"

# name on the page, its functions' name, its distribution, kinds of ours that it has a reader for, what is to be said on
# the way
PEERS: list[tuple[str, str, str, tuple[str, ...], str]] = [
    ("3D Slicer (slicer-core)", "slicer", "slicer-core", KINDS,
     "Nodes count in RAS, files in LPS. A sequence as `.seq.nrrd`, by its storage node for volume sequences."),
    ("SimpleITK", "simpleitk", "SimpleITK", ALL,
     "LPS, arrays [z, y, x]. `.seq.nrrd`: the volumes are a voxel's components."),
    ("ITK", "itk", "itk", ALL, "LPS. `imread` has no type for two volumes in a voxel: take `.mha` for a sequence."),
    ("itkwasm", "itkwasm", "itkwasm-image-io", (".nrrd", ".mha", ".nii.gz", "beat.mha"), "LPS. A sequence as `.mha`."),
    ("nibabel", "nibabel", "nibabel", (".nii.gz",), "RAS, arrays [x, y, z]: hand `dataobj` over transposed."),
    ("pynrrd", "pynrrd", "pynrrd", (".nrrd", ".seq.nrrd"),
     "Arrays [x, y, z]; `space` says LPS, a row of `space directions` is an axis."),
    ("slicerio", "slicerio", "slicerio", (".nrrd", ".seq.nrrd"), "Arrays [x, y, z], `ijkToLPS`."),
    ("MONAI", "monai", "monai", ALL,
     "RAS, arrays [x, y, z], float32. A sequence as `.mha`; writers take `resample=False`."),
    ("TorchIO", "torchio", "torchio", ALL, "RAS, arrays [volume, x, y, z]."),
    ("ANTs (antspyx)", "ants", "antspyx", ALL, "LPS, arrays [x, y, z], float32."),
    ("Convert3D (picsl-c3d)", "c3d", "picsl-c3d", ALL,
     "LPS, float64: `-type uchar` before `-o`. Of a sequence c3d takes one volume, and not its directions: c4d."),
    ("Plastimatch", "plastimatch", "plastimatch", ALL, "LPS. One volume of a sequence, without its directions."),
    ("VTK", "vtk", "vtk", (".nrrd", ".mha", ".nii.gz", ".seq.nrrd", ".ply"),
     "Directions of a NRRD are not read, those of a MetaImage are [transposed](../findings/vtk_metaimage_direction.sh), "
     "read and written. `.nii.gz` with `QFormMatrix` (RAS, from mm) is right. Legacy `.vtk` has no directions."),
    ("PyVista", "pyvista", "pyvista", (".nrrd", ".mha", ".nii.gz", ".seq.nrrd", ".ply"),
     "VTK's readers, without the NIfTI's matrix: meshes from us; volumes by SimpleITK."),
    ("trimesh", "trimesh", "trimesh", (".ply",), "No units: the file's comment says mm, LPS."),
    ("meshio", "meshio", "meshio", (".ply",), "No units: the file's comment says mm, LPS."),
    ("pyigtl", "pyigtl", "pyigtl", ("IMAGE",),
     "To `smartvis serve`. Answers are in the axes and the place that were sent; nobody says whose they are."),
    ("pydicom", "pydicom", "pydicom", (), "A folder is a volume; we write no DICOM."),
    ("highdicom", "highdicom", "highdicom", (), "Neither is a scan: clip the series that they were made of."),
    ("GDCM", "gdcm", "python-gdcm", (), "The folder, not one of its files."),
    ("DCMTK", "dcmtk", "dcmtk", (), "The folder, not one of its files."),
    ("dcm2niix", "dcm2niix", "dcm2niix", (), "It reverses the rows, and says so in the file."),
]  # fmt: skip


def python_of(name: str) -> str:
    return os.environ["SLICER" if name == "slicer" else "PEERS"]


def lines(*command: object) -> list[dict[str, str]]:
    """What a program says, a line of JSON each; the peers' tools are beside their interpreter."""
    path = f"{Path(os.environ['PEERS']).parent}:{os.environ['PATH']}"
    words = [str(word) for word in command]
    ended = subprocess.run(words, stdout=subprocess.PIPE, text=True, check=False, env={**os.environ, "PATH": path})
    if ended.returncode != 0:
        sys.exit(f"peers: {' '.join(words)}: exit code {ended.returncode}")
    return [json.loads(line) for line in ended.stdout.splitlines() if line.startswith("{")]


def version(name: str, distribution: str) -> str:
    if name == "dcmtk":
        said = subprocess.run(["dcmdump", "--version"], capture_output=True, text=True, check=True).stdout
        return said.split()[2].lstrip("v")
    code = f"import importlib.metadata as m; print(m.version({distribution!r}))"
    return subprocess.run([python_of(name), "-c", code], capture_output=True, text=True, check=True).stdout.strip()


def of_theirs(rows: list[dict[str, str]]) -> str:
    """The forms that are right, then those that are not, each with what is said."""
    forms: dict[str, list[str]] = defaultdict(list)
    for row in rows:
        forms[row["said"]].append(f"`{row['form']}`" if row["form"].startswith(".") else row["form"])
    many = {said: ", ".join(forms[said]).replace(", DICOM series,", ",") for said in forms}
    return "<br>".join(f"{many[said]}: {said}" for said in sorted(many, key=lambda said: said != "right"))


def of_again(rows: list[dict[str, str]]) -> str:
    """Whether a peer's file of a result says more of the patient than that did, and what our doors make of the file."""
    said: dict[str, set[str]] = defaultdict(set)
    for row in rows:
        said[row["form"]].add(row["said"])
    forms = ", ".join(f"`{form}`: {' or '.join(sorted(said[form]))}" for form in sorted(said))
    wrong = [f"{row['door']}, `{row['form']}`: {row['right']}" for row in rows if row["right"] != "right"]
    back = f"Back through all {len({row['door'] for row in rows})} doors of ours: {', '.join(wrong) or 'right'}."
    return f"What nobody said of the patient, in its files: {forms}. {back}"


def table(folder: Path) -> str:
    theirs: dict[str, list[dict[str, str]]] = defaultdict(list)
    for _, name, _, kinds, _ in PEERS:
        if name not in ONLY_READ:
            lines(python_of(name), HERE / "write.py", folder, name)
    again: dict[str, list[dict[str, str]]] = defaultdict(list)
    for row in lines(os.environ["OURS"], HERE / "ours.py", "read", folder):
        (again[row["again"]] if "again" in row else theirs[row["peer"]]).append(row)
    head = ["peer", *(f"`{kind}`" for kind in ALL[:-1]), "`.mha`, a sequence", "`.ply`", "we read of it", "to be said"]
    out = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    for title, name, distribution, kinds, note in PEERS:
        said = lines(python_of(name), HERE / "read.py", folder, name, *kinds) if kinds else []
        of_ours = {row["kind"]: row["said"] for row in said}
        theirs[name] += [{"form": kind, "said": of_ours[kind]} for kind in of_ours if kind not in KINDS]
        cells = [of_ours.get(kind, "–") for kind in KINDS]
        note += f"<br>{of_again(again[name])}" if name in again else ""
        cells = [f"{title} {version(name, distribution)}", *cells, of_theirs(theirs[name]) or "–", note]
        out.append("| " + " | ".join(cells) + " |")
    return "\n".join(out) + "\n"


def main() -> int:
    folder, page = Path(sys.argv[1]), Path(sys.argv[2])
    made, text = table(folder), page.read_text()
    print(made, end="")
    begin, end = text.index(BEGIN) + len(BEGIN), text.index(END)
    if "--write" in sys.argv:
        page.write_text(text[:begin] + made + text[end:])
    elif text[begin:end] != made:
        print(f"peers: {page} says something else: look at what changed, then make peers WRITE=1", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
