# SPDX-License-Identifier: MIT
"""OpenIGTLink messages on a socket. pyigtl packs and unpacks them; what arrives is checked here first, because a
size from the network must not decide how much memory is taken."""

from __future__ import annotations

import math
import re
import socket
import struct
import time
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._errors import SmartVisError, extra_module

HEADER_BYTES = 58
_HEADER = struct.Struct("> H 12s 20s II Q Q")
_SPOKEN = (1, 2, 3)
_TYPE = re.compile(rb"[A-Za-z0-9_]+")
_CHUNK = 1 << 20


class ProtocolError(SmartVisError):
    """A peer sent what is no OpenIGTLink message, or more than is allowed."""


class PeerGone(SmartVisError):
    """The peer closed the connection, or stopped in the middle of a message."""


class Refused(SmartVisError):
    """What a peer sent is not taken, or there is no room for it. `device_name`: of the message. `code`: of the STATUS
    that says so; 0: a STRING does."""

    device_name = ""
    code = 0


def messages() -> Any:
    """pyigtl's messages."""
    module = extra_module("pyigtl.messages", "pyigtl", "serve", "smartvis serve")
    if module.CRC64 is not _checksum:
        _whole_checksums.append(module.CRC64)
        module.CRC64 = _checksum
    return module


_whole_checksums: list[Any] = []  # pyigtl's own function, behind the one that follows


def _checksum(data: Any, checksum: int = 0) -> int:
    """By parts: pyigtl's keeps all other threads waiting until it has done, seconds for a large volume."""
    with memoryview(data) as view:
        for at in range(0, len(view), _CHUNK):
            checksum = _whole_checksums[0](bytes(view[at : at + _CHUNK]), checksum)
    return checksum


class Query(NamedTuple):
    """A message without a body that asks for something: GET_STATUS, GET_CAPABIL, ..."""

    message_type: str
    device_name: str
    timestamp: float


_QUERIES = ("GET_STATUS", "GET_CAPABIL")
_TAKEN = ("GET_CAPABIL", "GET_STATUS", "IMAGE", "STRING")
OK, UNKNOWN_INSTRUCTION = 1, 12  #: codes of a STATUS


class Channel:
    """Receives whole messages from one peer."""

    def __init__(
        self, peer: socket.socket, limit: int, patience: float, admit: Callable[[int], None] | None = None
    ) -> None:
        """`limit`: bytes of the longest message; `patience`: seconds that one may take to arrive. `admit` is told
        a message's bytes before it is read, and may raise Refused: then it is passed over."""
        self._admit = admit
        self._peer = peer
        self._limit = limit
        self._patience = patience
        self._chunk = bytearray(_CHUNK)
        self._messages = messages()

    def receive(self) -> Any | None:
        """The next message; None if it is of a type that pyigtl does not know. PeerGone at the end of the
        connection, ProtocolError for what is no message."""
        self._peer.settimeout(None)  # a client may be silent for as long as it likes between messages
        first = self._body(1, None)
        end = time.monotonic() + self._patience
        header = first + self._body(HEADER_BYTES - 1, end)
        fields = _HEADER.unpack(header)
        version, raw_type, _, _, _, size, checksum = fields
        kind = raw_type.rstrip(b"\0 ")
        if version not in _SPOKEN or not _TYPE.fullmatch(kind):
            raise ProtocolError(f"no OpenIGTLink header: version {version}, type {raw_type!r}")
        if size > self._limit:
            raise ProtocolError(f"a {kind.decode()} message of {size} bytes, allowed are {self._limit}")
        try:
            if self._admit is not None:
                self._admit(size)
        except Refused as refused:
            self._pass_over(size, end)
            refused.device_name = fields[2].rstrip(b"\0 ").decode("ascii", "replace")
            raise
        body = self._body(size, end)
        if self._messages.CRC64(body) != checksum:
            raise ProtocolError(f"a {kind.decode()} message with a wrong checksum")
        return self._unpack(header, body)

    def _unpack(self, header: bytes, body: bytes) -> Any | None:
        try:
            fields = self._messages.MessageBase.parse_header(header)
            if fields["message_type"] in _QUERIES:
                return Query(fields["message_type"], fields["device_name"], fields["timestamp"])
            message = self._messages.MessageBase.create_message(fields["message_type"])
            if message is None:
                return None
            message.unpack(fields, body)
            return message
        except NotImplementedError as error:
            if not _is_part(fields["header_version"], body):
                raise ProtocolError(f"an image that does not fit its size: {error}") from None
            # The message was read whole, and others may follow.
            refused = Refused("a part of a volume (subvolume) is not taken, send all of it")
            refused.device_name, refused.code = str(fields["device_name"]), UNKNOWN_INSTRUCTION
            raise refused from None
        except Exception as error:  # whatever a hostile body makes of pyigtl's parser
            raise ProtocolError(f"a message that cannot be read: {type(error).__name__}: {error}") from None

    def _pass_over(self, size: int, end: float) -> None:
        with memoryview(self._chunk) as view:
            while size > 0:
                size -= self._some(view[:size], end)

    def _body(self, size: int, end: float | None) -> bytes:
        """Memory grows with what has arrived, not with what a header promises."""
        body = bytearray()
        with memoryview(self._chunk) as view:
            while len(body) < size:
                count = self._some(view[: size - len(body)], end)
                body += view[:count]
        return bytes(body)

    def _some(self, view: memoryview, end: float | None) -> int:
        if end is not None:
            left = end - time.monotonic()
            if left <= 0:
                raise PeerGone("a message did not arrive in time")
            self._peer.settimeout(left)
        try:
            count = self._peer.recv_into(view)
        except TimeoutError:
            raise PeerGone("a message did not arrive in time") from None
        except OSError as error:
            raise PeerGone(str(error)) from None
        if count == 0:
            raise PeerGone("the connection was closed")
        return count


