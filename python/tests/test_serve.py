# SPDX-License-Identifier: MIT
"""smartvis serve against real peers: pyigtl's client and one on libOpenIGTLink, and peers that mean harm."""

import contextlib
import os
import resource
import shutil
import signal
import socket
import struct
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pyigtl
import pytest
from conftest import FETUS, LONG, SKIN, SOURCE, layers
from pyigtl.messages import CRC64, ImageMessage, MessageBase, StringMessage

import smartvis
from smartvis._work import Settings
from smartvis.cli import main
from smartvis.serve import Server

sys.path.append(str(SOURCE / "tests/support"))
import igtl_client  # type: ignore[import-not-found]


@contextlib.contextmanager
def serving(**keywords):
    """A server in this process at a free port; yields the port."""
    server = Server(Settings(parameters={"method": "wall"}), port=0, **{"patience": LONG} | keywords)
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.02})
    thread.start()
    try:
        yield server.server_address[1]
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


@pytest.fixture(scope="module")
def port():
    with serving(limit=64 << 20, clients=64) as number:
        yield number


def connect(port: int) -> socket.socket:
    peer = socket.create_connection(("127.0.0.1", port), timeout=LONG)
    peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return peer


def read_message(peer: socket.socket, check: bool = True):
    header, body = igtl_client.read_message(peer)
    fields = MessageBase.parse_header(header)
    assert not check or CRC64(body) == struct.unpack("> Q", header[50:])[0]
    message = MessageBase.create_message(fields["message_type"])
    message.unpack(fields, body)
    return message


def image(volume: np.ndarray, name: str = "Scan", spacing=(0.5, 0.6, 0.7)) -> ImageMessage:
    matrix = np.diag([*spacing, 1.0])
    matrix[:3, 3] = (10, 20, 30)
    return ImageMessage(volume, ijk_to_world_matrix=matrix, device_name=name, timestamp=1234.5)


def serves(port: int) -> None:
    """A volume goes through as if nothing had happened."""
    with connect(port) as peer:
        peer.sendall(image(layers((32, 32, 32))).pack())
        assert [read_message(peer).message_type for _ in range(3)] == ["IMAGE", "IMAGE", "STRING"]


def serves_again(port: int) -> None:
    """As soon as the server has noticed that others are gone, a volume goes through."""
    end = time.monotonic() + LONG
    while True:
        try:
            return serves(port)
        except OSError:
            assert time.monotonic() < end
            time.sleep(0.02)


def is_closed(peer: socket.socket) -> bool:
    """Waits until the server closes the connection; False if it says something."""
    try:
        return peer.recv(1) == b""
    except ConnectionResetError:
        return True


def test_what_comes_back_is_what_clip_gives(port: int, volume: np.ndarray) -> None:
    with connect(port) as peer:
        peer.sendall(image(volume).pack())
        clipped, depth, outcome = (read_message(peer) for _ in range(3))
    expected = smartvis.clip(volume, (0.5, 0.6, 0.7), method="wall")
    assert np.array_equal(clipped.image, expected.apply(volume))
    assert np.array_equal(depth.image[0], expected.depth_mm)
    assert outcome.string.split()[0] == "OK" and clipped.timestamp == pytest.approx(1234.5, abs=1e-6)
    assert [m.device_name for m in (clipped, depth, outcome)] == ["Scan_clipped", "Scan_depth", "Scan_outcome"]
    assert np.allclose(clipped.ijk_to_world_matrix, image(volume).ijk_to_world_matrix, atol=1e-4)
    corner = depth.ijk_to_world_matrix[:3, 3] - (10, 20, 30)  # of the machine's grid, around the same middle
    assert np.allclose(corner, expected.camera.to_volume_mm(np.zeros(3)), atol=1e-4)


def test_pyigtl_s_client_is_served(port: int, volume: np.ndarray) -> None:
    """Version 2 of the header is that of OpenIGTLink 3, as PLUS and Slicer speak it, with metadata."""
    client = pyigtl.OpenIGTLinkClient("127.0.0.1", port)
    message = image(volume, "Slicer")
    message.header_version, message.metadata = 2, {"Probe": "convex"}
    try:
        client.send_message(message)
        outcome = client.wait_for_message("Slicer_outcome", timeout=LONG)
        clipped = client.wait_for_message("Slicer_clipped", timeout=LONG)
        assert outcome.string.split()[0] == "OK"
        assert not (clipped.image[:, 8:-8, 8:-8] == SKIN).any() and (clipped.image[-1] == FETUS).all()
    finally:
        client.stop()


