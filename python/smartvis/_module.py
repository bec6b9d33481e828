# SPDX-License-Identifier: MIT
"""What the command-line module says of itself, in the XML of the Slicer execution model: 3D Slicer, MITK and others
make a form of it. The order of elements is that of CTK's schema, which MITK insists on; Slicer takes any."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from ._plugin import Parameter
from ._seen import SIDES
from ._version import __version__
from ._view import PLACES

TITLE = "SmartVis"
_WHAT = (
    "Removes what hides the fetus in 3D ultrasound: every voxel before a surface in the amniotic fluid. In doubt it "
    "removes nothing, and says why. For research, and not a medical device."
)


@dataclass(frozen=True)
class Item:
    """A field of the form."""

    tag: str
    name: str
    label: str
    description: str
    default: str = ""
    channel: str = ""
    by: str = "longflag"  #: how it is passed: by a flag of its name, by "index", or "" for what comes back
    limits: tuple[float, float, float] | None = None  #: the smallest value, the largest, and a step
    elements: tuple[str, ...] = ()
    attributes: Mapping[str, str] = field(default_factory=dict)


SCAN = Item("image", "scan", "Scan", "The volume: one of a sequence", channel="input", by="index")

#: What is written where it is asked for, with the product of `smartvis clip` that it is.
RESULTS = {
    "clipped": Item("image", "clipped", "Clipped volume", "The scan without what hides the fetus", channel="output"),
    "mask": Item(
        "image",
        "segmentation",
        "Segmentation",
        "A label map: 1 where a voxel is kept, 0 where it is cut away",
        channel="output",
        attributes={"type": "label"},
    ),
    "mesh": Item(
        "geometry",
        "model",
        "Model",
        "The surface of the tissue that is left",
        channel="output",
        attributes={"type": "model", "fileExtensions": ".ply"},
    ),
    "depth": Item(
        "image",
        "depthmap",
        "Depthmap",
        "How deep it is cut along each ray, in mm: one slice on the front of the scan",
        channel="output",
    ),
}

_PROBE = Item(
    "string-enumeration",
    "probe",
    "Probe",
    "The side of the volume at which the probe was (--probe): -z is the first slice. auto: as the scan says, else the "
    "first slice, and that is told",
    default="auto",
    elements=("auto", *SIDES),
)
_VIEW = Item(
    "string-enumeration",
    "view",
    "View",
    "From where the fetus is to be seen (--view): from the probe, or from a place around the patient",
    default=PLACES[0],
    elements=PLACES,
)
_MORE = (
    Item(
        "double-vector",
        "direction",
        "Looks along",
        "X,Y,Z in the axes of the volume, instead of View; empty: as View says",
    ),
    Item(
        "double-vector",
        "spacing",
        "Spacing",
        "X,Y,Z in mm, where that of the scan is wrong (--spacing); empty: as it is",
    ),
    Item(
        "double-vector",
        "window",
        "Window",
        "LOW,HIGH: the values that are seen as black and white (--window); empty: the range of the scan",
    ),
    Item(
        "string-enumeration",
        "scanned",
        "Scanned",
        "What the probe scanned (--scanned). auto: all but the zeros, or the other constant, outside a fan; zeros: all "
        "but zeros; all: everything",
        default="auto",
        elements=("auto", "zeros", "all"),
    ),
    Item(
        "double-vector",
        "level",
        "Tissue of the model",
        "The grey value at which it begins (--level); empty: Otsu's threshold",
    ),
)


_BACK: dict[str, Any] = {"channel": "output", "by": ""}
#: What comes back in words.
SAID = (
    Item("string", "outcome", "Outcome", "Whether there is a surface, and how much is cut away", **_BACK),
    Item("string", "beams", "Beams", "How they ran, from which side, and how sure that is", **_BACK),
    Item("string", "note", "Note", "Why nothing is cut away, or what is doubted or assumed", **_BACK),
)


def of_plugin(parameter: Parameter) -> Item:
    """A parameter of the plugin. Its flag is its key."""
    said = (parameter.key, parameter.label, parameter.help)
    if parameter.choices:
        return Item("string-enumeration", *said, default=str(parameter.default), elements=parameter.choices)
    if parameter.type == "bool":  # a flag of the model's own could only say yes
        return Item("integer-enumeration", *said, default=str(int(parameter.default)), elements=("0", "1"))
    tag = "integer" if parameter.type == "int" else "double"
    limits = (parameter.minimum, parameter.maximum, parameter.step or 1.0)
    return Item(tag, *said, default=str(parameter.default), limits=limits)


def groups(parameters: Iterable[Parameter]) -> dict[str, tuple[str, list[Item]]]:
    """The form: what is said of each group, and its fields. What only experts turn is left to `--set`."""
    usual = [p for p in parameters if not p.expert]
    first = [of_plugin(p) for p in usual if p.primary or p.key == "method"]
    later = [of_plugin(p) for p in usual if not (p.primary or p.key == "method")]
    return {
        "Scan and results": ("A result that is not chosen is not made.", [SCAN, *RESULTS.values()]),
        "Clipping": ("No setting is needed.", [*first, _PROBE, _VIEW]),
        "Advanced": ("Where the scan is unusual, and how the surface is found.", [*_MORE, *later]),
    }


def describe(parameters: Iterable[Parameter], for_slicer: bool = False) -> str:
    """The XML. `for_slicer`: with fields for what comes back. Slicer wants them without any index; to CTK that is an
    error, and its own way, the index 1000, is one to Slicer."""
    root = ET.Element("executable")
    facts = {
        "category": "Ultrasound",
        "title": TITLE,
        "description": _WHAT,
        "version": __version__,
        "license": "MIT",
        "contributor": "The SmartVis project",
    }
    for name, text in facts.items():
        ET.SubElement(root, name).text = text
    all_groups = groups(parameters)
    if for_slicer:
        all_groups["What came of it"] = ("Said when it is done.", list(SAID))
    for label, (description, items) in all_groups.items():
        group = ET.SubElement(root, "parameters", {"advanced": "true"} if label == "Advanced" else {})
        ET.SubElement(group, "label").text = label
        ET.SubElement(group, "description").text = description
        for item in items:
            _add(group, item)
    ET.indent(root)
    return f'<?xml version="1.0" encoding="utf-8"?>\n{ET.tostring(root, encoding="us-ascii").decode()}\n'


def _add(group: ET.Element, item: Item) -> None:
    made = ET.SubElement(group, item.tag, dict(item.attributes))
    said = [("name", item.name)]
    said += [(item.by, {"longflag": item.name, "index": "0"}[item.by])] if item.by else []
    said += [("description", item.description), ("label", item.label)]
    said += [("default", item.default)] if item.default else []
    said += [("channel", item.channel)] if item.channel else []
    said += [("element", element) for element in item.elements]
    for name, text in said:
        ET.SubElement(made, name).text = text
    if item.limits is not None:
        limits = ET.SubElement(made, "constraints")
        for name, value in zip(("minimum", "maximum", "step"), item.limits, strict=True):
            ET.SubElement(limits, name).text = f"{value:g}"
