# SPDX-License-Identifier: MIT
"""The console's server on bare sockets: who gets in, what it refuses, and that nothing a page does stops it."""

import json
import os
import socket
import subprocess
import sys
import tempfile
import threading
import time

from console_client import Console, Page, holds, until

BUILD = sys.argv[1]
PLUGINS = ["--plugin", os.path.join(BUILD, "smartvis.so"), "--plugin", os.path.join(BUILD, "tests/plugins/by_crash.so")]


def has_our_headers(head, what):
    for wanted in ("default-src 'none'", "frame-ancestors 'none'", "nosniff", "no-referrer", "no-store"):
        holds(wanted in head, f"{what}: its headers lack {wanted}")


def what_the_library_refuses(console):
    """Requests that never come to the console's own code are answered as those that do."""
    host = f"Host: {console.place}\r\n"
    for what, request in {"nonsense": "nonsense\r\n\r\n", "another version": f"GET / HTTP/9.9\r\n{host}\r\n",
                          "half a request": "GET / HT", "too long a head": "GET / HTTP/1.1\r\nX: " + "x" * 9000 + "\r\n\r\n",
                          "a length that is none": f"GET / HTTP/1.1\r\n{host}Content-Length: x\r\n\r\n",
                          "no WebSocket": f"GET /live?t={console.token} HTTP/1.1\r\n{host}\r\n"}.items():
        status, head, body = console.ask(request.encode())
        holds(400 <= status < 600, f"{what}: {status}")
        has_our_headers(head, what)
        holds(b"/" not in body, f"{what}: {body}")
    for path in ("/console.css%00", "/console.css%00.html", "/%00", f"/?t={console.token}%00", f"/?t={console.token}&x=%00", "/live%00"):
        holds(console.request(path)[0] == 400, f"{path} is answered")


def slow_sockets(console):
    """Connections that never say all of it, or never take their answer, and a page meanwhile: others need not wait until they are
    given up, which takes 3 s. The first to come are given up when 64 have come after them."""
    page = let_in(console, "a page before slow sockets")
    for count, text in ((50, "GET / HT"), (200, "GET / HT"), (500, "GET / HT"), (500, f"GET /console.js HTTP/1.1\r\nHost: {console.place}\r\n\r\n")):
        slow = []
        start = time.monotonic()
        for i in range(count):
            slow.append(socket.socket())
            slow[i].setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
            slow[i].settimeout(30)
            slow[i].connect((console.host, console.port))
            slow[i].sendall(text[: i % 9 if count < 500 else None].encode())
        holds(console.request("/?t=" + console.token)[0] == 200, f"{count} slow sockets lock everybody out")
        seconds = time.monotonic() - start
        holds(seconds < 2, f"{count} slow sockets: a request is answered after {seconds:.1f} s")
        slow[0].settimeout(0.5)
        try:
            slow[0].recv(1)
            holds(count > 64, "one of 50 slow sockets is given up at once")
        except ConnectionError:
            holds(count > 64, "one of 50 slow sockets is given up at once")
        except TimeoutError:
            holds(count <= 64, f"the first of {count} slow sockets is kept")
        holds(page.show()["type"] == "frame", f"{count} slow sockets: a page stands still")
        for one in slow:
            one.close()
    page.close()


