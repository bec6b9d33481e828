# SPDX-License-Identifier: MIT
"""Loading a library, what its plugins are, and their parameters."""

from __future__ import annotations

import ctypes
import logging
import os
import threading
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from . import _abi, _places, _runtime
from ._errors import LoadError, PluginError
from ._text import plain
from ._version import __version__

log = logging.getLogger("smartvis.plugin")

_LEVELS = {_abi.SV_LOG_DEBUG: logging.DEBUG, _abi.SV_LOG_INFO: logging.INFO, _abi.SV_LOG_WARNING: logging.WARNING}
_MOST_TEXT = 512
_MOST_CHOICES = 256
_MOST_PARAMETERS = 4096
_MOST_PLUGINS = 64


def _text(value: bytes | None) -> str:
    return (value or b"").decode("utf-8", "replace")


_said = threading.local()  # `error`: the last that a plugin has logged as such, on this thread


@_abi.LOG  # type: ignore[untyped-decorator]
def _on_log(_host: object, severity: int, text: bytes) -> None:
    if severity >= _abi.SV_LOG_ERROR:
        _said.error = _text(text)
    log.log(_LEVELS.get(severity, logging.ERROR), "%s", plain(_text(text)))


# What the package offers to plugins: the same for all instances, and alive as long as the process.
_host: Any = _abi.sized(
    _abi.sv_host, abi_minor=_abi.SV_ABI_MINOR, name=b"smartvis for Python", version=__version__.encode(), log=_on_log
)


@dataclass(frozen=True)
class Parameter:
    """What a plugin says about one of its parameters."""

    key: str
    label: str
    unit: str
    help: str
    group: str
    type: str  #: "float", "int", "bool" or "enum"
    default: float | int | bool | str  #: of an enum: the name of the value
    minimum: float
    maximum: float
    display: tuple[float, float]  #: what a slider should span
    step: float
    choices: tuple[str, ...]  #: the names of an enum's values, else empty
    numbers: tuple[float, ...] = field(repr=False)  #: the values themselves, which need not follow one another
    primary: bool  #: the one that every user sees
    expert: bool
    fixed: bool  #: read at activation only: a Clipper takes it when it is made
    adjustable: bool  #: Clipper.adjust takes it
    id: int = field(repr=False)

    def encode(self, value: object) -> float:
        """The number that crosses to the plugin. Ranges are the plugin's to check.

        >>> parameters()["q"].encode(0.5)
        0.5
        >>> parameters()["method"].encode("mean")
        0.0
        """
        if isinstance(value, str):
            if value in self.choices:
                return self.numbers[self.choices.index(value)]
            if self.choices:
                raise ValueError(f"{self.key}='{value}' is none of {', '.join(self.choices)}")
        try:
            return float(value)  # type: ignore[arg-type]
        except (TypeError, ValueError):
            raise ValueError(f"{self.key}={value!r} is not a number") from None


class Plugin:
    """One plugin of a library: what it is, what it can do, its parameters."""

    def __init__(self, library: ctypes.CDLL, path: str, entry: Any, index: int) -> None:
        pointer = entry.descriptor(index)
        if not pointer:
            raise LoadError(f"{path}: the library says that it has {entry.count} plugins, but not number {index}")
        d = pointer.contents
        if d.size < ctypes.sizeof(_abi.sv_descriptor):
            raise LoadError(f"{path}: the descriptor has {d.size} bytes")
        self._library = library  # stays loaded as long as any plugin of it is known
        self._entry = entry
        self.path = path
        self.id = _text(d.id)
        self.name = _text(d.name)
        self.version = _text(d.version)
        self.summary = _text(d.summary)
        self.features: int = d.features
        self.queues: int = d.queues
        self._parameters: dict[str, Parameter] | None = None

    def __repr__(self) -> str:
        return f"<Plugin {self.id} {self.version} of {self.path}>"

    def create(self) -> ctypes._Pointer[Any]:
        """A new instance; whoever asks destroys it."""
        _runtime.check_process()
        instance: ctypes._Pointer[Any] = _abi.SELF()
        _said.error = ""
        status = self._entry.create(ctypes.byref(_host), self.id.encode(), ctypes.byref(instance))
        if status != _abi.SV_OK or not instance:
            reason = _said.error or "gives no instance"  # there is nobody yet to ask for last_error
            raise PluginError("create", status, f"{self.path}: '{self.id}': {reason}")
        if instance.contents.size < ctypes.sizeof(_abi.sv_plugin):
            raise LoadError(f"{self.path}: the instance has {instance.contents.size} bytes")
        for name, *_ in _abi.sv_plugin._fields_[4:]:
            if not getattr(instance.contents, name):
                raise LoadError(f"{self.path}: the instance's {name} is NULL")
        return instance

    @property
    def parameters(self) -> Mapping[str, Parameter]:
        """Parameters by key, in the plugin's own order, which is that of importance."""
        if self._parameters is None:
            instance = self.create()
            try:
                self._parameters = {p.key: p for p in _read_parameters(instance)}
            finally:
                instance.contents.destroy(instance)
        return self._parameters

    def check(self, values: Mapping[str, object]) -> None:
        """ValueError names a value that the plugin will refuse: out of its range, between its steps, or NaN."""
        ids = {p.id: p for p in self.parameters.values()}
        for number, value in self.encode(values).items():
            p = ids[number]
            steps = (value - p.minimum) / p.step if p.type != "float" and p.step > 0 else 0.0
            if not (p.minimum <= value <= p.maximum) or steps != round(steps):
                raise ValueError(f"{p.key}={value:g} is not in {p.minimum:g} .. {p.maximum:g}")

    def encode(self, values: Mapping[str, object]) -> dict[int, float]:
        """Values by key as numbers by id; ValueError names a key that the plugin does not have."""
        known = self.parameters
        for key in values:
            if key not in known:
                raise ValueError(f"{self.id} has no parameter '{key}'; it has {', '.join(known)}")
        return {known[key].id: known[key].encode(value) for key, value in values.items()}


