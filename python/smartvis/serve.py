# SPDX-License-Identifier: MIT
"""An OpenIGTLink server: volumes in, clipped volumes and depthmaps out.

A client sends an IMAGE named NAME. It gets three messages back:

- IMAGE ``NAME_clipped``, the clipped volume in the place of the one that it sent,
- IMAGE ``NAME_depth``, the depthmap in mm, one slice on the volume's front,
- STRING ``NAME_outcome``: ``OK``, ``PARTIAL``, ``NO_SURFACE``, why, and how the beams ran; or ``ERROR`` and the reason.

GET_STATUS and GET_CAPABIL are answered; a part of a volume (subvolume) is refused by a STATUS.

A STRING with ``KEY=VALUE ...`` sets parameters of this connection from the next volume on. Names are cut to 20
characters, of which NAME may have 12. Each client has a thread and an activated plugin of its own, so that one
that sends nonsense, stops in the middle or vanishes ends its own connection only.
"""

from __future__ import annotations

import errno
import logging
import math
import os
import socket
import socketserver
import threading
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._clip import ClipperCache
from ._errors import SmartVisError
from ._igtl import (
    OK,
    Channel,
    PeerGone,
    ProtocolError,
    Refused,
    capability_message,
    image_message,
    messages,
    status_message,
    string_message,
)
from ._plugin import Plugin
from ._result import Result
from ._text import plain
from ._words import on_command_line
from ._work import Settings

log = logging.getLogger("smartvis.serve")

_COPIES = 12  # of a message: as it came, as numbers (8 bytes of a voxel's one), levels, clipped, packed with its header
_LOOKS = 3  # of what a look takes, while the machine looks: its grid, as it is filled and as it is handed over
_NO_SUCH_NETWORK = (errno.EAFNOSUPPORT, errno.EADDRNOTAVAIL)
_LONGEST_NAME = 12  # "_clipped" follows, and a device name has 20 characters


class Server(socketserver.ThreadingTCPServer):
    """``with Server(settings) as server: server.serve_forever()``; ``server.shutdown()`` from another thread ends
    it."""

    allow_reuse_address = True
    daemon_threads = True

    def __init__(
        self,
        settings: Settings,
        host: str = "127.0.0.1",
        port: int = 18944,
        *,
        limit: int = 512 << 20,
        clients: int = 8,
        memory: int | None = None,
        all_memory: int | None = None,
        patience: float = 10.0,
    ) -> None:
        """`limit`: bytes of the longest message that is read. `clients`: connections at a time; more are closed
        at once. `memory`, `all_memory`: bytes that a client's volume, and those of all, may take with what is made
        of them; None: a quarter and a half of the machine's memory. `patience`: seconds in which a message that has
        begun must be through, in either direction."""
        messages()  # what is missing is told before a client comes
        settings.load()
        self.settings = settings
        self.limit = limit
        self.patience = patience
        pages = "SC_PHYS_PAGES", "SC_PAGE_SIZE"
        machine = math.prod(map(os.sysconf, pages)) if hasattr(os, "sysconf") else 8 << 30  # Windows does not tell
        self.budget = Budget(memory or machine // 4, all_memory or machine // 2)
        self.room = threading.BoundedSemaphore(clients)
        families = {found[0] for found in socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)}
        self.address_family = socket.AF_INET if socket.AF_INET in families else socket.AF_INET6
        try:
            super().__init__((host, port), _Connection)
        except OSError as error:
            if self.address_family != socket.AF_INET6 or error.errno not in _NO_SUCH_NETWORK:
                raise
            raise OSError(error.errno, "this machine has no such IPv6 address") from None

    def verify_request(self, request: Any, client_address: Any) -> bool:
        """False for a client too many."""
        room = self.room.acquire(blocking=False)
        if not room:
            log.warning("%s: there are as many clients as are allowed", client_address)
        return room


class Budget:
    """Memory that clients share: bytes that each holds now."""

    def __init__(self, each: int, together: int) -> None:
        self._each = each
        self._together = together
        self._lock = threading.Lock()
        self._held: dict[object, int] = {}

    def hold(self, client: object, count: int) -> None:
        """From now on `count` bytes, 0: none. Refused: there is no room, and the client holds what it held."""
        with self._lock:
            others = sum(self._held.values()) - self._held.get(client, 0)
            room = min(self._each, self._together - others)
            if count > room:
                raise Refused(f"the volume takes {count >> 20} MiB here, and there is room for {max(room, 0) >> 20}")
            self._held[client] = count
            if count == 0:
                del self._held[client]


class _Connection(socketserver.BaseRequestHandler):
    server: Server

    def handle(self) -> None:
        session = Session(self.server.settings, self.server.budget)
        self.request.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        _ask_the_silent(self.request)
        channel = Channel(self.request, self.server.limit, self.server.patience, session.receives)
        try:
            while True:
                for answer in session.answer_next(channel):
                    self.request.settimeout(self.server.patience)
                    self.request.sendall(answer.pack())
                session.rests()
        except ProtocolError as error:
            log.warning("%s: %s; the connection is closed", self.client_address, plain(error))
        except (PeerGone, OSError) as error:
            log.info("%s: %s", self.client_address, plain(error))
        except Exception:
            log.exception("%s: the connection is closed", self.client_address)
        finally:
            session.close()

    def finish(self) -> None:
        self.server.room.release()