def what_may_be_dropped(console):
    """The console's own page with the token alone, by a name that is one in the folder of copies, and not more than there is room for."""
    path = f"/drop?name=..%2F..%2Fa.mha&t={console.token}"
    ours = f"Origin: http://{console.place}"
    for at, origin, bytes_, sent, code, said in (
            (path, "X-None: 1", 5, b"abcde", 403, b""), (path, "Origin: http://evil.example", 5, b"abcde", 403, b""), (path[:-1], ours, 5, b"abcde", 403, b""),
            (path, ours, 0, b"", 411, b"The file is empty."), (path, ours, 3 << 30, b"", 413, b"2 GiB"), (path.replace(".mha", ".so"), ours, 5, b"abcde", 400, b"only .mha"),
            (path, ours, 5, b"ab", 400, b"a.mha: did not come whole."), (path, ours, 5, b"abcde", 200, b"_._.._a.mha"), (path, ours, 5, b"abcde", 200, b"2_.._.._a.mha")):
        head = f"POST {at} HTTP/1.1\r\nHost: {console.place}\r\n{origin}\r\nContent-Length: {bytes_}\r\n\r\n"
        status, _, body = console.ask(head.encode() + sent)
        holds(status == code and said in body, f"{head}: {status}, {body}")
    # All that was dropped counts: ten bytes by now, so the last of 2 GiB have no room.
    for bytes_, code in (((2 << 30) - 9, 413), ((2 << 30) - 10, 400)):  # 400: it did not come whole
        head = f"POST {path} HTTP/1.1\r\nHost: {console.place}\r\n{ours}\r\nContent-Length: {bytes_}\r\n\r\n"
        status, _, body = console.ask(head.encode() + b"abc")
        holds(status == code, f"{bytes_} bytes after ten: {status}, {body}")


def pages_and_files(console):
    status, head, body = console.request("/?t=" + console.token)
    holds(status == 200 and b"<title>SmartVis console" in body, "the page does not come")
    has_our_headers(head, "the page")
    holds(b"http://" not in body and b"https://" not in body, "the page names something outside")
    for name, kind in (("/console.css", "text/css"), ("/console.js", "text/javascript")):
        status, head, body = console.request(name)
        holds(status == 200 and kind in head and body, f"{name} does not come")
    status, _, body = console.request("/?t=" + console.token, "HEAD")
    holds(status == 200 and body == b"", "HEAD has a body")
    for path in ("/", "/?t=", "/?t=" + "0" * 32, "/?t=" + console.token + "0", "/?x=" + console.token):
        holds(console.request(path)[0] == 403, f"{path} is let in")
    for path in ("/console.html", "/etc/passwd", "/../../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/console.css/..", "//"):
        holds(console.request(path)[0] in (400, 403, 404), f"{path} is answered")
    holds(console.request("/?t=" + console.token, "POST", {"Content-Length": "0"})[0] == 405, "POST is taken")
    holds(console.request("/?t=" + console.token, host="localhost:9000")[0] == 200, "the page does not come through a tunnel")
    for host in ("evil.example", f"evil.example:{console.port}", f"127.0.0.1.evil.example:{console.port}"):
        for path in ("/?t=" + console.token, "/console.js"):
            holds(console.request(path, host=host)[0] == 403, f"Host {host} gets {path}")
    status = console.request("/?t=" + console.token, headers={"X-Long": "x" * 20000})[0]
    holds(status != 200, "a head of 20000 bytes is taken")


def who_gets_in(console):
    for what, changes in {"no Origin": {"Origin": None}, "another Origin": {"Origin": "http://evil.example"},
                          "Origin null": {"Origin": "null"}, "another port": {"Origin": f"http://127.0.0.1:{console.port + 1}"},
                          "another Host": {"Host": "evil.example:" + str(console.port), "Origin": "http://evil.example:" + str(console.port)},
                          }.items():
        page = Page(console, headers=changes)
        holds(not page.open, f"{what}: let in")
        page.close()
    for path in ("/live", "/live?t=", "/live?t=" + "f" * 32, "/live?t=" + console.token[:-1]):
        page = Page(console, path)
        holds(not page.open, f"{path}: let in")
        page.close()


def what_is_listed(page):
    hello = page.text("hello")
    holds([one["path"] for one in hello["files"]] == ["inside.mha", "sub/deep.mha"], f"files: {hello['files']}")
    holds([one["name"] for one in hello["scenes"]][:2] == ["E01", "E02"], "no scenes")
    holds(len(hello["plugins"]) == 2, "no plugins")