def test_a_client_on_libopenigtlink_is_served(port: int, tmp_path: Path) -> None:
    if not shutil.which("g++") or not Path("/usr/include/openigtlink/igtlClientSocket.h").exists():
        pytest.fail("g++ and the Debian package libopenigtlink-dev are needed: scripts/packages-python.txt")
    program = tmp_path / "igtl_client"
    source = Path(__file__).with_name("igtl_client.cpp")
    compiler = ["g++", "-std=c++17", "-isystem", "/usr/include/openigtlink", str(source), "-o", str(program)]
    subprocess.run([*compiler, "-lOpenIGTLink", "-pthread"], check=True)
    out = subprocess.run([program, str(port), "48"], capture_output=True, text=True, timeout=LONG, check=False)
    assert out.returncode == 0, out.stderr
    lines = dict(line.partition(" ")[::2] for line in out.stdout.splitlines())
    assert lines["Knob_set"].startswith("OK method=wall") and lines["Scan_outcome"].split()[0] == "OK"
    assert 7 <= float(lines["Scan_depth"]) <= 22 and "Scan_clipped" in lines  # mm


def test_parameters_come_by_string(port: int, volume: np.ndarray) -> None:
    with connect(port) as peer:
        depths = []
        for text in ("q=0.25", "q=0.75 method=mean"):
            peer.sendall(StringMessage(text, device_name="Knob").pack())
            assert read_message(peer).string.startswith("OK q=")
            peer.sendall(image(volume).pack())
            depths.append([read_message(peer) for _ in range(3)][1].image[0])
        for wrong in ("knob=1", "q=far", "q", "method=guess", "q=nan", "q=5", "q=-inf", "kernel=3.5"):
            peer.sendall(StringMessage(wrong, device_name="Knob").pack())
            assert read_message(peer).string.startswith("ERROR "), wrong
        peer.sendall(image(volume).pack())
        assert [read_message(peer) for _ in range(3)][2].string.split()[0] in ("OK", "PARTIAL")  # as it was set before
    for depth, q, method in zip(depths, (0.25, 0.75), ("wall", "mean"), strict=True):
        expected = smartvis.clip(volume, (0.5, 0.6, 0.7), q=q, method=method)
        assert np.array_equal(depth, expected.depth_mm)


def test_other_types_and_byte_orders(port: int, volume: np.ndarray) -> None:
    with connect(port) as peer:
        for kind in (">i2", "<u2", "<f4", ">f8"):
            peer.sendall(in_byte_order(volume, kind))
            clipped, _, outcome = (read_message(peer) for _ in range(3))
            assert outcome.string.split()[0] == "OK" and clipped.image.dtype.str[1:] == kind[1:], kind
            native = volume.astype(kind[1:])
            alone = smartvis.clip(native, (0.5, 0.6, 0.7), method="wall")
            assert np.array_equal(clipped.image, alone.apply(native))
        peer.sendall(image(np.full((8, 8, 8), np.nan, np.float32)).pack())
        assert read_message(peer).string.startswith("ERROR the volume: no voxel of it was scanned")


def in_byte_order(volume: np.ndarray, kind: str) -> bytes:
    """pyigtl sends little endian only: the voxels are turned here, and byte 4 of the body says so."""
    little = image(volume.astype("<" + kind[1:])).pack()
    body = bytearray(little[58:])
    if kind[0] == ">":
        body[4] = 1
        body[72:] = volume.astype(kind).tobytes()
    return little[:50] + struct.pack("> Q", CRC64(bytes(body))) + bytes(body)


def header(kind: bytes = b"IMAGE", size: int = 0, version: int = 1, checksum: int = 0) -> bytes:
    return struct.pack("> H 12s 20s II Q Q", version, kind, b"Scan", 0, 0, size, checksum)


def damaged() -> bytes:
    whole = bytearray(image(layers((16, 16, 16))).pack())
    whole[200] ^= 1
    return bytes(whole)


def absurd_image() -> bytes:
    """A right checksum over an image whose size is not that of its voxels."""
    body = bytearray(image(layers((8, 8, 8))).pack()[58:])
    body[6:8] = body[66:68] = b"\xff\xff"  # of the volume, and of the part that is sent: all
    return header(size=len(body), checksum=CRC64(bytes(body))) + bytes(body)


HARM = {
    "nonsense": np.random.default_rng(16).bytes(4096),
    "http": b"GET / HTTP/1.1\r\nHost: here\r\n\r\n" * 4,
    "four gigabytes": header(size=4 << 30),
    "all the bytes there are": header(size=(1 << 64) - 1),
    "a wrong checksum": damaged(),
    "an image that lies": absurd_image(),
    "an empty image": header(checksum=CRC64(b"")),
    "an unreadable type": header(kind=b"\xff" * 12),
}