class Session:
    """What one client's messages come to, without a socket."""

    def __init__(self, settings: Settings, budget: Budget) -> None:
        self._settings = settings
        self._plugin: Plugin = settings.load()
        self._cache = ClipperCache(most=1, admit=self._admits)
        self._budget = budget
        self._message = self._activated = 0  # bytes

    def close(self) -> None:
        """Ends the plugin's instance."""
        self._cache.close()
        self._budget.hold(self, 0)

    def receives(self, size: int) -> None:
        """Before a message of so many bytes is read. Refused: there is no room for it."""
        self._budget.hold(self, _COPIES * size + self._activated)
        self._message = size

    def rests(self) -> None:
        """The message has gone; the plugin's instance stays."""
        self._message = 0
        self._budget.hold(self, self._activated)

    def _admits(self, look: int, needed: int) -> None:
        if needed == 0:
            self._budget.hold(self, _COPIES * self._message + _LOOKS * look + self._activated)
            return
        self._activated = 0  # there is one instance, and the one before has ended
        self._budget.hold(self, _COPIES * self._message + look + needed)
        self._activated = look + needed  # it keeps the volume that it saw last

    def answer_next(self, channel: Channel) -> list[Any]:
        """The messages that answer the next one."""
        try:
            message = channel.receive()
        except Refused as refused:
            if refused.code:
                return [status_message(refused.device_name, refused.code, str(refused))]
            return [string_message(f"{refused.device_name[:_LONGEST_NAME]}_outcome", f"ERROR {refused}")]
        return [] if message is None else self.answer(message)

    def answer(self, message: Any) -> list[Any]:
        """The messages that answer one; none for types that mean nothing here."""
        if message.message_type == "IMAGE":
            return self._clip(message)
        if message.message_type == "STRING":
            return [self._set(message)]
        if message.message_type == "GET_STATUS":
            return [status_message(message.device_name, OK, "ready")]
        if message.message_type == "GET_CAPABIL":
            return [capability_message(message.device_name)]
        return []

    def _set(self, message: Any) -> Any:
        name = f"{message.device_name[:_LONGEST_NAME]}_set"
        try:
            pairs = dict(word.split("=", 1) for word in message.string.split())
            known = self._plugin.parameters
            values = {k: v if k in known and v in known[k].choices else float(v) for k, v in pairs.items()}
            self._plugin.check(values)
        except ValueError as error:
            return string_message(name, f"ERROR {error}")
        self._settings = replace(self._settings, parameters=self._settings.parameters | values)
        return string_message(name, "OK " + " ".join(f"{k}={v}" for k, v in values.items()))

    def _clip(self, message: Any) -> list[Any]:
        name = message.device_name[:_LONGEST_NAME]
        try:
            volume = message.image.astype(message.image.dtype.newbyteorder("="), copy=False)  # as pyigtl packs it
            lengths = np.linalg.norm(message.ijk_to_world_matrix[:3, :3], axis=0)
            spacing = tuple(float(f"{length:.7g}") for length in lengths)  # a message has 32 bits a number
            result = self._settings.clip(volume, self._cache, spacing)
            clipped = result.apply(volume)
            doubt = result.doubt if result.doubt != result.why else ""
            said = (result.outcome.name, *map(on_command_line, (result.why, doubt)))  # the server's own options
            beams = f"Beams: {result.beams}"
        except (SmartVisError, ValueError, MemoryError) as error:
            return [string_message(f"{name}_outcome", f"ERROR {error}", message.timestamp)]
        return [
            image_message(f"{name}_clipped", clipped, message.ijk_to_world_matrix, message),
            image_message(f"{name}_depth", result.depth_mm[None], _front(message.ijk_to_world_matrix, result), message),
            string_message(f"{name}_outcome", " ".join(filter(None, (*said, beams))), message.timestamp),
        ]


def _ask_the_silent(peer: socket.socket) -> None:
    """A client whose machine is gone says nothing: the system asks, and after two minutes its room is free again."""
    peer.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for option, value in (("TCP_KEEPIDLE", 60), ("TCP_KEEPINTVL", 15), ("TCP_KEEPCNT", 4)):
        if hasattr(socket, option):  # not every system has them
            peer.setsockopt(socket.IPPROTO_TCP, getattr(socket, option), value)


def _front(matrix: NDArray[np.float64], result: Result) -> NDArray[np.float64]:
    """The depthmap's place: its pixels on the first slice that the camera sees."""
    camera = result.camera
    axes = matrix[:3, :3] / np.linalg.norm(matrix[:3, :3], axis=0)
    out = np.eye(4)
    out[:3, :3] = axes @ camera.rotation.T * np.array(camera.spacing)
    out[:3, 3] = matrix[:3, 3] + axes @ camera.to_volume_mm(np.zeros(3))
    return out
