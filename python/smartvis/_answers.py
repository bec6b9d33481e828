# SPDX-License-Identifier: MIT
"""What the machine's console asks of the package: MetaImage of formats that it does not read, and DICOM of pictures."""

from __future__ import annotations

import contextlib
import json
import shutil
import socket
import sys
import tempfile
import threading
from collections.abc import Iterator
from pathlib import Path

from . import _images, _kretz, _metaimage
from ._errors import FileError, HostError, SmartVisError
from ._files import Source, cut, write_image
from ._text import plain

_MOST = 2**16 - 2  # bytes of an answer


def _name(path: Path, end: str = "") -> str:
    """How a copy is called; the page leaves away what it adds to the file's own name."""
    return f"{cut(path.name or path.resolve().name, 170)}{end}.copy.mha"


def _volume(source: Source, number: int, path: Path) -> tuple[Path, str]:
    """A volume as MetaImage, and what is to be told of it."""
    image = source.read(number)
    file, said = write_image(path, image), _images.said(image)
    if said.side is not None:
        _metaimage.say_probe(file, said.side, said.apex)
    return file, said.told


def _sequence(source: Source, folder: Path, most: int | None) -> tuple[Path, str] | None:
    """All volumes as one MetaImage, and what is to be told of them; None: they differ in more than voxels.
    FileError: they are more than `most` bytes."""
    whole, all_told = folder / "sequence.mha", ""
    with whole.open("wb") as file:
        joined = _metaimage.Joined(file, source.count)
        for number in range(source.count):
            volume, told = _volume(source, number, folder / "volume.mha")
            if not joined.add(volume):
                return None
            if most is not None and file.tell() > most:
                raise FileError(f"{source.path}: its volumes are more than the console has room for")
            all_told = all_told or told
    return whole, all_told


def volumes(path: Path, most: int | None = None) -> Iterator[tuple[Path, str, str]]:
    """What a file holds as MetaImage, which lasts until the next one is asked for, its name, and what is to be told
    of it. Volumes of a file that differ in their voxels alone are one sequence, of `most` bytes; others come one by
    one."""
    source = Source(path)
    with tempfile.TemporaryDirectory(prefix="smartvis_") as folder:
        whole = _sequence(source, Path(folder), most) if source.count > 1 else None
        if whole:
            yield whole[0], _name(path), f"{path.name}: {whole[1]}" if whole[1] else ""
            return
        for number in range(source.count):
            end = f" volume {number + 1}" if source.count > 1 else ""
            file, told = _volume(source, number, Path(folder) / "volume.mha")
            yield file, _name(path, end), f"{path.name}{end}: {told}" if told else ""


def _free(folder: Path, name: str) -> Path:
    """A name of its own in a folder, as the console makes them."""
    paths = (folder / (f"{n}_{name}" if n > 1 else name) for n in range(1, 100))
    for path in paths:
        if not path.exists():
            return path
    raise FileError(f"{name}: there are 99 of that name")


class Answers:
    """A console's questions, answered on a thread of its own until the console ends."""

    def __init__(self) -> None:
        self._scans: dict[str, Path] = {}  # by copy, the DICOM that it was made of

    def note(self, copy: str, path: Path) -> None:
        """What a copy was made of: where that is DICOM, it tells whose its pictures are."""
        if path.is_dir() or _kretz.is_dicom(path):
            self._scans[copy] = path

    def read(self, path: str, room: str) -> str:
        """Puts the volumes of a file into its folder, where they may have `room` bytes; the file itself stays where it
        says whose they are."""
        file, left = Path(path), int(room)
        made: list[Path] = []
        told: list[str] = []
        try:
            for volume, name, said in volumes(file, left):
                left -= volume.stat().st_size
                made.append(_free(file.parent, name))
                told += [said] if said else []
                answer = json.dumps({"paths": [copy.name for copy in made], "told": "; ".join(told)})
                if left < 0 or len(answer) > _MOST:
                    raise FileError(f"{path}: its volumes are more than the console has room for")
                shutil.move(volume, made[-1])
        except BaseException:
            for copy in made:
                copy.unlink(missing_ok=True)
            raise
        for copy in made:
            self.note(copy.name, file)
        if file not in self._scans.values():
            file.unlink()
        return answer

    def dicom(self, path: str, copy: str) -> str:
        """Writes a picture as DICOM beside it, and tells where."""
        from ._capture import write

        picture = Path(path)
        return str(write([path], _free(picture.parent, "picture.dcm"), self._scans.get(copy)))

    def answer(self, question: str) -> str:
        """What a question is answered with. Where a file lies is not the page's business."""
        what, path, of = question.split("\n", 2)
        try:
            return "+" + {"read": self.read, "dicom": self.dicom}[what](path, of)
        except Exception as error:
            known = isinstance(error, (SmartVisError, OSError, MemoryError))
            sentence = str(error) if known else f"{path}: cannot be read ({type(error).__name__})"
            for file in (Path(path), *self._scans.values()):
                sentence = sentence.replace(f"{file.parent}/", "")
            return "-" + (plain(sentence)[:1000] or "It cannot be read.")

    def serve(self, link: socket.socket) -> None:
        """Answers until the console has closed its end."""
        with link, contextlib.suppress(OSError):
            while question := link.recv(_MOST):
                link.send(self.answer(question.decode(errors="surrogateescape")).encode(errors="surrogateescape"))

    def begin(self) -> socket.socket:
        """Starts the thread; returns the console's end."""
        if sys.platform == "win32":
            raise HostError("there is no console on Windows")
        own, others = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        threading.Thread(target=self.serve, args=(own,), daemon=True).start()
        return others