def values_of_an_enum(page):
    page.say(page.state())
    method = next(p for p in page.text("plugin")["params"] if p["key"] == "method")
    holds([one["value"] for one in method["names"]]== [0, 1, 2, 7], f"methods: {method['names']}")
    lane = page.show(lanes=[{"plugin": 0, "values": {"method": 4}}])["lanes"][0]
    holds(lane["failed"] and "method is 4, which is none of its values" in lane["words"], f"a retired value: {lane}")


def a_picture(page):
    frame = page.show(views=["result", "full", "truth", "depthmap", "across", "along", "deep"])
    holds(frame["pictures"] == 7 and sorted(page.pictures) == [0, 1, 2, 3, 4, 5, 6], f"pictures: {sorted(page.pictures)}")
    for number, kind, width, height, serial, data in page.pictures.values():
        holds((number, serial) == (frame["frame"], frame["serial"]), "a picture is of another frame or state")
        holds(kind == 0 and (width, height) == (64, 64) and data[:2] == b"\xff\xd8" and data[-2:] == b"\xff\xd9", "no JPEG")
    page.pictures.clear()
    again = page.show(views=["result", "full", "truth", "depthmap", "across", "along", "deep"])
    holds(again["pictures"] == 0, "pictures that have not changed are sent again")
    turned = page.show(views=["result"], camera={"yaw": 20, "pitch": 0, "roll": 0, "zoom": 1})
    holds(turned["pictures"] == 1 and turned["ms"]["convert"] > 0, "turning draws nothing")
    moved = page.show(views=["result"], camera={"yaw": 20, "pitch": 0, "roll": 0, "zoom": 1}, lanes=[{"plugin": 0, "values": {"q": 1.1}}])
    holds(moved["pictures"] == 1 and moved["lanes"][0]["adjusted"] == moved["lanes"][0]["clipped"], "the surface position asks for a new volume")
    page.say({"type": "do", "what": "snapshot", "view": "result"})
    page.show(picture=48)
    holds(page.pictures[0][1] == 0 and page.pictures[0][2] == 48, "no picture of 48 pixels")


