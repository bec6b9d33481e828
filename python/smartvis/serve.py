# SPDX-License-Identifier: MIT
"""An OpenIGTLink server: volumes in, clipped volumes and depthmaps out.

A client sends an IMAGE named NAME. It gets three messages back:

- IMAGE ``NAME_clipped``, the clipped volume in the place of the one that it sent,
- IMAGE ``NAME_depth``, the depthmap in mm, one slice on the volume's front,
- STRING ``NAME_outcome``: ``OK``, ``PARTIAL``, ``NO_SURFACE``, or ``ERROR`` and the reason.

A STRING with ``KEY=VALUE ...`` sets parameters of this connection from the next volume on. Names are cut to 20
characters, of which NAME may have 12. Each client has a thread and an activated plugin of its own, so that one
that sends nonsense, stops in the middle or vanishes ends its own connection only.
"""

from __future__ import annotations

import logging
import socket
import socketserver
import threading
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._clip import ClipperCache, clip
from ._errors import SmartVisError
from ._igtl import Channel, PeerGone, ProtocolError, image_message, messages, string_message
from ._plugin import Plugin
from ._result import Result
from ._work import Settings

log = logging.getLogger("smartvis.serve")

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
        patience: float = 10.0,
    ) -> None:
        """`limit`: bytes of the longest message that is read. `clients`: connections at a time; more are closed
        at once. `patience`: seconds in which a message that has begun must be through, in either direction."""
        messages()  # what is missing is told before a client comes
        settings.load()
        self.settings = settings
        self.limit = limit
        self.patience = patience
        self._room = threading.BoundedSemaphore(clients)
        super().__init__((host, port), _Connection)

    def verify_request(self, request: Any, client_address: Any) -> bool:
        """False for a client too many."""
        room = self._room.acquire(blocking=False)
        if not room:
            log.warning("%s: there are as many clients as are allowed", client_address)
        return room

    def leave(self) -> None:
        """A connection has ended."""
        self._room.release()


class _Connection(socketserver.BaseRequestHandler):
    server: Server

    def handle(self) -> None:
        session = Session(self.server.settings)
        self.request.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        _ask_the_silent(self.request)
        channel = Channel(self.request, self.server.limit, self.server.patience)
        try:
            while True:
                message = channel.receive()
                for answer in session.answer(message) if message is not None else ():
                    self.request.settimeout(self.server.patience)
                    self.request.sendall(answer.pack())
        except ProtocolError as error:
            log.warning("%s: %s; the connection is closed", self.client_address, error)
        except (PeerGone, OSError) as error:
            log.info("%s: %s", self.client_address, error)
        except Exception:
            log.exception("%s: the connection is closed", self.client_address)
        finally:
            session.close()

    def finish(self) -> None:
        self.server.leave()


class Session:
    """What one client's messages come to, without a socket."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._plugin: Plugin = settings.load()
        self._cache = ClipperCache(most=1)

    def close(self) -> None:
        """Ends the plugin's instance."""
        self._cache.close()

    def answer(self, message: Any) -> list[Any]:
        """The messages that answer one; none for types that mean nothing here."""
        if message.message_type == "IMAGE":
            return self._clip(message)
        if message.message_type == "STRING":
            return [self._set(message)]
        return []

    def _set(self, message: Any) -> Any:
        name = f"{message.device_name[:_LONGEST_NAME]}_set"
        try:
            pairs = dict(word.split("=", 1) for word in message.string.split())
            values = {k: v if v in _choices(self._plugin, k) else float(v) for k, v in pairs.items()}
            self._plugin.encode(values)
        except ValueError as error:
            return string_message(name, f"ERROR {error}")
        self._settings = replace(self._settings, parameters=self._settings.parameters | values)
        return string_message(name, "OK " + " ".join(f"{k}={v}" for k, v in values.items()))

    def _clip(self, message: Any) -> list[Any]:
        name = message.device_name[:_LONGEST_NAME]
        try:
            volume = _native(message.image)
            spacing = np.linalg.norm(message.ijk_to_world_matrix[:3, :3], axis=0)
            result = self._result(volume, spacing)
            clipped = result.apply(volume)
        except (SmartVisError, ValueError, MemoryError) as error:
            return [string_message(f"{name}_outcome", f"ERROR {error}", message.timestamp)]
        return [
            image_message(f"{name}_clipped", clipped, message.ijk_to_world_matrix, message),
            image_message(f"{name}_depth", result.depth_mm[None], _front(message.ijk_to_world_matrix, result), message),
            string_message(f"{name}_outcome", result.outcome.name, message.timestamp),
        ]

    def _result(self, volume: NDArray[Any], spacing: NDArray[np.float64]) -> Result:
        settings = self._settings
        return clip(
            volume,
            tuple(float(s) for s in spacing),
            view=settings.view,
            scanned=settings.scanned,
            window=settings.window,
            plugin=self._plugin,
            cache=self._cache,
            **settings.parameters,
        )


def _ask_the_silent(peer: socket.socket) -> None:
    """A client whose machine is gone says nothing: the system asks, and after two minutes its room is free again."""
    peer.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for option, value in (("TCP_KEEPIDLE", 60), ("TCP_KEEPINTVL", 15), ("TCP_KEEPCNT", 4)):
        if hasattr(socket, option):  # not every system has them
            peer.setsockopt(socket.IPPROTO_TCP, getattr(socket, option), value)


def _choices(plugin: Plugin, key: str) -> tuple[str, ...]:
    known = plugin.parameters
    return known[key].choices if key in known else ()


def _native(image: NDArray[Any]) -> NDArray[Any]:
    """In this machine's byte order, as pyigtl packs it."""
    return image.astype(image.dtype.newbyteorder("="), copy=False)


def _front(matrix: NDArray[np.float64], result: Result) -> NDArray[np.float64]:
    """The depthmap's place: its pixels on the first slice that the camera sees."""
    camera = result.camera
    axes = matrix[:3, :3] / np.linalg.norm(matrix[:3, :3], axis=0)
    out = np.eye(4)
    out[:3, :3] = axes @ camera.rotation.T * np.array(camera.spacing)
    out[:3, 3] = matrix[:3, 3] + axes @ camera.to_volume_mm(np.zeros(3))
    return out
