# SPDX-License-Identifier: MIT
"""The console's page beside a reader, as `smartvis console` is one: files of other formats are opened, pictures and cines become DICOM.
The reader is this test, which makes neither, so what the page and the console do with its answers is seen."""

import contextlib
import json
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import threading

import console_look
from console_client import Console, holds, until
from console_look import PATIENCE, Tab, choose, settle

BUILD = sys.argv[1]
HOST_SIM = os.path.join(BUILD, "host_sim")


class Reader:
    """Answers as the Python package does: a file of any name is the scan; DICOM is b"DICOM " and the picture."""

    def __init__(self, scan):
        self.scan, self.asked, self.pictures = scan, [], []
        self.own, self.theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        threading.Thread(target=self.serve, daemon=True).start()

    def serve(self):
        while question := self.own.recv(65536):
            what, path, of = question.decode().split("\n", 2)
            self.asked.append((what, os.path.basename(path), of))
            self.own.send(getattr(self, what)(path, of).encode())
        self.own.close()

    def read(self, path, room):
        folder, name = os.path.split(path)
        if name.startswith("bad"):
            return f"-{name}: is no volume of mine"
        holds(int(room) == (2 << 30) - sum(os.path.getsize(os.path.join(folder, one)) for one in os.listdir(folder)), f"there is room for {room} bytes")
        paths = [f"{name} volume {n}.copy.mha" for n in (1, 2)]
        for one in paths:
            shutil.copy(self.scan, os.path.join(folder, one))
        os.remove(path)
        return "+" + json.dumps({"paths": paths, "told": "Two places disagree"})

    def dicom(self, path, of):
        if of.startswith("later"):
            return "-The scan is of two patients"
        with open(path, "rb") as picture, open(path + ".dcm", "wb") as out:
            self.pictures.append(picture.read())
            out.write(b"DICOM " + self.pictures[-1])
        return "+" + path + ".dcm"


def drop(b, path):
    data = {"items": [], "files": [path], "dragOperationsMask": 1}
    for kind in ("dragEnter", "dragOver", "drop"):
        b.devtools("Input.dispatchDragEvent", type=kind, x=200, y=300, data=data)


def other_formats_are_opened(b, reader, work):
    """All volumes of a file are offered by its name and the first is shown; what the reader tells stays until it is closed, what it refuses is said."""
    for name in ("scan.nii.gz", "bad.nrrd", "later.dcm"):
        with open(os.path.join(work, name), "wb") as file:
            file.write(b"of another format")
    drop(b, os.path.join(work, "scan.nii.gz"))
    b.wait_for("state.source.path === 'scan.nii.gz volume 1.copy.mha'", "a dropped file")
    settle(b, "a dropped file")
    offered = b.run("return [...at('source').options].map((o) => o.text).filter((text) => text.startsWith('scan'))")
    holds(offered == ["scan.nii.gz volume 1", "scan.nii.gz volume 2"] and b.run("return lastFigures.source.voxels") == [64, 64, 64], f"offered are {offered}")
    holds(b.run("return at('notice').hidden ? '' : at('notice').firstElementChild.textContent") == "Two places disagree", "what is told is not said")
    drop(b, os.path.join(work, "bad.nrrd"))
    b.wait_for("at('notice').textContent.includes('bad.nrrd: is no volume of mine')", "a refusal")
    holds(b.run("return state.source.path") == "scan.nii.gz volume 1.copy.mha", "what is refused is opened")
    b.run("closeNotice()")
    holds([one[:2] for one in reader.asked] == [("read", "scan.nii.gz"), ("read", "bad.nrrd")], f"asked: {reader.asked}")


def saved(b, work, name):
    size, path = int(b.wait_for("document.body.dataset.snapshot", name)), os.path.join(work, name)
    until(lambda: os.path.exists(path) and os.path.getsize(path) == size, PATIENCE, name)
    with open(path, "rb") as file:
        return file.read()