@pytest.mark.parametrize("harm", HARM)
def test_harm_ends_the_connection_that_did_it(port: int, harm: str) -> None:
    with connect(port) as other:
        other.sendall(image(layers((32, 32, 32))).pack()[:1000])  # one that is in the middle of its own message
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        with connect(port) as peer:
            with contextlib.suppress(OSError):
                peer.sendall(HARM[harm])
            assert is_closed(peer)  # and nothing said
        assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 300 << 10  # KiB: no gigabytes
        other.sendall(image(layers((32, 32, 32))).pack()[1000:])
        assert [read_message(other).message_type for _ in range(3)] == ["IMAGE", "IMAGE", "STRING"]


def test_a_string_that_lies_is_answered(port: int) -> None:
    with connect(port) as peer:
        peer.sendall(header(b"STRING", 4, checksum=CRC64(b"\0\3\xff\xff")) + b"\0\3\xff\xff")
        assert read_message(peer).string.startswith(("OK", "ERROR"))
    serves(port)


def test_half_a_message_is_not_waited_for() -> None:
    whole = image(layers((32, 32, 32))).pack()
    with serving(patience=0.3) as number, contextlib.ExitStack() as peers:
        silent = peers.enter_context(connect(number))  # has begun no message, and so may wait
        for part in (whole[:20], whole[:58], whole[:5000]):
            peer = peers.enter_context(connect(number))
            peer.sendall(part)
            assert is_closed(peer)
        silent.setblocking(False)
        with pytest.raises(BlockingIOError):  # still connected, and nothing said
            silent.recv(1)


def test_clients_that_vanish_leave_nothing() -> None:
    whole = image(layers((48, 48, 48))).pack()
    with serving(clients=2) as number:
        for count in range(8):
            peer = connect(number)
            peer.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))  # a reset, not an end
            with contextlib.suppress(OSError):  # the room of the one before may not be free yet
                peer.sendall(whole)
                if count % 2:
                    peer.recv(100)  # the server is in the middle of its answer
            peer.close()
        serves_again(number)  # the room of the vanished is free


def test_a_silent_client_is_asked_whether_it_is_there(port: int) -> None:
    with connect(port) as peer:
        peer.sendall(image(layers((16, 16, 16))).pack())
        assert read_message(peer)
        for fd in map(int, os.listdir("/proc/self/fd")):  # the server is this process, too
            with contextlib.suppress(OSError), socket.socket(fileno=os.dup(fd)) as other:
                if other.getpeername() == peer.getsockname():
                    asked = [other.getsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE),
                             *(other.getsockopt(socket.IPPROTO_TCP, getattr(socket, f"TCP_KEEP{what}"))
                               for what in ("IDLE", "INTVL", "CNT"))]  # fmt: skip
    assert asked == [1, 60, 15, 4]


def test_a_client_too_many_is_turned_away() -> None:
    with serving(clients=1) as number:
        with connect(number) as first:
            first.sendall(image(layers((16, 16, 16))).pack())
            assert read_message(first)
            with connect(number) as second:
                assert is_closed(second)
        serves_again(number)


# `smartvis serve`, which waits as long for its clients as they for it, however busy the machine.
PATIENT = f"""import sys
from smartvis import cli, serve
serve.Server.__init__.__kwdefaults__["patience"] = {LONG}
sys.exit(cli.main(["serve", "--port", "0", *sys.argv[1:]]))"""


@contextlib.contextmanager
def command(*options: str):
    """`smartvis serve` as a program: its process and its port."""
    words = [sys.executable, "-P", "-c", PATIENT, *options]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        line = process.stdout.readline()
        assert "listening at 127.0.0.1:" in line
        yield process, int(line.split(":")[2].split(";")[0])
    finally:
        process.kill()
        process.communicate()


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 0)])
def test_the_command_serves_and_ends(number: signal.Signals, code: int) -> None:
    with command("--method", "wall") as (process, port):
        serves(port)
        process.send_signal(number)
        assert process.wait(LONG) == code


def high_water(pid: int) -> int:
    """MiB of memory that a process had at most."""
    status = Path(f"/proc/{pid}/status").read_text()
    return int(status.split("VmHWM:")[1].split()[0]) >> 10


def outcome(peer: socket.socket) -> str:
    """What a volume came to in words, behind its images if there are some."""
    while (message := read_message(peer)).message_type != "STRING":
        pass
    return message.string


