# SPDX-License-Identifier: MIT
"""How the console starts and ends: its command line, a page that comes early, and its last page."""

import glob
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time

from console_client import Console, Page, holds, until

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


def dropped(console, name, data, length=None):
    """A connection on which a page has begun to drop a file."""
    one = socket.create_connection((console.host, console.port), timeout=60)
    one.sendall(f"POST /drop?t={console.token}&name={name} HTTP/1.1\r\nHost: {console.place}\r\nOrigin: http://{console.place}\r\n"
                f"Content-Length: {length or len(data)}\r\n\r\n".encode() + data)
    return one


def drop(console, name, data=b"a patient's volume"):
    with dropped(console, name, data) as one:
        return one.recv(4096)


def copies_go():
    """Copies go with their console, also when its terminal has gone; those of one that was killed go when another one starts, and
    no others."""
    with tempfile.TemporaryDirectory() as work:
        os.environ["TMPDIR"] = work
        killed, held, ended, later = Console(BUILD, PLUGINS), Console(BUILD, PLUGINS), Console(BUILD, PLUGINS), None
        try:
            for console in (killed, held, ended):
                said = drop(console, "a.mha")
                holds(said.startswith(b"HTTP/1.1 200"), f"a file is not taken: {said}")
            holds(len(os.listdir(work)) == 3, f"copies: {os.listdir(work)}")
            ended.process.send_signal(signal.SIGHUP)
            holds(ended.wait(30) == 0 and len(os.listdir(work)) == 2, f"SIGHUP leaves {os.listdir(work)}")
            killed.process.kill()
            killed.wait(30)
            others = ["host_sim_console_" + "0" * 31, "host_sim_console_" + "g" * 32, "host_sim_console_" + "1" * 32]
            for other in others[:2]:
                os.mkdir(os.path.join(work, other))
            os.mkdir(os.path.join(work, "elsewhere"))
            with open(os.path.join(work, "elsewhere", "kept"), "w"):
                pass
            os.symlink("elsewhere", os.path.join(work, others[2]))
            later = Console(BUILD, PLUGINS)
            found = [name for name in os.listdir(work) if name not in [*others, "elsewhere"]]
            holds(len(found) == 2 and sorted(len(os.listdir(os.path.join(work, name))) for name in found) == [0, 1], f"after a start there are {found}")
            holds(set(others) < set(os.listdir(work)) and os.listdir(os.path.join(work, "elsewhere")) == ["kept"], f"what is no console's: {os.listdir(work)}")
        finally:
            for console in filter(None, (killed, held, ended, later)):
                console.end()
            del os.environ["TMPDIR"]


def a_slow_sender():
    """Who sends a byte now and then has the one place until another page wants it, half a minute later at the earliest."""
    with tempfile.TemporaryDirectory() as work:
        os.environ["TMPDIR"] = work
        console = Console(BUILD, PLUGINS)
        try:
            with dropped(console, "slow.mha", b"x", 10 ** 6) as slow:
                began = time.monotonic()
                until(lambda: glob.glob(os.path.join(work, "*", "*")), 60, "the slow sender's place")
                said = drop(console, "early.mha")
                holds(said.startswith(b"HTTP/1.1 413") or time.monotonic() - began > 25, f"two files at a time: {said}")
                while time.monotonic() - began < 31:
                    slow.sendall(b"x")
                    time.sleep(1)
                said = drop(console, "next.mha")
                holds(said.startswith(b"HTTP/1.1 200"), f"the next file is not taken: {said}")
            console.interrupt()
            holds(console.wait(60) == 0, "it does not end")
        finally:
            console.end()
            del os.environ["TMPDIR"]