def pictures_name_their_state(page):
    """Sources change faster than they are drawn, as by a hand that goes through the menus: every picture and every frame says which
    state it was made for, and what is asked for is of the state before it."""
    sources, frame = {}, {"serial": 0}
    for i in range(12):
        source = {"scene": ("D01", "E02")[i // 2 % 2], "size": 32 + i, "volumes": 1, "from": "probe"}
        page.say(page.state(source=source, views=["result", "across"]))
        sources[page.serial] = source
        time.sleep(0.02)
    while frame["serial"] != page.serial:
        page.pictures.clear()
        frame = page.text("frame", "refused")
        holds(frame["type"] == "frame", f"{frame}")
        page.say({"type": "seen", "frame": frame["frame"]})
        if frame["serial"] not in sources:
            continue
        holds(frame["of"] == {"source": sources[frame["serial"]], "plugins": [0]}, f"the frame is of {frame['of']}")
        holds(len(page.pictures) == 2, "a source changes, and the pictures stay")
        for picture in page.pictures.values():
            holds((picture[0], picture[4]) == (frame["frame"], frame["serial"]), f"a picture of {picture[:5]} in a frame of {frame['serial']}")
    page.say(page.state(source={**source, "scene": "D01", "size": 40}))
    page.say({"type": "do", "what": "snapshot", "view": "result"})
    page.pictures.clear()
    while page.pictures.get(0, (0, 0))[1] != 1:
        heard = page.hear()
        if heard[0] == 2:
            page._take(heard[1])
        else:
            holds(json.loads(heard[1])["type"] not in ("refused", "skipped"), f"before the snapshot: {heard[1]}")
    holds(page.pictures[0][4] == page.serial, f"the snapshot is of state {page.pictures[0][4]}, asked for in {page.serial}")


# What the parser is fed is in tests/host_sim/check/test_console_message.c; these also meet what stands behind it.
REFUSED = ["", "{", "nonsense", "[]", "{}", "null", '{"type":"state"}', '{"type":"seen","frame":-1}', '{"type":"do","what":"rm"}',
           b'{"type":"seen","frame":"\xff\xfe"}', "x" * 16385, "[" * 4000, '{"type":"seen","frame":1,"frame":2}']


def states_that_cannot_be_shown(page, work):
    bad = [{"lanes": [{"plugin": 9, "values": {}}]}, {"lanes": [{"plugin": 0, "values": {"no_such": 1}}]},
           {"lanes": [{"plugin": 0, "values": {"q": 1e9}}]}, {"source": {"folder": 0, "path": "../outside.mha", "from": "probe"}},
           {"source": {"folder": 0, "path": "link.mha", "from": "probe"}}, {"source": {"folder": 0, "path": "inside.mha", "from": "probe"}},
           {"source": {"folder": 9, "path": "inside.mha", "from": "probe"}}, {"source": {"folder": 0, "path": "/etc/passwd", "from": "probe"}},
           {"source": {"scene": "D01", "size": 64, "volumes": 1, "from": "left"}},
           {"camera": {"yaw": 0, "pitch": 0, "roll": 0, "zoom": 1e9}}]
    for changes in bad:
        said = page.show(**changes)
        holds(said["type"] == "refused" and said["text"], f"{changes}: {said}")
        holds(os.path.realpath(work) not in said["text"], f"the page is told where the folder lies: {said}")
        good = page.show()
        holds(good["type"] == "frame", f"after {changes} the page shows nothing: {good}")


def write_cube(path, size):
    with open(path, "wb") as out:
        out.write(f"NDims = 3\nElementSpacing = 1 1 1\nDimSize = {size} {size} {size}\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n".encode())
        out.write(bytes(range(1, 201)) * (size**3 // 200))


def a_name_that_flips(page, work):
    """A file becomes a link to one outside and a file again, while it is opened: what lies outside is never shown."""
    given, there, ends = os.path.join(work, "given"), os.path.join(work, "given", "flips.mha"), threading.Event()
    write_cube(os.path.join(given, "still.mha"), 20)
    write_cube(there, 20)
    write_cube(os.path.join(work, "secret.mha"), 40)

    def flip():
        while not ends.is_set():
            os.symlink("../secret.mha", there + "~")
            os.replace(there + "~", there)
            os.link(os.path.join(given, "still.mha"), there + "~")
            os.replace(there + "~", there)

    flipping = threading.Thread(target=flip)
    flipping.start()
    try:
        for _ in range(40):
            still = page.show(source={"folder": 0, "path": "still.mha", "from": "probe"})
            said = page.show(source={"folder": 0, "path": "flips.mha", "from": "probe"})
            holds(said["type"] == "refused" or said["source"]["slabs"] == still["source"]["slabs"], f"what lies outside is shown: {said}")
    finally:
        ends.set()
        flipping.join()


def let_in(console, what):
    """A page; those that have just closed may still hold its place."""
    pages = []
    until(lambda: _opens(console, pages), 30, what + ": no page is let in")
    return pages[0]


def frames_that_are_wrong(console, other):
    """Bytes of every kind; each on a page of its own, which may be closed for it. Another page goes on all the while."""
    make = Page.frame
    kinds = {
        "binary": lambda p: make(p, 2, b"abc"), "a reserved opcode": lambda p: make(p, 3, b"abc"),
        "a reserved control opcode": lambda p: make(p, 0xb, b""), "reserved bits": lambda p: make(p, 1, b"{}", 0xf0),
        "the start of a fragmented message": lambda p: make(p, 1, b"{", 0), "a continuation of nothing": lambda p: make(p, 0, b"}"),
        "no mask": lambda p: make(p, 1, b"{}", 0x80, False), "a long ping": lambda p: make(p, 9, b"x" * 200),
        "a close with nonsense": lambda p: make(p, 8, b"\xff\xff\xff\xff\xff"), "half a head": lambda p: b"\x81",
        "half a message": lambda p: make(p, 1, b'{"type":"seen","frame":1}')[:12],
        "64 bits of length": lambda p: b"\x81\xff\xff\xff\xff\xff\xff\xff\xff\xffabcd",
        "a gigabyte announced": lambda p: b"\x81\xff\x00\x00\x00\x00\x40\x00\x00\x00abcdxyz",
        "no WebSocket at all": lambda p: b"GET / HTTP/1.1\r\n\r\n" * 20, "zeros": lambda p: bytes(4096),
        "a megabyte of text": lambda p: make(p, 1, b" " * (1 << 20)),
        "many refused messages": lambda p: make(p, 1, b"{}") * 70,
    }
    for what, bytes_of in kinds.items():
        page = let_in(console, f"before '{what}'")
        page.raw(bytes_of(page))
        page.close()
        witness = let_in(console, f"after '{what}'")
        holds(witness.text("hello"), f"after '{what}' the console says nothing")
        witness.close()
        holds(console.process.poll() is None, f"'{what}' ended the console")
        shown = other.show()
        holds(shown["type"] == "frame", f"after '{what}' another page stands still")


def messages_that_are_refused(page):
    for message in REFUSED:
        page.say(message)
        said = page.text("refused")
        holds(said is not None and said["text"].startswith("message: "), f"{message[:40]!r}: {said}")
    holds(page.show()["type"] == "frame", "after refused messages nothing is shown")


def the_newest_state_wins(page):
    """200 states at once: few frames come, and the last one is of the last state."""
    for i in range(200):
        page.say(page.state(camera={"yaw": i * 0.5, "pitch": 0, "roll": 0, "zoom": 1}))
    frames, last = 0, None
    while last is None or last["serial"] < page.serial:
        last = page.text("frame")
        holds(last is not None, "the page was closed")
        page.say({"type": "seen", "frame": last["frame"]})
        frames += 1
    holds(frames < 120, f"{frames} frames for 200 states: a queue of stale requests")


def a_page_that_does_not_read(console):
    """It asks for much and takes nothing; another page goes on. Without what it has seen it gets two frames, no more."""
    deaf = let_in(console, "a page that will not read")
    for i in range(300):
        deaf.raw(deaf.frame(1, json.dumps(deaf.state(camera={"yaw": i, "pitch": 0, "roll": 0, "zoom": 1}, picture=1024)).encode()))
    other = let_in(console, "a page beside one that does not read")
    for i in range(5):
        start = time.monotonic()
        holds(other.show(camera={"yaw": i, "pitch": 0, "roll": 0, "zoom": 1})["type"] == "frame", "the other page stands still")
        holds(time.monotonic() - start < 30, "the other page waits for the deaf one")
    frames = 0
    deaf.socket.settimeout(3)
    for yaw in (-10, -20, -30):
        while deaf.text("frame"):
            frames += 1
        deaf.say(deaf.state(camera={"yaw": yaw, "pitch": 0, "roll": 0, "zoom": 1}))
    holds(frames == 2, f"a page that has seen nothing got {frames} frames")
    deaf.close()
    other.close()


def no_more_than_four(console):
    pages = []
    while len(pages) < 4:
        until(lambda: _opens(console, pages), 30, f"page {len(pages) + 1} of four is not let in")
    fifth = Page(console)
    holds(not fifth.open, "a fifth page is let in")
    fifth.close()
    holds(pages[0].text("hello"), "the first page hears nothing")
    pages[3].close()
    until(lambda: _opens(console, pages), 20, "a page in the place of one that closed")
    for page in pages:
        page.close()


def _opens(console, pages):
    page = Page(console)
    if page.open:
        pages.append(page)
    else:
        page.close()
    return page.open


def only_this_machine(console):
    """Whatever else its addresses are."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        try:
            one.connect(("192.0.2.1", 9))  # sends nothing: it only picks an address
        except OSError:
            return
        mine = one.getsockname()[0]
    if mine.startswith("127."):
        return
    try:
        socket.create_connection((mine, console.port), timeout=5).close()
    except OSError:
        return
    raise AssertionError(f"the console listens on {mine}")


def make_folder(work):
    """A folder to give, with a link that leads out of it."""
    given = os.path.join(work, "given")
    os.makedirs(os.path.join(given, "sub"))
    for name in ("given/inside_label.mha", "given/sub/deep_near.mha", "given/inside.mha", "given/sub/deep.mha", "outside.mha"):
        with open(os.path.join(work, name), "w") as out:
            out.write("no volume\n")
    with open(os.path.join(given, "scan_end.mha"), "w") as out:
        out.write("ObjectType = Image\nNDims = 3\nDimSize = 4 4 1\nElementType = MET_USHORT\nElementDataFile = LOCAL\n")
    os.symlink("../outside.mha", os.path.join(given, "link.mha"))
    os.symlink("..", os.path.join(given, "up"))
    return given


def one_console(work):
    with open(os.path.join(work, "said"), "w") as said:
        console = Console(BUILD, [make_folder(work), *PLUGINS, "--stay", "--out", os.path.join(work, "out")], said)
        try:
            pages_and_files(console)
            what_the_library_refuses(console)
            slow_sockets(console)
            who_gets_in(console)
            only_this_machine(console)
            page = Page(console)
            holds(page.open, "a page is not let in")
            what_is_listed(page)
            values_of_an_enum(page)
            a_picture(page)
            pictures_name_their_state(page)
            messages_that_are_refused(page)
            states_that_cannot_be_shown(page, work)
            a_name_that_flips(page, work)
            the_newest_state_wins(page)
            what_may_be_dropped(console)
            frames_that_are_wrong(console, page)
            a_page_that_does_not_read(console)
            holds(page.show()["type"] == "frame", "the first page does not go on")
            page.close()
            no_more_than_four(console)
            last = let_in(console, "the last page")
            last.show()
            console.interrupt()
            holds(console.wait(60) == 0, "SIGINT with a page open does not end it with 0")
        finally:
            console.end()


def a_sequence_plays(work):
    """A Kretz sequence of three volumes goes on by itself, as fast as the page has seen its frames, and stops where it is told."""
    folder = os.path.join(work, "scans")
    subprocess.run([os.path.join(BUILD, "host_sim"), "scenes", "D01", "--size", "64", "--frames", "3", "--export", "--format", "vol",
                    "--out", folder], check=True, stdout=subprocess.DEVNULL, timeout=900)
    console = Console(BUILD, [folder, *PLUGINS, "--lowres", "40"])
    try:
        page = Page(console)
        names = [one["path"] for one in page.text("hello")["files"]]
        holds("D01_full.vol" in names, f"files: {names}")
        source = {"folder": 0, "path": "D01_full.vol", "from": "probe"}
        first = page.show(source=source)
        holds(first["type"] == "frame" and first["source"]["volumes"] == 3 and not first["source"]["truth"], f"the sequence: {first}")
        holds(first["source"]["slabs"] == [40, 40, 40] and "--lowres 40" in first["lanes"][0]["line"], f"not 40 pixels across: {first}")
        holds("--volume " + os.path.join(os.path.realpath(folder), "D01_full.vol") in first["lanes"][0]["line"], "the line has no file")
        page.say(page.state(source=source, play={"on": True, "speed": 50, "index": 1}))
        indices = []
        while len(indices) < 7:
            frame = page.text("frame")
            page.say({"type": "seen", "frame": frame["frame"]})
            if frame["serial"] == page.serial:
                indices.append(frame["index"])
        holds(indices == [1, 2, 0, 1, 2, 0, 1], f"it plays {indices}")
        stopped = page.show(source=source, play={"on": False, "speed": 50, "index": 2})
        holds(stopped["index"] == 2, "it does not stop where it is told")
        page.socket.settimeout(2)
        holds(page.text("frame") is None, "it goes on after it was stopped")
        console.interrupt()
        holds(console.wait(60) == 0, "it does not end")
    finally:
        console.end()


def main():
    with tempfile.TemporaryDirectory() as work:
        one_console(work)
        a_sequence_plays(work)
    print("ok")


main()