def pictures_become_dicom(b, reader, work):
    """The reader gets the picture with its caption, or a cine with all its pictures, and the copy that they are of."""
    holds(b.run("return [at('snapshot-dicom').checkVisibility(), at('no-dicom').hidden]") == [True, True], "DICOM is not offered")
    b.run("at('snapshot-view').value = 'result'; delete document.body.dataset.snapshot")
    b.click("#snapshot-dicom")
    holds(saved(b, work, "smartvis_scan.nii.gz_volume_1_result.dcm") == b"DICOM " + reader.pictures[0], "another file is saved")
    wide, high = (int.from_bytes(reader.pictures[0][at:at + 4], "big") for at in (16, 20))
    holds(wide == 512 and high > 560 and reader.asked[-1] == ("dicom", "picture.png", "scan.nii.gz volume 1.copy.mha"), f"{wide} x {high}, {reader.asked[-1]}")
    choose(b, "cine-as", "dcm")
    b.run("at('with-caption').checked = false; delete document.body.dataset.snapshot")
    b.click("#cine")
    saved(b, work, "smartvis_scan.nii.gz_volume_1_result_cine.dcm")
    frames = int.from_bytes(reader.pictures[1].split(b"acTL")[1][:4], "big")
    holds(frames == 36 and reader.asked[-1] == ("dicom", "picture.png", "scan.nii.gz volume 1.copy.mha"), f"{frames} pictures, {reader.asked[-1]}")
    b.wait_for("at('cine').textContent === 'Save a cine'", "the end of a cine")
    choose(b, "source", "scene D01", then="a scene")
    b.run("delete document.body.dataset.snapshot")
    b.click("#snapshot-dicom")
    saved(b, work, "smartvis_D01_result.dcm")
    holds(reader.asked[-1] == ("dicom", "picture.png", ""), f"of a scene: {reader.asked[-1]}")


def what_fails_is_said(b, reader, work, copies):
    """A reader that refuses, and one that has gone: each is a sentence, and nothing is left behind."""
    drop(b, os.path.join(work, "later.dcm"))
    b.wait_for("state.source.path === 'later.dcm volume 1.copy.mha'", "another dropped file")
    settle(b, "another dropped file")
    b.click("#snapshot-dicom")
    b.wait_for("at('notice').textContent.includes('The scan is of two patients')", "why there is no DICOM")
    reader.own.shutdown(socket.SHUT_RDWR)
    drop(b, os.path.join(work, "bad.nrrd"))
    b.wait_for("at('notice').textContent.includes('has gone')", "a reader that has gone")
    (folder,) = [name for name in os.listdir(copies) if name.startswith("host_sim_console_")]
    left = sorted(os.listdir(os.path.join(copies, folder)))
    holds(left == [f"{name} volume {n}.copy.mha" for name in ("later.dcm", "scan.nii.gz") for n in (1, 2)], f"left are {left}")
    b.run("closeNotice()")


def without_a_reader(work):
    """No DICOM is offered, and the page says where it is; a number that is no socket is refused."""
    with console_look.a_page(BUILD, "#scene=D01,64,1", []) as (b, console, _):
        settle(b, "the first frame")
        found = b.run("return [at('snapshot-dicom').hidden, [...at('cine-as').options].some((o) => o.value === 'dcm'), at('no-dicom').checkVisibility(), at('no-dicom').textContent]")
        holds(found[:3] == [True, False, True] and "smartvis console" in found[3], f"without a reader: {found}")
        drop(b, os.path.join(work, "scan.nii.gz"))
        b.wait_for("at('notice').textContent.includes('The page of \"smartvis console\" opens NRRD, NIfTI and DICOM')", "how it is opened")
        for origin, code in ((console.place, 400), ("evil.example", 403)):
            head = f"POST /dicom?of=&t={console.token} HTTP/1.1\r\nHost: {console.place}\r\nOrigin: http://{origin}\r\nContent-Length: 5\r\n\r\nabcde"
            status, _, body = console.ask(head.encode())
            holds(status == code, f"DICOM is asked for from {origin}: {status}, {body}")
    for number in ("77", "3"):
        ended = subprocess.run([HOST_SIM, "console", "--reader", number], capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL)
        holds(ended.returncode == 2 and f"--reader {number}: is no socket" in ended.stderr, f"--reader {number}: {ended}")


def main():
    with tempfile.TemporaryDirectory() as work, contextlib.ExitStack() as ends:
        subprocess.run([HOST_SIM, "scenes", "D01", "--size", "64", "--export", "--out", work], check=True, stdout=subprocess.DEVNULL, timeout=900)
        copies = os.environ["TMPDIR"] = os.path.join(work, ".copies")
        os.mkdir(copies)
        reader = Reader(os.path.join(work, "D01_full.mha"))
        fd = reader.theirs.fileno()
        console = Console(BUILD, ["--reader", str(fd), "--out", os.path.join(work, "out")], pass_fds=[fd])
        ends.callback(console.end)
        reader.theirs.close()
        b = Tab(work)
        ends.callback(b.close)
        b.open(console.address + "#scene=D01,64,1", then="the first frame")
        other_formats_are_opened(b, reader, work)
        pictures_become_dicom(b, reader, work)
        what_fails_is_said(b, reader, work, copies)
        lines = [line for line in b.console() if "400" not in line]  # which the browser says of an answer
        holds(lines == [], f"the browser's console is not empty: {lines}")
        console.interrupt()
        holds(console.wait(60) == 0, "it does not end")
        without_a_reader(work)
    print("ok")


main()