def _read_parameters(instance: ctypes._Pointer[Any]) -> list[Parameter]:
    found = []
    for index in range(min(instance.contents.param_count(instance), _MOST_PARAMETERS)):
        info = _abi.sized(_abi.sv_param_info)
        status = instance.contents.param_info(instance, index, ctypes.byref(info))
        if status != _abi.SV_OK:
            raise PluginError("param_info", status, f"parameter {index} is not told")
        found.append(_describe(instance, info))
    return found


def _describe(instance: ctypes._Pointer[Any], info: Any) -> Parameter:
    kind = ("float", "int", "bool", "enum")[info.type] if info.type < 4 else "float"
    default: float | int | bool | str = info.default_value
    texts: dict[float, str] = {}
    if kind == "enum":
        step = info.step or 1.0
        steps = (info.max_value - info.min_value) / step
        count = min(int(steps + 1.5), _MOST_CHOICES) if 0 <= steps < _MOST_CHOICES else 0
        values = (info.min_value + n * step for n in range(count))
        texts = {v: text for v in values if (text := _value_text(instance, info.id, v)) is not None}
        default = texts.get(info.default_value, f"{info.default_value:g}")
    elif kind == "bool":
        default = bool(default)
    elif kind == "int":
        default = int(default)
    return Parameter(
        **{name: _text(getattr(info, name)) for name in ("key", "label", "unit", "help", "group")},
        type=kind,
        default=default,
        minimum=info.min_value,
        maximum=info.max_value,
        display=(info.display_min, info.display_max),
        step=info.step,
        choices=tuple(texts.values()),
        numbers=tuple(texts),
        primary=bool(info.flags & _abi.SV_PARAM_PRIMARY),
        expert=bool(info.flags & _abi.SV_PARAM_EXPERT),
        fixed=bool(info.flags & _abi.SV_PARAM_REACTIVATE),
        adjustable=bool(info.flags & _abi.SV_PARAM_ADJUST),
        id=info.id,
    )


def _value_text(instance: ctypes._Pointer[Any], param_id: int, value: float) -> str | None:
    out = ctypes.create_string_buffer(_MOST_TEXT)
    status = instance.contents.param_text(instance, param_id, value, out, _MOST_TEXT - 1)
    return _text(out.value) if status == _abi.SV_OK else None


def default_path() -> str:
    """The plugin of this package, or the file that ``SMARTVIS_PLUGIN`` names."""
    return os.environ.get("SMARTVIS_PLUGIN") or str(_places.find(f"smartvis{_runtime.LIBRARY}"))


def load(path: str | os.PathLike[str] | None = None, id: str | None = None) -> Plugin:
    """Loads a plugin library and returns one of its plugins, the first if `id` names none.

    Without a path it is the plugin of this package. LoadError says what is wrong with a file. A library runs
    in this process and stays loaded: load only what you trust.

    >>> load().id
    'org.smartvis.clip'
    """
    plugins = _open(str(os.path.abspath(path)) if path is not None else default_path())
    for plugin in plugins:
        if id is None or plugin.id == id:
            return plugin
    raise LoadError(f"{plugins[0].path}: no plugin '{id}'; there are {', '.join(p.id for p in plugins)}")


@cache
def _open(path: str) -> tuple[Plugin, ...]:
    if not os.path.exists(path):
        raise LoadError(f"{path}: no such file")
    _runtime.use_one()
    try:
        library = ctypes.CDLL(path)
        entry = _abi.sv_entry.in_dll(library, _abi.SV_ENTRY_SYMBOL)
    except (OSError, ValueError) as error:
        loader = " (sudo apt-get install ocl-icd-libopencl1)" if "libOpenCL.so" in str(error) else ""
        if _runtime.WINDOWS and isinstance(error, OSError):  # which does not say what is missing
            loader = _runtime.mend(_abi.SV_ERR_NO_DEVICE, "")
        raise LoadError(f"{path}: {error}{loader}") from None
    if entry.abi_major != _abi.SV_ABI_MAJOR:
        raise LoadError(f"{path}: made for ABI {entry.abi_major}, this package knows {_abi.SV_ABI_MAJOR}")
    if entry.size < ctypes.sizeof(_abi.sv_entry) or entry.count < 1 or not (entry.descriptor and entry.create):
        raise LoadError(f"{path}: the entry is not whole: {entry.size} bytes, {entry.count} plugins")
    return tuple(Plugin(library, path, entry, index) for index in range(min(entry.count, _MOST_PLUGINS)))


def parameters(plugin: Plugin | None = None) -> Mapping[str, Parameter]:
    """A plugin's parameters by key, in the order of importance.

    >>> first = next(p for p in parameters().values() if p.primary)
    >>> first.key, first.type
    ('q', 'float')
    """
    return (plugin or load()).parameters
