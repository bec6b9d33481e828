# SPDX-License-Identifier: MIT
"""The console behind a proxy: under a path, as gateways and notebook servers show it, in a browser; and under another name, with TLS
at the proxy, on bare sockets."""

import os
import socket
import subprocess
import sys
import tempfile
import threading

from console_client import Console, Page, holds
from console_look import Tab
from webdriver import programs

BUILD = sys.argv[1]
PREFIX = b"/user/a/proxy"
PLUGIN = ["--plugin", os.path.join(BUILD, "smartvis.so")]


def pump(source, sink):
    try:
        while data := source.recv(65536):
            sink.sendall(data)
        sink.shutdown(socket.SHUT_WR)
    except OSError:
        pass


def forward(client, console):
    """One connection: its first line's path without the prefix, all else as it is."""
    with client, socket.create_connection((console.host, console.port)) as server:
        head = b""
        while b"\r\n" not in head and (data := client.recv(65536)):
            head += data
        if not head.split(b" ", 1)[-1].startswith(PREFIX + b"/"):
            client.sendall(b"HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\nConnection: close\r\n\r\n")
            return
        server.sendall(head.replace(PREFIX, b"", 1))
        back = threading.Thread(target=pump, args=(server, client))
        back.start()
        pump(client, server)
        back.join()


def serve(listener, console):
    while True:
        try:
            client, _ = listener.accept()
        except OSError:
            return
        threading.Thread(target=forward, args=(client, console), daemon=True).start()


def under_a_path():
    """Page, pictures and a dropped file go the way that the page came."""
    with tempfile.TemporaryDirectory() as work, socket.create_server(("127.0.0.1", 0)) as listener:
        console, b = Console(BUILD, PLUGIN), None
        threading.Thread(target=serve, args=(listener, console), daemon=True).start()
        try:
            b = Tab(work)
            b.open(f"http://127.0.0.1:{listener.getsockname()[1]}{PREFIX.decode()}/?t={console.token}#scene=D01,64,1", then="a page under a path")
            holds(b.run("return lastFigures.lanes[0].clipped"), "nothing is clipped")
            said = b.run("return fetch('drop?' + new URLSearchParams({ t: token(), name: 'x.mha' }), { method: 'POST', body: 'no volume' }).then((a) => a.status)")
            holds(said == 200, f"a dropped file is answered with {said}")
            b.run("takeFile(new File(['no volume'], 'y.mha'))")
            b.wait_for("at('notice').textContent.includes('y.mha')", "why a file is no volume")
            holds(b.console() == [], "the browser's console is not empty")
        finally:
            if b:
                b.close()
            console.end()


def under_another_name():
    """--behind: its Host and its Origin are let in, no other name is; the address that is printed is the proxy's."""
    program = os.path.join(BUILD, "host_sim")
    for wrong in ("scan.example", "ftp://scan.example/", "https:///", "https://scan.example", "https://scan.example/x", "https://a b/", "https://x/?y/", "https://" + "x" * 600 + "/"):
        done = subprocess.run([program, "console", "--behind", wrong], capture_output=True, text=True, timeout=900, check=False)
        holds(done.returncode == 2 and "--behind" in done.stderr, f"{wrong}: {done.returncode}, {done.stderr}")
    console = subprocess.Popen([program, "console", *PLUGIN, "--behind", "https://scan.example/u/", "--port", "0"], stdout=subprocess.PIPE, text=True)
    try:
        address = console.stdout.readline().split()[1]
        holds(address.startswith("https://scan.example/u/?t="), f"it prints {address}")
    finally:
        console.kill()
        console.wait()
        console.stdout.close()
    with socket.create_server(("127.0.0.1", 0)) as one:
        port = one.getsockname()[1]
    behind = Behind(port)
    try:
        for host, wanted in (("scan.example", 200), (f"127.0.0.1:{port}", 200), ("scan.example.org", 403), ("xscan.example", 403), ("scan.example:1", 403)):
            status = behind.request("/?t=" + behind.token, host=host)[0]
            holds(status == wanted, f"Host {host}: {status}")
        for origin, wanted in (("https://scan.example", True), ("http://scan.example", False), ("https://scan.example.org", False), ("https://other.example", False)):
            page = Page(behind, headers={"Host": "scan.example", "Origin": origin})
            holds(page.open == wanted, f"Origin {origin}: {page.open}")
            page.close()
    finally:
        behind.end()


class Behind(Console):
    """A console that says the proxy's address, at a port that is known."""

    def __init__(self, port):
        self.process = subprocess.Popen([os.path.join(BUILD, "host_sim"), "console", *PLUGIN, "--behind", "https://scan.example/u/", "--port", str(port)],
                                        stdout=subprocess.PIPE, text=True)
        self.token = self.process.stdout.readline().split("?t=")[1].strip()
        self.host, self.port, self.place = "127.0.0.1", port, f"127.0.0.1:{port}"


def main():
    programs()
    under_another_name()
    under_a_path()
    print("ok")


main()
