# SPDX-License-Identifier: MIT
"""soak.py BUILD OUT [--frames N] [--seconds S] [--volumes N]: days of use in one. Frames of a scan loop as a hand makes them
(soak_frames.c, beside this), a console whose pages come and go, and `smartvis serve` with one volume after the other, side by side.
Memory, threads and descriptors of each are written to OUT/NAME.csv and drawn into OUT/soak.svg. Exit code 1 if one of them grows: if the
last third of the way holds more than the middle one did."""

import argparse
import contextlib
import os
import random
import re
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy
from pyigtl.messages import ImageMessage

sys.path[:0] = [str(Path(__file__).parents[1] / folder) for folder in ("host_sim/console", "support")]
from console_client import Console, Page, holds
from igtl_client import read_message

SAMPLES = 400
ROOM = {"MiB": (1.05, 3), "threads": (1, 0), "descriptors": (1, 0)}  # what the last third may hold: so many times the middle one, and so much more


def tree(pid):
    """A process and all that it has started."""
    found = [pid]
    for parent in found:
        with contextlib.suppress(OSError):
            for task in os.listdir(f"/proc/{parent}/task"):
                found += [int(child) for child in Path(f"/proc/{parent}/task/{task}/children").read_text().split()]
    return found


def held(pid):
    """MiB, threads and descriptors of a process with all that it has started."""
    mib = threads = descriptors = 0
    for one in tree(pid):
        with contextlib.suppress(OSError):  # it has ended meanwhile
            status = Path(f"/proc/{one}/status").read_text()
            mib += int(re.search(r"VmRSS:\s*(\d+)", status)[1]) / 1024
            threads += int(re.search(r"Threads:\s*(\d+)", status)[1])
            descriptors += len(os.listdir(f"/proc/{one}/fd"))
    return mib, threads, descriptors


