# SPDX-License-Identifier: MIT
"""Exceptions. Every one carries the plugin's own reason, word for word, where there is one."""

import importlib
from typing import Any

from . import _abi, _runtime

_NAMES = {value: name for name, value in _abi.NUMBERS.items() if name.startswith("SV_ERR_")}

_OF_OPENCL = ("SV_ERR_NO_DEVICE", "SV_ERR_BUILD", "SV_ERR_OPENCL")


class SmartVisError(Exception):
    """Base of all exceptions of this package."""


class LoadError(SmartVisError):
    """A file is no SmartVis plugin, or of another ABI version."""


class PluginError(SmartVisError):
    """A call of the plugin failed.

    ``status`` is the number of smartvis_plugin.h, ``name`` its name there, ``reason`` what the plugin says. Where
    OpenCL is missing, the message names a command that brings it.
    """

    def __init__(self, call: str, status: int, reason: str) -> None:
        self.call = call
        self.status = status
        self.name = _NAMES.get(status, f"status {status}")
        self.reason = reason
        said = (reason or "the plugin gives no reason") + _runtime.mend(status, reason)
        super().__init__(f"{said} ({call}: {self.name})")

    def __reduce__(self) -> tuple[type, tuple[str, int, str]]:
        return type(self), (self.call, self.status, self.reason)


class HostError(SmartVisError):
    """``host_sim`` is not there, or failed. ``code`` is its exit code, or None if it did not run."""

    def __init__(self, message: str, code: int | None = None) -> None:
        self.code = code
        super().__init__(message)


class DeviceError(HostError):
    """OpenCL is missing, or failed, in ``host_sim`` or before the plugin."""


class FileError(SmartVisError):
    """A file cannot be read as a volume, or a result cannot be written; the message names it."""


class OutputError(FileError):
    """A result cannot be written."""


class MissingExtraError(SmartVisError, ImportError):
    """A package that only some functions need is not installed."""

    def __init__(self, package: str, extra: str, what: str) -> None:
        super().__init__(f"{what} needs {package}: pip install 'smartvis[{extra}]'")


def state_of(error: Exception) -> str:
    """What failed, as a row's state and the exit code of the same name tell it."""
    if isinstance(error, MemoryError):
        return "memory"
    if isinstance(error, DeviceError) or (isinstance(error, PluginError) and error.name in _OF_OPENCL):
        return "device"
    if isinstance(error, (PluginError, LoadError)):
        return "plugin"
    return "output" if isinstance(error, OutputError) else "input"


def extra_module(name: str, package: str, extra: str, what: str = "this") -> Any:
    """A module of a package that only some functions need; MissingExtraError: it is not installed."""
    try:
        return importlib.import_module(name)
    except ImportError:
        raise MissingExtraError(package, extra, what) from None
