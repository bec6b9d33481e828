# SPDX-License-Identifier: MIT
"""``smartvis console``: files that the machine's console does not read are opened there."""

from __future__ import annotations

import contextlib
import http.client
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from urllib.parse import parse_qs, quote, urlencode, urlsplit

from . import _host, _images, _metaimage
from ._errors import HostError, OutputError
from ._files import Source, stem, write_image
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
        return said


@contextlib.contextmanager
def running(more: Sequence[str]) -> Iterator[tuple[subprocess.Popen[str], Page]]:
    """A console, which ends with the block."""
    command = [_host.find(), "console", *more]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=_host.environment(command[0])) as process:
        try:
            assert process.stdout is not None
            name, _, address = process.stdout.readline().strip().partition("  ")
            if name != "Console":
                raise HostError("the console did not start", process.wait())
            yield process, Page(address)
        finally:
            process.terminate()


def volumes(paths: Sequence[str]) -> Iterator[tuple[Path, str, str]]:
    """Every volume of the files as a MetaImage, which lasts until the next one is asked for, its name, and what is to
    be told of its file."""
    for path in map(Path, paths):
        source = Source(path)
        for number in range(source.count):
            with tempfile.TemporaryDirectory(prefix="smartvis_") as folder:
                end = f"_{number:03}" if source.count > 1 else ""
                name = f"{stem(path)}{end}.mha"
                image = source.read(number)
                file, said = write_image(Path(folder) / "volume.mha", image), _images.said(image)
                if said.side is not None:
                    _metaimage.say_probe(file, said.side, said.apex)
                yield file, name, said.told


def open_files(paths: Sequence[str], more: Sequence[str]) -> int:
    """Opens files in a console and prints its address, which shows the first of them. Returns its exit code when it
    ends."""
    with running(more) as (process, page):
        copies = []
        for file, name, told in volumes(paths):
            copies.append(page.drop(file, name))
            if told:
                print(plain(f"{name}: {told}"), file=sys.stderr)
        first = "#file=0:" + quote(copies[0], safe="") if copies else ""
        print(f"Console  {page.address}{first}")
        sys.stdout.flush()
        try:
            return process.wait()
        except KeyboardInterrupt:  # which the console has got, too
            return process.wait()
