# SPDX-License-Identifier: MIT
"""How the console starts and ends: its command line, a page that comes early, and its last page."""

import os
import signal
import socket
import subprocess
import sys
import time

from console_client import Console, Page, holds

BUILD = sys.argv[1]
NIGHT = "SV_NIGHT" in os.environ
PLUGINS = ["--plugin", os.path.join(BUILD, "smartvis.so"), "--plugin", os.path.join(BUILD, "tests/plugins/by_crash.so")]


def command_lines():
    for arguments, code, text in ((["/no/such/folder"], 3, "/no/such/folder: is no folder"), (["--port", "99999"], 2, "--port"),
                                  (["--listen", "example.org"], 2, "'example.org' is no address"), (["--nonsense"], 2, "--nonsense"),
                                  (["--listen", "192.0.2.77"], 1, "cannot listen on 192.0.2.77")):
        done = subprocess.run([os.path.join(BUILD, "host_sim"), "console", *arguments], capture_output=True, text=True, timeout=900, check=False)
        holds(done.returncode == code and text in done.stderr, f"{arguments}: {done.returncode}, {done.stderr}")


def who_comes_early():
    """Requests that come while the console starts find its own address right."""
    for _ in range(30 if NIGHT else 6):
        with socket.socket() as one:
            one.bind(("127.0.0.1", 0))
            port = one.getsockname()[1]
        console = subprocess.Popen([os.path.join(BUILD, "host_sim"), "console", *PLUGINS, "--port", str(port)], stdout=subprocess.DEVNULL)
        try:
            said = b""
            while not said:
                holds(console.poll() is None, "the console has not started")
                try:
                    with socket.create_connection(("127.0.0.1", port), timeout=30) as one:
                        one.sendall(f"GET /console.css HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n".encode())
                        said = one.recv(64)
                except ConnectionRefusedError:
                    pass
            holds(said.startswith(b"HTTP/1.1 200"), f"an early request is answered with {said[:40]}")
        finally:
            console.kill()
            console.wait()


def how_it_ends():
    """It outlives its last page by 30 s, in which a page may come back; with --stay it goes on."""
    ends, stays = Console(BUILD, PLUGINS), Console(BUILD, [*PLUGINS, "--stay"])
    try:
        for console in (ends, stays):
            page = Page(console)
            page.text("hello")
            page.close()
        time.sleep(3)
        page = Page(ends)
        page.text("hello")
        closed = time.monotonic()
        page.close()
        holds(ends.wait(60) == 0, "the last page has closed, and it goes on")
        holds(time.monotonic() - closed >= 30, f"it ends {time.monotonic() - closed} s after its last page")
        holds(stays.process.poll() is None, "--stay does not keep it")
        stays.process.send_signal(signal.SIGTERM)
        holds(stays.wait(30) == 0, "SIGTERM does not end it with 0")
    finally:
        ends.end()
        stays.end()


def many_pages_leave_little():
    """What worked for a page that has closed is gone with it, at night sixty times: the threads' memory, too."""
    console = Console(BUILD, [*PLUGINS, "--stay"])
    try:
        for n in range(60 if NIGHT else 12):
            page = Page(console)
            holds(page.show(camera={"yaw": n, "pitch": 0, "roll": 0, "zoom": 1}, picture=256)["type"] == "frame", "there is no frame")
            page.close()
            time.sleep(0.2)  # four pages at most: this one's room is free again
        time.sleep(1)
        with open(f"/proc/{console.process.pid}/status") as status:
            mib = int(status.read().split("VmRSS:")[1].split()[0]) >> 10
        holds(mib < 250 or os.environ.get("SV_SANITIZE"), f"after its pages the console has {mib} MiB")
        print(f"{mib} MiB after its pages")
    finally:
        console.end()


def main():
    command_lines()
    who_comes_early()
    how_it_ends()
    many_pages_leave_little()
    print("ok")


main()
