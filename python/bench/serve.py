# SPDX-License-Identifier: MIT
"""Volumes a second through smartvis serve on the loopback, one after the other: serve.py [SIDE [VOLUMES]].

At 128^3 at least 20 a second are promised, on a machine that does nothing else; exit code 1 if it is less. What they
would be by the processor time of server and client, which does not count what else the machine does, is printed, too.
"""

import os
import socket
import struct
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from pyigtl.messages import ImageMessage

PROMISED = {128: 20.0}  # volumes a second by side
MM = 0.8  # between voxels


def message(side: int) -> bytes:
    """A volume of skin, fluid and fetus."""
    volume = np.full((side, side, side), 200, np.uint8)
    volume[: 3 * side // 5] = 10
    volume[: side // 5] = 100
    packed: bytes = ImageMessage(volume, ijk_to_world_matrix=np.diag([MM, MM, MM, 1.0]), device_name="Scan").pack()
    return packed


def read(peer: socket.socket, count: int) -> bytes:
    data = bytearray(count)
    view = memoryview(data)
    while view:
        got = peer.recv_into(view)
        if got == 0:
            raise ConnectionResetError("the server closed the connection")
        view = view[got:]
    return bytes(data)


def there_and_back(peer: socket.socket, whole: bytes) -> list[bytes]:
    """Sends a volume and reads the three messages that answer it; their bodies."""
    peer.sendall(whole)
    return [read(peer, struct.unpack("> 42x Q 8x", read(peer, 58))[0]) for _ in range(3)]


def processor_seconds(pid: int) -> float:
    """Of a process that runs, and of this one."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK") + time.process_time()


def measure(side: int, volumes: int) -> tuple[float, float]:
    """Volumes a second, and volumes a second of processor time."""
    command = [sys.executable, "-P", "-m", "smartvis", "serve", "--port", "0", "--method", "mean"]
    whole = message(side)
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        assert server.stdout is not None
        try:
            port = int(server.stdout.readline().split(":")[2].split(";")[0])
            with socket.create_connection(("127.0.0.1", port)) as peer:
                peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                there_and_back(peer, whole)  # activates
                start, before = time.perf_counter(), processor_seconds(server.pid)
                for _ in range(volumes):
                    clipped, depth, outcome = there_and_back(peer, whole)
                passed, busy = time.perf_counter() - start, processor_seconds(server.pid) - before
        finally:
            server.terminate()
    pixels = round(MM * side) ** 2  # the machine's grid has one a mm
    assert len(clipped) == len(whole) - 58 and len(depth) > 4 * pixels and outcome[4:].split()[0] == b"OK"
    return volumes / passed, volumes / max(busy, 1e-9)


if __name__ == "__main__":
    side, volumes = int(sys.argv[1]) if len(sys.argv) > 1 else 128, int(sys.argv[2]) if len(sys.argv) > 2 else 60
    rate, by_processor = measure(side, volumes)
    print(f"{rate:.1f} volumes of {side}^3 a second, there and back; {by_processor:.1f} by processor time")
    sys.exit(rate < PROMISED.get(side, 0.0))
