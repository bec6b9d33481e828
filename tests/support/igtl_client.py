# SPDX-License-Identifier: MIT
"""OpenIGTLink's messages from a socket, for tests that watch what is on the wire."""

import struct

HEADER = 58  # bytes


def read_exactly(peer, count):
    """So many bytes; ConnectionResetError: the server closed the connection before."""
    data = bytearray()
    while len(data) < count:
        part = peer.recv(count - len(data))
        if not part:
            raise ConnectionResetError("the server closed the connection")
        data += part
    return bytes(data)


def read_message(peer):
    """The next message: its header, and its body."""
    header = read_exactly(peer, HEADER)
    return header, read_exactly(peer, struct.unpack("> 42x Q 8x", header)[0])
