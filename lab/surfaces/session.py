# SPDX-License-Identifier: MIT
"""A plugin at work on volumes as the machine sees them, with its settings."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from cases import Case, Told
from seen import Seen

import smartvis
from smartvis import _door
from smartvis._active import Active, told
from smartvis._result import Result

ANSWERS = ("sure", "doubtful", "refused")  #: what a method says of a volume; doubtful: whether it clips or not


def _answer(result: Result) -> str:
    """Of a doubtful surface there are words if it is clipped, and a setting that clips it if it is not."""
    return "doubtful" if result.try_this or (result.clips and result.why) else "sure" if result.clips else "refused"


class Session:
    """`settings` are "key=value" texts, parted by spaces. ValueError: the plugin does not have them."""

    def __init__(self, plugin: str | None, settings: str) -> None:
        self._active = Active(smartvis.load(plugin))
        self._values: dict[str, Any] = {}
        self.close = self._active.close  #: ends the plugin
        self.told = "nothing"  #: how much of what a case knows of its beams frames tell: "beams", "pose" or "nothing"
        self.sure = False  #: the method gives a confidence
        pairs = [setting.partition("=") for setting in settings.split()]
        for key, equals, value in pairs:
            if not equals or not value:
                raise ValueError(f"--method: '{key}' is no KEY=VALUE")
        self.set(**{key: value for key, _, value in pairs})

    def set(self, **values: Any) -> None:
        """Other values from the next frame on."""
        self._values |= values
        self._active.reset(self._values)

    def frame(self, seen: Seen, known: Told, time_ns: int = 0, goes_on: bool = False) -> Result:
        """One frame. `goes_on`: it shows the volume of the one before."""
        frame = {"time_ns": time_ns, "flags": _door.NUMBERS["SVH_SAME_VOLUME"] if goes_on else 0}
        view = told(seen.grid.view, known.probe, known.beams)
        result = self._active.clip(seen.levels, seen.grid, view, frame, seen.camera)
        self.sure = result.confidence is not None
        self.answer = _answer(result)
        return result

    def clip(self, case: Case) -> Result:
        """A frame of a case, which continues none."""
        return self.frame(case.seen, case.told.limited(self.told))


@contextmanager
def opened(plugin: str | None, settings: str, told: str = "nothing") -> Iterator[Session]:
    """A session that is closed in the end."""
    session = Session(plugin, settings)
    session.told = told
    try:
        yield session
    finally:
        session.close()
