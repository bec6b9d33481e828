#!/bin/bash
# SPDX-License-Identifier: MIT
# Guess: a command-line module that gives a text back (its outcome) says so in one way for all: CTK's schema, which MITK checks modules
# by, wants a flag or an index of every parameter, and for what comes back the index 1000. Slicer, which the model comes from, reads that.
# Found: Slicer takes the index for that of an argument, and does not start the program, since the argument has no value. It wants
# neither flag nor index, which the schema calls an error, and ctk-cli a parameter that cannot be passed.
# A description for both has nothing that comes back. Whoever wants it in Slicer says it in a file of XML beside the program, which
# CTK does not read.
work=$(mktemp -d)
# shellcheck source=findings/common.bash
. "$(dirname "$0")/common.bash"
packages slicer-core==5.13.31053.0 ctk-cli==1.5 numpy==2.4.6
seen 'index 1000: ctk-cli: 1 comes back, 0 complaints; Slicer: Idle, No value assigned to "Outcome"
no index:   ctk-cli: 1 comes back, 1 complaints; Slicer: Completed,' << 'PYTHON'
import ctypes, logging, os
from pathlib import Path
import ctk_cli, slicer_core
from vtkmodules.vtkCommonCore import vtkFileOutputWindow, vtkOutputWindow

TEXT = """<?xml version="1.0" encoding="utf-8"?>
<executable><title>Tells</title><description>Tells</description><parameters><label>All</label><description>All</description>
<string><name>outcome</name>{}<description>What came of it</description><label>Outcome</label><channel>output</channel></string>
</parameters></executable>"""
window = vtkFileOutputWindow()  # for what Slicer says of every step
window.SetFileName("said.txt")
vtkOutputWindow.SetInstance(window)
complaints = []
logging.getLogger("ctk_cli.module").addFilter(lambda record: bool(complaints.append(record)))
libraries = Path(slicer_core.__file__).parent
parser = ctypes.CDLL(str(next(libraries.glob("**/libModuleDescriptionParser.so"))))  # it has no Python of its own
texts, nodes = ctypes.CDLL("libstdc++.so.6"), ctypes.CDLL(str(libraries / "libMRMLCLI.so"))

def text(words):
    made = ctypes.create_string_buffer(64)
    texts._ZNSsC1EPKcRKSaIcE(made, words.encode(), ctypes.create_string_buffer(8))
    return made

def described(xml, program):
    memory, this = ctypes.create_string_buffer(1 << 16), ctypes.create_string_buffer(1 << 12)
    parser._ZN17ModuleDescriptionC1Ev(memory)
    assert parser._ZN23ModuleDescriptionParser5ParseERKSsR17ModuleDescription(this, text(xml), memory) == 0
    for setter, words in (("7SetType", "CommandLineModule"), ("9SetTarget", program), ("11SetLocation", program)):
        parser[f"_ZN17ModuleDescription{setter}ERKSs"](memory, text(words))
    node = slicer_core.vtkMRMLCommandLineModuleNode()
    address = ctypes.c_void_p(int(node.__this__.split("_")[1], 16))
    nodes._ZN28vtkMRMLCommandLineModuleNode20SetModuleDescriptionERK17ModuleDescription(address, memory)
    return node

scene, application = slicer_core.vtkMRMLScene(), slicer_core.vtkSlicerApplicationLogic()
application.SetTemporaryPath(os.getcwd())
application.SetMRMLScene(scene)
logic = slicer_core.vtkSlicerCLIModuleLogic()
logic.SetMRMLScene(scene)
logic.SetMRMLApplicationLogic(application)
for what, passed in (("index 1000:", "<index>1000</index>"), ("no index:  ", "")):
    complaints.clear()
    Path("tells.xml").write_text(TEXT.format(passed))
    outputs = ctk_cli.CLIModule("tells.xml").classifyParameters()[2]
    node = described(TEXT.format(passed), "/bin/true")
    scene.AddNode(node)
    logic.ApplyAndWait(node, False)
    slicer = f"{node.GetStatusString()}, {node.GetErrorText()}".rstrip()
    print(f"{what} ctk-cli: {len(outputs)} comes back, {len(complaints)} complaints; Slicer: {slicer}")
PYTHON