def test_eight_clients_that_ask_for_the_largest_stay_within_the_limit() -> None:
    """How many of them are at once is the machine's affair."""
    with command("--memory", "256", "--all-memory", "400") as (process, number):
        serves(number)
        before = high_water(process.pid)
        with contextlib.ExitStack() as peers:
            clients = [peers.enter_context(connect(number)) for _ in range(8)]
            # The largest that the machine sees at 1 mm, and one of 1 MB that it sees as 126.
            shapes = [(1, 1990, 1990), (1, 1960, 1990), (2000, 1, 600)]
            for index, client in enumerate(clients):
                client.sendall(image(np.zeros(shapes[index % 3], np.uint8)).pack())
            assert all(outcome(client) for client in clients)
        assert high_water(process.pid) < before + 400
        serves_again(number)


def test_what_others_hold_is_no_room_for_a_client() -> None:
    """Two that have begun a message hold what it will take, 192 MiB each."""
    with command("--memory", "256", "--all-memory", "400") as (_, number), contextlib.ExitStack() as peers:
        begun = image(np.zeros((16, 1024, 1024), np.uint8)).pack()[: igtl_client.HEADER + 1]
        for _ in range(2):
            peers.enter_context(connect(number)).sendall(begun)
        asked, said = image(np.zeros((1, 1990, 1990), np.uint8)).pack(), ""
        end = time.monotonic() + LONG
        while "the volume takes 45 MiB here, and there is room for 15" not in said:  # until both are noticed
            assert time.monotonic() < end, said
            with connect(number) as client:
                client.sendall(asked)
                said = outcome(client)
        peers.close()
        serves_again(number)


def test_a_checksum_lets_other_threads_work() -> None:
    data = bytes(48 << 20)
    turns, ends = [0], threading.Event()

    def take_turns() -> None:
        while not ends.wait(0.001):
            turns[0] += 1

    thread = threading.Thread(target=take_turns)
    thread.start()
    assert CRC64(data[: 3 << 20] + b"x") == smartvis._igtl.messages().CRC64(data[: 3 << 20] + b"x")
    before = turns[0]
    smartvis._igtl.messages().CRC64(data)
    meanwhile = turns[0] - before
    ends.set()
    thread.join()
    assert meanwhile > 10  # of 48 parts; one that holds the lock to its end lets the other in two or three times


def test_a_port_that_is_taken_is_named(port: int, capsys) -> None:
    assert main(["serve", "--port", str(port)]) == 2 and f"--port {port}" in capsys.readouterr().err


def test_ipv6_is_listened_at_or_told(capsys) -> None:
    try:
        with socket.socket(socket.AF_INET6) as tried:
            tried.bind(("::1", 0))
    except OSError:
        assert main(["serve", "--host", "::1", "--port", "0"]) == 2
    else:
        with serving(host="::1") as number, socket.create_connection(("::1", number), timeout=LONG) as peer:
            assert ask(peer, query("GET_STATUS"))[0] == "STATUS"
        assert main(["serve", "--host", "2001:db8::1", "--port", "0"]) == 2  # an address of documents
    assert "::1 --port 0: this machine has no such IPv6 address" in capsys.readouterr().err


def ask(peer: socket.socket, data: bytes) -> tuple[str, str, bytes]:
    """Type, device name and body of what answers."""
    peer.sendall(data)
    header, body = igtl_client.read_message(peer)
    fields = MessageBase.parse_header(header)
    assert CRC64(body) == struct.unpack("> Q", header[50:])[0]
    return fields["message_type"], fields["device_name"], body


def query(kind: str) -> bytes:
    return struct.pack("> H 12s 20s II Q Q", 1, kind.encode(), b"Slicer", 0, 0, 0, 0)


def test_queries_are_answered_and_parts_of_volumes_refused(port: int) -> None:
    with connect(port) as peer:
        kind, name, body = ask(peer, query("GET_STATUS"))
        assert (kind, name) == ("STATUS", "Slicer")
        assert struct.unpack_from("> H q 20s", body) == (1, 0, b"OK".ljust(20, b"\0")) and body[30:] == b"ready\0"
        kind, name, body = ask(peer, query("GET_CAPABIL"))
        types = [body[at : at + 12].rstrip(b"\0") for at in range(0, len(body), 12)]
        assert kind == "CAPABILITY" and types == [b"GET_CAPABIL", b"GET_STATUS", b"IMAGE", b"STRING"]
        whole = image(layers((32, 32, 32))).pack()
        part = whole[58:124] + struct.pack("> 3H", 32, 32, 16) + whole[130:]  # half of the slices
        kind, name, body = ask(peer, whole[:50] + struct.pack("> Q", CRC64(part)) + part)
        assert (kind, name) == ("STATUS", "Scan") and struct.unpack_from("> H", body)[0] == 12
        assert b"a part of a volume (subvolume) is not taken" in body
        peer.sendall(whole)  # and the connection goes on
        assert [read_message(peer).message_type for _ in range(3)] == ["IMAGE", "IMAGE", "STRING"]
