# SPDX-License-Identifier: MIT
"""``smartvis console``: files that the machine's console does not read are opened there."""

from __future__ import annotations

import contextlib
import http.client
import json
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from urllib.parse import parse_qs, quote, urlencode, urlsplit

from . import _host
from ._answers import Answers, volumes
from ._errors import HostError, OutputError
from ._text import plain

_SECONDS = 600  # that the console may take for a copy


class Page:
    """A console that runs, by its address."""

    def __init__(self, address: str) -> None:
        parts = urlsplit(address)
        self.address, self._place, self._token = address, parts.netloc, parse_qs(parts.query)["t"][0]

    def drop(self, path: Path, name: str) -> str:
        """Hands a file over, as if it was dropped on the page; returns how the console calls its copy. The copy lies in
        the console's private folder and goes with it."""
        where = "/drop?" + urlencode({"t": self._token, "name": name})
        with (
            contextlib.closing(http.client.HTTPConnection(self._place, timeout=_SECONDS)) as link,
            path.open("rb") as file,
        ):
            length = {"Origin": f"http://{self._place}", "Content-Length": str(path.stat().st_size)}
            link.request("POST", where, body=file, headers=length)
            answer = link.getresponse()
            said = answer.read().decode(errors="replace")
        if answer.status != http.client.OK:
            raise OutputError(said.strip() or f"{name}: the console does not take it")
        copy: str = json.loads(said)["paths"][0]
        return copy


@contextlib.contextmanager
def running(more: Sequence[str], answers: Answers) -> Iterator[tuple[subprocess.Popen[str], Page]]:
    """A console, which ends with the block. `answers`: who answers its questions."""
    program = _host.find()
    own = _host.environment(program)
    with answers.begin() as theirs:
        command = [program, "console", *more, "--reader", str(theirs.fileno())]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=own, pass_fds=[theirs.fileno()])
    with process:
        try:
            assert process.stdout is not None
            name, _, address = process.stdout.readline().strip().partition("  ")
            if name != "Console":
                raise HostError("the console did not start", process.wait())
            yield process, Page(address)
        finally:
            process.terminate()


def open_files(paths: Sequence[str], more: Sequence[str]) -> int:
    """Opens files in a console and prints its address, which shows the first of them. Returns its exit code when it
    ends."""
    answers = Answers()
    with running(more, answers) as (process, page):
        copies = []
        for path in map(Path, paths):
            for file, name, told in volumes(path):
                copies.append(page.drop(file, name))
                answers.note(copies[-1], path)
                if told:
                    print(plain(told), file=sys.stderr)
        first = "#file=0:" + quote(copies[0], safe="") if copies else ""
        print(f"Console  {page.address}{first}")
        sys.stdout.flush()
        try:
            return process.wait()
        except KeyboardInterrupt:  # from a terminal the console has got it, too; from another program it has not
            process.terminate()
            return process.wait()
