# SPDX-License-Identifier: MIT
"""A console under test, and a client of it on bare sockets, which can also say what no browser would."""

import base64
import json
import os
import signal
import socket
import struct
import subprocess
import time

SIZE = 64  # voxels: what is tested is the console, not the loop


class Address:
    """Where a console is, as it prints it; `first`: what its page shows, if it says so."""

    def __init__(self, text):
        self.address, _, self.first = text.partition("#")
        self.place, self.token = self.address[len("http://"):].split("/?t=")
        self.host, port = self.place.rsplit(":", 1)
        self.port = int(port)


class Console(Address):
    """host_sim console with these arguments."""

    def __init__(self, build, arguments=(), err=None, by=(), **more):
        program = os.path.join(build, "host_sim")
        self.process = subprocess.Popen([*by, program, "console", *arguments], stdout=subprocess.PIPE, stderr=err, text=True, **more)
        line = self.process.stdout.readline()
        assert line.startswith("Console  http://"), f"the console said '{line}'"
        super().__init__(line.split()[1])

    def request(self, path, method="GET", headers=None, host=None):
        """(status, headers as text, body) of a request on a connection of its own."""
        lines = [f"{method} {path} HTTP/1.1", f"Host: {host or self.place}"]
        lines += [f"{key}: {value}" for key, value in (headers or {}).items()]
        return self.ask("\r\n".join(lines + ["", ""]).encode())

    def ask(self, data):
        """The same for bytes as they are."""
        with socket.create_connection((self.host, self.port), timeout=30) as one:
            one.sendall(data)
            said = b""
            while True:
                more = one.recv(65536)
                if not more:
                    break
                said += more
        head, _, body = said.partition(b"\r\n\r\n")
        words = head.split(b" ", 2)
        return (int(words[1]) if len(words) > 1 else 0), head.decode("latin-1"), body

    def interrupt(self):
        self.process.send_signal(signal.SIGINT)

    def wait(self, seconds):
        return self.process.wait(timeout=seconds)

    def end(self):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        self.process.stdout.close()


class Page:
    """A WebSocket of the console. `open` is False if it was not let in."""

    def __init__(self, console, path=None, headers=None, timeout=60):
        usual = {"Host": console.place, "Origin": "http://" + console.place, "Upgrade": "websocket", "Connection": "Upgrade",
                 "Sec-WebSocket-Key": base64.b64encode(os.urandom(16)).decode(), "Sec-WebSocket-Version": "13"}
        for key, value in (headers or {}).items():
            usual[key] = value
        path = path if path is not None else "/live?t=" + console.token
        self.timeout = timeout
        self.socket = socket.create_connection((console.host, console.port), timeout=timeout)
        lines = [f"GET {path} HTTP/1.1"] + [f"{key}: {value}" for key, value in usual.items() if value is not None]
        self.socket.sendall("\r\n".join(lines + ["", ""]).encode())
        self.rest = b""
        head = b""
        while b"\r\n\r\n" not in head:
            more = self._receive()
            if not more:
                break
            head += more
        self.open = head.startswith(b"HTTP/1.1 101")
        self.rest = head.partition(b"\r\n\r\n")[2]
        self.serial = 0
        self.pictures = {}

    def _receive(self):
        try:
            return self.socket.recv(65536)
        except (ConnectionError, OSError):
            return b""

    def frame(self, opcode, data, first=0x80, mask=True):
        """The bytes of a frame."""
        length = len(data)
        bit = 0x80 if mask else 0
        head = bytes([first | opcode])
        if length < 126:
            head += bytes([bit | length])
        elif length < 65536:
            head += bytes([bit | 126]) + struct.pack(">H", length)
        else:
            head += bytes([bit | 127]) + struct.pack(">Q", length)
        if not mask:
            return head + data
        key = os.urandom(4)
        return head + key + bytes(byte ^ key[i % 4] for i, byte in enumerate(data))

    def raw(self, data):
        try:
            self.socket.sendall(data)
        except OSError:
            pass  # it was closed: what comes next tells

    def say(self, message):
        text = message if isinstance(message, (bytes, str)) else json.dumps(message)
        self.raw(self.frame(1, text.encode() if isinstance(text, str) else text))

    def _exactly(self, count):
        while len(self.rest) < count:
            more = self._receive()
            if not more:
                return None
            self.rest += more
        out, self.rest = self.rest[:count], self.rest[count:]
        return out

    def hear(self):
        """(opcode, data) of the next frame; None where the console has closed."""
        head = self._exactly(2)
        if head is None:
            return None
        length = head[1] & 0x7f
        if length >= 126:
            more = self._exactly(2 if length == 126 else 8)
            if more is None:
                return None
            length = int.from_bytes(more, "big")
        data = self._exactly(length)
        return None if data is None else (head[0] & 0x0f, data)

    def text(self, *types):
        """The next text of one of these types; pictures before it are kept. None where the console has closed."""
        while True:
            heard = self.hear()
            if heard is None or heard[0] == 8:
                return None
            if heard[0] == 9:
                self.raw(self.frame(10, heard[1]))  # a ping: whoever does not answer is taken for gone
            if heard[0] == 2:
                self._take(heard[1])
            elif heard[0] == 1:
                one = json.loads(heard[1])
                if one["type"] in types:
                    return one

    def must(self, *types):
        """`text` that has to come: what did not is said."""
        one = self.text(*types)
        holds(one is not None, f"no {' or '.join(types)} came: the console has closed the page, or was silent for {self.timeout} s")
        return one

    def _take(self, data):
        assert data[:3] == b"SVP", "a binary message without its mark"
        frame, view, width, height, serial = struct.unpack("<IIHHI", data[4:20])
        self.pictures[view] = (frame, data[3], width, height, serial, data[20:])

    def state(self, **changes):
        """The next state, with these fields replaced."""
        self.serial += 1
        state = {"type": "state", "serial": self.serial,
                 "source": {"scene": "D01", "size": SIZE, "volumes": 1, "from": "probe"},
                 "camera": {"yaw": 0, "pitch": 0, "roll": 0, "zoom": 1}, "views": ["result"], "picture": 64, "draft": 32,
                 "hurried": False, "play": {"on": False, "speed": 20, "index": 0}, "cross": [0.5, 0.5, 0.5], "thick": 0,
                 "render": {"look": "thesis", "light": [-35, 40], "t_low": 0.1588, "t_high": 0.45, "ghost_width": 0,
                            "ghost_offset": 0, "ghost_doubt": 2, "exposure": 1.5},
                 "lanes": [{"plugin": 0, "values": {}}], "marks": [], "box": []}
        state.update(changes)
        return state

    def show(self, **changes):
        """Asks for a state and waits for its frame, which is said to be seen."""
        self.say(self.state(**changes))
        while True:
            one = self.must("frame", "refused", "skipped")
            if one["type"] == "refused":
                return one
            self.say({"type": "seen", "frame": one["frame"]})
            if one["type"] == "frame" and one["serial"] == self.serial:
                return one

    def close(self):
        self.socket.close()


def holds(condition, what):
    if not condition:
        raise AssertionError(what)


def until(condition, seconds, what):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, f"{what}: not within {seconds} s"
        time.sleep(0.05)