def as_the_first_process():
    """In a container nobody else's signals end the first process: one ends the console, and a second one ends it at once."""
    command = ["unshare", "--pid", "--fork", "--mount-proc", "--kill-child", os.path.join(BUILD, "host_sim"), "console", *PLUGINS, "--stay"]
    if subprocess.run(["unshare", "--pid", "--fork", "--mount-proc", "true"], capture_output=True, check=False).returncode != 0:
        return print("not tried as the first process: no namespaces here")
    outer = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        outer.stdout.readline()
        with open(f"/proc/{outer.pid}/task/{outer.pid}/children") as children:
            console = int(children.read().split()[0])
        os.kill(console, signal.SIGTERM)
        holds(outer.wait(30) == 0, "SIGTERM does not end it")
    finally:
        outer.kill()
        outer.wait()
        outer.stdout.close()


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
        mib = memory(console, "VmRSS")
        holds(mib < 250 or os.environ.get("SV_SANITIZE"), f"after its pages the console has {mib} MiB")
        print(f"{mib} MiB after its pages")
    finally:
        console.end()


def memory(console, of):
    with open(f"/proc/{console.process.pid}/status") as status:
        return int(status.read().split(of + ":")[1].split()[0]) >> 10


def three_pages_at_a_time():
    """Pages that are open while another one draws have their volume and little more, also while files are dropped; and when they are asked they draw
    and write what they drew before. Kernels are compiled before, and more processors take no more."""
    seen = {"views": ["result", "across", "along", "deep"], "picture": 512, "lanes": [{"plugin": 0, "values": {"q": 0.4}}],
            "source": {"scene": "D01", "size": 128, "volumes": 1, "from": "probe"}}
    settings = {"env": {**os.environ, "POCL_MAX_PTHREAD_COUNT": "2", "POCL_CPU_MAX_CU_COUNT": "2"}}
    with tempfile.TemporaryDirectory() as work:
        scan = a_scan(work, seen["source"])
        for measured in (False, True):
            console = Console(BUILD, [*PLUGINS, "--stay", "--out", work], **settings)
            try:
                pages = [draw_beside_drops(console, seen, scan, n) for n in range(3 if measured else 1)]
                if measured:
                    at_most_250_mib(console)
                    draws_and_writes_as_before(pages[0], seen)
            finally:
                console.end()


def a_scan(work, source):
    """A scene's volume as a file has it."""
    subprocess.run([os.path.join(BUILD, "host_sim"), "scenes", source["scene"], "--size", str(source["size"]), "--export", "--out", work],
                   check=True, capture_output=True, timeout=900)
    with open(os.path.join(work, source["scene"] + "_full.mha"), "rb") as file:
        return file.read()


def draw_beside_drops(console, seen, scan, number):
    """A page that has drawn in two sizes, the second one of three a volume that was dropped, while other files are."""
    page = Page(console, timeout=600)
    folder = page.must("hello")["drop"]["folder"]
    source = {"folder": folder, "path": f"{number}.mha", "from": "probe"} if number == 1 else seen["source"]
    holds(drop(console, f"{number}.mha", scan).startswith(b"HTTP/1.1 200"), "a volume is not taken")
    for picture in (256, 512):
        with dropped(console, f"beside_{number}_{picture}.mha", scan) as beside:
            holds(page.show(**{**seen, "source": source, "picture": picture})["type"] == "frame", "there is no frame")
            holds(beside.recv(4096).startswith(b"HTTP/1.1 200"), "a volume is not taken while a page draws")
    time.sleep(1.7)  # a hand goes from one page to the next
    return page


def at_most_250_mib(console):
    most = memory(console, "VmHWM")
    holds(most <= 250 or os.environ.get("SV_SANITIZE"), f"three pages and what is dropped take {most} MiB")
    print(f"{most} MiB with three pages, while files are dropped")


def draws_and_writes_as_before(page, seen):
    before = {view: one[5] for view, one in page.pictures.items()}
    page.pictures.clear()
    page.say({"type": "do", "what": "write"})
    page.must("written")
    page.show(**seen)
    after = {view: one[5] for view, one in page.pictures.items()}
    holds(len(before) == 4 and after == before, "a page that was at rest draws other pictures")


def main():
    command_lines()
    who_comes_early()
    how_it_ends()
    copies_go()
    a_slow_sender()
    as_the_first_process()
    many_pages_leave_little()
    three_pages_at_a_time()
    print("ok")


main()