class Soak(threading.Thread):
    """One of the programs. `work` yields how far it is, 0 .. 1, when it is at rest: that is when it is looked at."""

    def __init__(self, name, work, options):
        super().__init__(name=name)
        self.work, self.options, self.rows, self.failure = work, options, [], None

    def run(self):
        due = 0.0
        with (self.options.out / f"{self.name}.csv").open("w", buffering=1) as table:  # a line as it comes: it is seen on the way
            table.write("done,MiB,threads,descriptors\n")
            try:
                for done, pid in self.work(self.options):
                    if done >= due:
                        self.rows.append((done, *held(pid)))
                        table.write("{:.4f},{:.1f},{},{}\n".format(*self.rows[-1]))
                        due += 1 / SAMPLES
            except Exception as failure:  # noqa: BLE001, every one is told in the end
                self.failure = failure

    def verdict(self):
        """What grows, or broke, as sentences."""
        if self.failure or not self.rows or self.rows[-1][0] < 1 - 2 / SAMPLES:
            return [f"{self.name}: {self.failure or 'it has not come to its end'}"]
        said = []
        for column, (what, (times, more)) in enumerate(ROOM.items(), 1):
            middle, last = (sorted(row[column] for row in self.rows if low <= row[0] <= low + 1 / 3) for low in (1 / 3, 2 / 3))
            if len(middle) < 3 or len(last) < 3:
                return [f"{self.name}: {len(self.rows)} looks at it are too few"]
            # Medians: who comes and goes is seen at any moment.
            before, after = middle[len(middle) // 2], last[len(last) // 2]
            print(f"soak: {self.name}: {what}: {before:.0f}, then {after:.0f}; at most {max(row[column] for row in self.rows):.0f}")
            if after > before * times + more:
                said.append(f"{self.name}: {what} grow from {before:.1f} to {after:.1f}")
        return said


def frames(options):
    command = [options.build / "tests/soak_frames", options.build / "smartvis.so", str(options.frames), str(options.seed)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as program:
        for line in program.stdout:
            if line.strip().isdigit() and int(line) < options.frames:
                yield int(line) / options.frames, program.pid
            elif not line.strip().isdigit():
                print(f"soak: frames: {line.strip()}")
        holds(program.wait() == 0, f"soak_frames ends with {program.returncode}")


def any_state(page, dice):
    views = ["result", "full", "depthmap", "across", "along", "deep"]
    return page.show(source={"scene": dice.choice(["D01", "E02"]), "size": dice.choice([32, 48, 64]), "volumes": dice.choice([1, 3]), "from": "probe"},
                     camera={"yaw": dice.uniform(-90, 90), "pitch": dice.uniform(-45, 45), "roll": 0, "zoom": dice.uniform(1, 3)},
                     views=dice.sample(views, dice.randint(1, 4)), picture=dice.choice([64, 128]),
                     lanes=[{"plugin": 0, "values": {"q": dice.uniform(0, 1)}}],
                     marks=[] if dice.random() < 0.7 else [[10, 10, 10, 5, 0]])


def console(options):
    """Up to three pages, which come, look around and go; files are dropped. It is looked at when no page is left."""
    dice, pages, began = random.Random(options.seed), [], time.monotonic()
    server = Console(str(options.build), ["--plugin", str(options.build / "smartvis.so"), "--stay"])
    visits = 0
    try:
        while time.monotonic() - began < options.seconds:
            for _ in range(dice.randint(1, 3)):
                pages.append(Page(server, timeout=600))
                pages[-1].must("hello")
            for _ in range(dice.randint(1, 20)):
                said = any_state(dice.choice(pages), dice)
                holds(said["type"] == "frame", f"a page is told {said}")
            name = f"{visits % 50}.mha"
            data = b"no volume" * dice.randint(1, 10000)
            server.ask(f"POST /drop?t={server.token}&name={name} HTTP/1.1\r\nHost: {server.place}\r\nOrigin: http://{server.place}\r\n"
                       f"Connection: close\r\nContent-Length: {len(data)}\r\n\r\n".encode() + data)
            visits += len(pages)
            while pages:
                pages.pop().close()
            time.sleep(0.5)  # until their threads have ended
            yield min(1.0, (time.monotonic() - began) / options.seconds), server.process.pid
        print(f"soak: console: {visits} pages")
        yield 1.0, server.process.pid
        server.interrupt()
        holds(server.wait(60) == 0, "the console does not end well")
    finally:
        server.end()


def serve(options):
    """Volumes of two sizes in turns, a new connection for each thousand."""
    def message(side):
        volume = numpy.full((side,) * 3, 200, numpy.uint8)
        volume[: 3 * side // 5] = 10
        volume[: side // 5] = 100
        return ImageMessage(volume, ijk_to_world_matrix=numpy.diag([1.0, 1.0, 1.0, 1.0]), device_name="Scan").pack()

    whole = [message(side) for side in (24, 28)]
    command = [sys.executable, "-P", "-m", "smartvis", "serve", "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        try:
            port = int(server.stdout.readline().split(":")[2].split(";")[0])
            sent = 0
            while sent < options.volumes:
                with socket.create_connection(("127.0.0.1", port)) as peer:
                    peer.settimeout(600)
                    for _ in range(min(1000, options.volumes - sent)):
                        peer.sendall(whole[sent // 100 % len(whole)])
                        for _ in range(3):
                            _, body = read_message(peer)
                        holds(body[4:].split()[0] in (b"OK", b"NO_SURFACE", b"PARTIAL"), f"a volume is answered with {body[4:60]}")
                        sent += 1
                        yield sent / options.volumes, server.pid
        finally:
            server.terminate()


def draw(soaks, path):
    """Three curves for each program, over its way."""
    wide, high, gap, parts = 320, 130, 46, []
    for row, soak in enumerate(soaks):
        for column, what in enumerate(ROOM, 1):
            left, top = gap + (column - 1) * (wide + gap), gap + row * (high + gap)
            most = max([one[column] for one in soak.rows] or [1]) * 1.1
            points = " ".join(f"{left + wide * one[0]:.1f},{top + high * (1 - one[column] / most):.1f}" for one in soak.rows)
            parts += [f'<text x="{left}" y="{top - 6}">{soak.name}: {what}, 0 to {most:.0f}</text>',
                      f'<rect x="{left}" y="{top}" width="{wide}" height="{high}" fill="none" stroke="#999"/>',
                      f'<polyline points="{points}" fill="none" stroke="#06c"/>']
    size = f'width="{3 * (wide + gap) + gap}" height="{len(soaks) * (high + gap) + gap}"'
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {size} font-family="sans-serif" font-size="13"><rect width="100%" height="100%" fill="#fff"/>'
                    + "".join(parts) + "</svg>\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("build", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--frames", type=int, default=200_000)
    parser.add_argument("--seconds", type=int, default=3600)
    parser.add_argument("--volumes", type=int, default=50_000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    soaks = [Soak(work.__name__, work, options) for work in (frames, console, serve)]
    for soak in soaks:
        soak.start()
    for soak in soaks:
        soak.join()
    draw(soaks, options.out / "soak.svg")
    said = [sentence for soak in soaks for sentence in soak.verdict()]
    for sentence in said:
        print(f"soak: FAIL: {sentence}")
    print(f"soak: drawn in {options.out}/soak.svg")
    return 1 if said else 0


if __name__ == "__main__":
    sys.exit(main())
