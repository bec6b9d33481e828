#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""slicer_nodes.py MODULES SMARTVIS, in an empty folder: 3D Slicer's libraries (slicer-core) load SmartVis' module from a
folder, run it on a scan, and read its results; those lie on the scan, and are what `smartvis clip` writes of it. The
parser of descriptions has no Python of its own: it is called by its names in the library."""

import ctypes
import subprocess
import sys
from importlib import metadata
from pathlib import Path

import numpy as np
import slicer_core
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonMath import vtkMatrix4x4

LIBRARIES = Path(slicer_core.__file__).parent
SHAPE = (64, 56, 48)  # slices, height, width
# Where the scan's x, y, z lead, in mm a voxel, and its first voxel: left, back, head. No axis is another's.
AXES = np.array([[0.0, -0.6, 0.0], [0.4, 0.0, -0.42], [0.3, 0.0, 0.56]])
ORIGIN = np.array([5.0, -6.0, 7.0])
FETUS = 0.6  # of the depth: it begins there or deeper


def scan() -> np.ndarray:
    """Skin, fluid, fetus, tilted a little."""
    z, _, x = np.mgrid[tuple(slice(n) for n in SHAPE)]
    at = z / SHAPE[0] - 0.1 * x / SHAPE[2]
    return np.where(at < 0.2, 100, np.where(at < FETUS, 10, 200)).astype(np.uint8)


def write_scan(path: Path) -> None:
    vectors = " ".join("({},{},{})".format(*AXES[:, axis]) for axis in range(3))
    lines = ["NRRD0005", "type: uint8", "dimension: 3", "space: left-posterior-superior"]
    lines += ["sizes: {2} {1} {0}".format(*SHAPE), f"space directions: {vectors}", "kinds: domain domain domain"]
    lines += ["encoding: raw", "space origin: ({},{},{})".format(*ORIGIN), "", ""]
    path.write_bytes("\n".join(lines).encode() + scan().tobytes())


class Description:
    """A module's, as Slicer's parser reads it."""

    def __init__(self, xml: str, program: str) -> None:
        self._library = ctypes.CDLL(str(next(LIBRARIES.glob("**/libModuleDescriptionParser.so"))))
        self._texts = ctypes.CDLL("libstdc++.so.6")
        self.memory = ctypes.create_string_buffer(1 << 16)
        self._library._ZN17ModuleDescriptionC1Ev(self.memory)
        parser = ctypes.create_string_buffer(1 << 12)
        parse = self._library._ZN23ModuleDescriptionParser5ParseERKSsR17ModuleDescription
        if parse(parser, self._text(xml), self.memory) != 0:
            sys.exit("Slicer's parser refuses the description")
        for setter, text in (("7SetType", "CommandLineModule"), ("9SetTarget", program), ("11SetLocation", program)):
            self._library[f"_ZN17ModuleDescription{setter}ERKSs"](self.memory, self._text(text))

    def _text(self, text: str) -> ctypes.Array:
        """A std::string as these libraries have it."""
        made = ctypes.create_string_buffer(64)
        self._texts._ZNSsC1EPKcRKSaIcE(made, text.encode(), ctypes.create_string_buffer(8))
        return made

    def node(self) -> object:
        """A node of the module, as the form has one."""
        node = slicer_core.vtkMRMLCommandLineModuleNode()
        library = ctypes.CDLL(str(LIBRARIES / "libMRMLCLI.so"))
        address = ctypes.c_void_p(int(node.__this__.split("_")[1], 16))
        library._ZN28vtkMRMLCommandLineModuleNode20SetModuleDescriptionERK17ModuleDescription(address, self.memory)
        return node


class Slicer:
    """Its scene and its logic, without a window."""

    def __init__(self, temporary: Path) -> None:
        self.scene = slicer_core.vtkMRMLScene()
        self.temporary = temporary
        self._application = slicer_core.vtkSlicerApplicationLogic()
        self._application.SetTemporaryPath(str(temporary))
        self._application.SetMRMLScene(self.scene)
        self._logic = slicer_core.vtkSlicerCLIModuleLogic()
        self._logic.SetMRMLScene(self.scene)
        self._logic.SetMRMLApplicationLogic(self._application)
        self._logic.DeleteTemporaryFilesOff()

    def add(self, kind: str, path: Path | None = None) -> object:
        """A node of this class; of a file that its own storage node reads."""
        node = getattr(slicer_core, f"vtkMRML{kind}Node")()
        self.scene.AddNode(node)
        if path is not None:
            self.read(node, path)
        return node

    def read(self, node: object, path: Path) -> None:
        storage = node.CreateDefaultStorageNode()
        storage.SetFileName(str(path))
        self.scene.AddNode(storage)
        if not storage.ReadData(node):
            sys.exit(f"Slicer does not read {path}")

    def run(self, node: object) -> str:
        """Runs the module, as Apply does; its status."""
        self.scene.AddNode(node)
        self._logic.ApplyAndWait(node, False)
        return node.GetStatusString()

    def read_what_came(self, nodes: dict[str, object]) -> None:
        """Into the nodes, whose files are called by their letters; Slicer makes digits letters."""
        for node in nodes.values():
            called = "".join(chr(ord(c) + 17) if c.isdigit() else c for c in node.GetID())
            (path,) = self.temporary.glob(f"*_{called}.*")
            self.read(node, path)


def voxels(node: object) -> np.ndarray:
    image = node.GetImageData()
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(image.GetDimensions()[::-1])


def place(node: object) -> np.ndarray:
    """From voxels to left, back, head."""
    made = vtkMatrix4x4()
    node.GetIJKToRASMatrix(made)
    values = np.array([[made.GetElement(i, j) for j in range(4)] for i in range(4)])
    return np.diag([-1.0, -1.0, 1.0, 1.0]) @ values


def corners(node: object) -> np.ndarray:
    return vtk_to_numpy(node.GetPolyData().GetPoints().GetData()).astype(float)


checked = 0


def holds(what: str, is_so: bool) -> None:
    global checked
    checked += 1
    if not is_so:
        sys.exit(f"does not hold: {what}")


KINDS = {"clipped": "ScalarVolume", "segmentation": "LabelMapVolume", "model": "Model", "depthmap": "ScalarVolume"}
FILES = {"clipped": "clipped.nrrd", "segmentation": "mask.nrrd", "model": "mesh.ply", "depthmap": "depth.nrrd"}


def applied(slicer: Slicer, node: object, given: object) -> dict[str, object]:
    """What comes of the scan when all results are chosen."""
    made = {name: slicer.add(kind) for name, kind in KINDS.items()}
    holds("the title", node.GetModuleTitle() == "SmartVis")
    node.SetParameterAsNode("scan", given)
    for name, result in made.items():
        node.SetParameterAsNode(name, result)
    node.SetParameterAsString("probe", "-z")
    holds("it ran", slicer.run(node) == "Completed" and node.GetErrorText() == "")
    holds("no progress is left in what it printed", "OK" in node.GetOutputText() and "<" not in node.GetOutputText())
    (back,) = slicer.temporary.glob("*.params")
    holds("its words are read", node.ReadParameterFile(str(back)))
    holds("the outcome comes back", node.GetParameterAsString("outcome").startswith("OK, "))
    holds("the beams come back", node.GetParameterAsString("beams") == "parallel, from -z")
    slicer.read_what_came(made)
    return made


def same_as_clip(slicer: Slicer, made: dict[str, object], smartvis: str) -> None:
    command = [smartvis, "clip", "scan.nrrd", "--probe", "-z", "--out", ".", "--write", "clipped,mask,depth,mesh"]
    subprocess.run(command, check=True)
    own = {name: slicer.add(KINDS[name], Path.cwd() / f"scan_{file}") for name, file in FILES.items()}
    for name in ("clipped", "segmentation", "depthmap"):
        holds(f"{name} is that of smartvis clip", np.array_equal(voxels(made[name]), voxels(own[name])))
        holds(f"{name} lies where that lies", np.allclose(place(made[name]), place(own[name]), atol=1e-4))
    holds("the model is that of smartvis clip", np.allclose(corners(made["model"]), corners(own["model"]), atol=1e-3))


def lie_on_the_scan(made: dict[str, object], stated: np.ndarray) -> None:
    kept = voxels(made["segmentation"]) == 1
    holds("something is cut away, and something is kept", 0.2 < kept.mean() < 0.8)
    holds("what is cut away is black", np.array_equal(voxels(made["clipped"]), np.where(kept, scan(), 0)))
    for name in ("clipped", "segmentation"):
        holds(f"{name} lies on the scan", np.allclose(place(made[name]), stated, atol=1e-5))
    middle = [(n - 1) / 2 for n in voxels(made["depthmap"]).shape[:0:-1]]
    front = stated @ ((SHAPE[2] - 1) / 2, (SHAPE[1] - 1) / 2, 0, 1)
    holds("the depthmap lies on the front", np.allclose(place(made["depthmap"]) @ (*middle, 0, 1), front, atol=0.5))
    model = corners(made["model"]) * (-1, -1, 1)
    at = np.linalg.inv(stated) @ np.column_stack([model, np.ones(len(model))]).T
    holds("the model is the fetus", at[2].min() > FETUS * SHAPE[0] - 2 and at[2].max() < SHAPE[0] + 1)


def an_error_is_told(slicer: Slicer, node: object, given: object) -> None:
    node.SetParameterAsNode("scan", given)
    node.SetParameterAsNode("clipped", slicer.add("ScalarVolume"))
    node.SetParameterAsString("view", "from above")
    holds("an error is one to Slicer", slicer.run(node) == "Completed with errors")
    said = [line for line in node.GetErrorText().splitlines() if line]
    holds(f"and is one sentence: {said}", len(said) == 1 and "'from above', expected" in said[0])


def main(modules: Path, smartvis: str) -> None:
    (temporary := Path.cwd() / "temporary").mkdir()
    write_scan(path := Path.cwd() / "scan.nrrd")
    description = Description((modules / "SmartVis.xml").read_text(), str(modules / "SmartVis"))
    slicer = Slicer(temporary)
    given = slicer.add("ScalarVolume", path)
    stated = np.vstack([np.column_stack([AXES, ORIGIN]), [0, 0, 0, 1]])
    holds("the scan lies where it says", np.allclose(place(given), stated, atol=1e-6))
    made = applied(slicer, description.node(), given)
    same_as_clip(slicer, made, smartvis)
    lie_on_the_scan(made, stated)
    an_error_is_told(slicer, description.node(), given)
    print(f"slicer-core {metadata.version('slicer-core')}: {checked} checks hold")


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2])
