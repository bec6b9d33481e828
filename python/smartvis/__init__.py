# SPDX-License-Identifier: MIT
"""SmartVis: removes what hides the fetus in 3D ultrasound.

>>> import numpy as np
>>> volume = np.zeros((32, 32, 32), np.uint8)
>>> clip(volume, spacing=(1, 1, 1)).outcome
<Outcome.NO_SURFACE: 1>
"""

from ._clip import Clipper, ClipperCache, clip
from ._errors import HostError, LoadError, MissingExtraError, PluginError, SmartVisError
from ._plugin import Parameter, Plugin, load, parameters
from ._products import quick_look
from ._result import Outcome, Result, Statistics
from ._scene import CASES, Measures, Scene, mean_error, measure, measure_many, rank, scene
from ._version import __commit__ as __commit__
from ._version import __version__ as __version__
from ._view import Camera, look
from ._volume import to_uint8

__all__ = [
    "CASES", "Camera", "Clipper", "ClipperCache", "HostError", "LoadError", "Measures", "MissingExtraError", "Outcome",
    "Parameter", "Plugin", "PluginError", "Result", "Scene", "SmartVisError", "Statistics", "clip", "load", "look",
    "mean_error", "measure", "measure_many", "parameters", "quick_look", "rank", "scene", "to_uint8"
]  # fmt: skip
