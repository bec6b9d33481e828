# SPDX-License-Identifier: MIT
"""Loading a library, what its plugins are, and their parameters."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from . import _abi, _door, _places, _runtime
from ._errors import LoadError, PluginError

_MOST_CHOICES = 256


def _text(value: bytes | None) -> str:
    return (value or b"").decode("utf-8", "replace")


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


def blame(failed: _door.Failed, call: str) -> PluginError:
    """The error of a plugin that failed in a call; `call` is where no other is named."""
    status = failed.status or _abi.SV_ERR_INTERNAL
    return PluginError(failed.call or call, status, failed.reason or failed.text)


def open_clipper(path: str, id: str | None) -> ctypes.c_void_p:
    """The door's clipper of a plugin; whoever asks frees it. LoadError, PluginError."""
    handle = ctypes.c_void_p()
    wanted = None if id is None else id.encode()
    try:
        _door.call("svh_clipper_open", _door.host(), os.fsencode(path), wanted, ctypes.byref(handle))
    except _door.Failed as failed:
        if failed.call != "create":
            raise LoadError(failed.text) from None
        raise PluginError("create", failed.status, failed.text.replace(": create '", ": '", 1)) from None
    return handle


class Plugin:
    """One plugin of a library: what it is, what it can do, its parameters."""

    def __init__(self, path: str, id: str | None) -> None:
        handle = open_clipper(path, id)
        try:
            about = _door.sized("svh_plugin")
            _door.call("svh_clipper_about", handle, ctypes.byref(about))
            self.path = path
            self.id = _text(about.id)
            self.name = _text(about.name)
            self.version = _text(about.version)
            self.summary = _text(about.summary)
            self.features: int = about.features
            self.queues: int = about.queues
            self.guarded = bool(about.guarded)  #: it runs in a process of its own
            self._parameters = {p.key: p for p in _read_parameters(handle, about.parameters)}
        finally:
            _door.free("svh_clipper_free", handle)

    def __repr__(self) -> str:
        return f"<Plugin {self.id} {self.version} of {self.path}>"

    @property
    def parameters(self) -> Mapping[str, Parameter]:
        """Parameters by key, in the plugin's own order, which is that of importance."""
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


def _read_parameters(handle: ctypes.c_void_p, count: int) -> list[Parameter]:
    found = []
    for index in range(count):
        info = _door.sized("svh_param")
        try:
            _door.call("svh_param_at", handle, index, ctypes.byref(info))
        except _door.Failed as failed:
            raise blame(failed, "param_info") from None
        found.append(_describe(handle, info))
    return found


def _describe(handle: ctypes.c_void_p, info: Any) -> Parameter:
    kind = ("float", "int", "bool", "enum")[info.type] if info.type < 4 else "float"
    default: float | int | bool | str = info.default_value
    texts: dict[float, str] = {}
    if kind == "enum":
        step = info.step or 1.0
        steps = (info.max_value - info.min_value) / step
        count = min(int(steps + 1.5), _MOST_CHOICES) if 0 <= steps < _MOST_CHOICES else 0
        values = (info.min_value + n * step for n in range(count))
        texts = {v: text for v in values if (text := _value_text(handle, info.id, v)) is not None}
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


def _value_text(handle: ctypes.c_void_p, param_id: int, value: float) -> str | None:
    out = ctypes.create_string_buffer(64)
    try:
        _door.call("svh_param_name", handle, param_id, value, out)
    except ValueError:
        return None
    return _text(out.value)


def default_path() -> str:
    """The plugin of this package, or the file that ``SMARTVIS_PLUGIN`` names."""
    return os.environ.get("SMARTVIS_PLUGIN") or str(_places.find(f"smartvis{_runtime.LIBRARY}"))


def load(path: str | os.PathLike[str] | None = None, id: str | None = None) -> Plugin:
    """Loads a plugin library and returns one of its plugins, the first if `id` names none.

    Without a path it is the plugin of this package. LoadError says what is wrong with a file. Any other library runs
    guarded, in a process of its own.

    >>> load().id
    'org.smartvis.clip'
    """
    return _open(str(os.path.abspath(path)) if path is not None else default_path(), id)


@cache
def _open(path: str, id: str | None) -> Plugin:
    if not os.path.exists(path):
        raise LoadError(f"{path}: no such file")
    return Plugin(path, id)


def parameters(plugin: Plugin | None = None) -> Mapping[str, Parameter]:
    """A plugin's parameters by key, in the order of importance.

    >>> first = next(p for p in parameters().values() if p.primary)
    >>> first.key, first.type
    ('q', 'float')
    """
    return (plugin or load()).parameters