def _is_part(version: int, body: bytes) -> bool:
    """Whether an IMAGE holds a part of a volume that lies in it, and its voxels."""
    at = struct.unpack_from("> H", body)[0] if version > 1 else 0
    if len(body) < at + 72:
        return False
    size, numbers = struct.unpack_from("> 3H", body, at + 6), struct.unpack_from("> 6H", body, at + 60)
    fits = all(n > 0 and first + n <= all_ for all_, first, n in zip(size, numbers[:3], numbers[3:], strict=True))
    return fits and len(body) >= at + 72 + math.prod(numbers[3:])


def image_message(name: str, voxels: NDArray[Any], matrix: NDArray[np.float64], like: Any) -> Any:
    """An IMAGE with the time and the world of the message that it answers. Names have 20 characters at most."""
    return messages().ImageMessage(
        np.ascontiguousarray(voxels),
        ijk_to_world_matrix=matrix,
        world_coordinate_system=like.world_coordinate_system,
        timestamp=like.timestamp,
        device_name=short(name),
    )


def string_message(name: str, text: str, timestamp: float | None = None) -> Any:
    """A STRING."""
    plain = text.encode("ascii", "replace").decode()
    return messages().StringMessage(plain, timestamp=timestamp, device_name=short(name))


class _Packed(NamedTuple):
    """A message of a type that pyigtl does not know, ready to be sent."""

    data: bytes
    message_type: str

    def pack(self) -> bytes:
        return self.data


def _packed(kind: str, name: str, body: bytes) -> _Packed:
    seconds = time.time()
    stamp = int(seconds), int((seconds % 1) * (1 << 32))
    messages()
    checksum = _checksum(body)
    return _Packed(_HEADER.pack(1, kind.encode(), short(name).encode(), *stamp, len(body), checksum) + body, kind)


def status_message(name: str, code: int, text: str) -> Any:
    """A STATUS: how it stands, in words, too."""
    plain = text.encode("ascii", "replace")
    error = b"OK" if code == OK else b"UNSUPPORTED"
    return _packed("STATUS", name, struct.pack("> H q 20s", code, 0, error) + plain + b"\0")


def capability_message(name: str) -> Any:
    """A CAPABILITY: the types of messages that are answered."""
    return _packed("CAPABILITY", name, b"".join(struct.pack("12s", kind.encode()) for kind in _TAKEN))


def short(name: str) -> str:
    """A device name as the protocol takes it: 20 ASCII characters."""
    return name.encode("ascii", "replace").decode()[:20]
