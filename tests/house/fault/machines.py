# SPDX-License-Identifier: MIT
"""machines.py BUILD [MACHINE [PROGRAM]]: every program on machines that are not as its author's was. What it does there is right, to the bits of the plain
machine; or it is told: a sentence and an exit code of its own, no trace, no signal, and no plugin found wrong that is right. Where a
machine should change nothing, it must be right. All such machines are tried as one; at night (SV_NIGHT) each by itself, and with every
program. As a container's first process each is ended by SIGTERM."""

import contextlib
import json
import os
import re
import resource
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parents[2] / folder) for folder in ("host_sim/console", "support")]
from console_client import Console, Page
from igtl_client import read_message

BUILD = Path(sys.argv[1]).resolve()
PYTHON = BUILD / "python/venv/bin/python"
NIGHT = "SV_NIGHT" in os.environ
ONLY, PROGRAM = (*sys.argv[2:], None, None)[:2]  # all of them
TOLD = range(2, 8)  # exit codes that say what was in the way; 1 is a verdict, of a batch that a volume was not clipped
SECONDS = 300
TRAPS = ["gzip", "json", "re", "numpy", "smartvis", "encodings", "zlib", "socket", "struct", "subprocess", "usercustomize", "sitecustomize"]


class Machine:
    """How a program is started: what `prepare` does to its process, its environment, its folder, what it is started by."""

    def __init__(self, name, prepare=None, environment=None, folder=None, by=(), tells=False):
        self.name, self.prepare, self.environment, self.folder, self.by = name, prepare, environment or {}, folder, list(by)
        self.tells = tells  # it may end with a sentence; else it must be right

    def settings(self, work):
        environment = {key: value for key, value in {**os.environ, **self.environment}.items() if value is not None}
        # A short time after fork: what is closed here is not the parent's.
        return {"env": environment, "preexec_fn": self.prepare, "cwd": self.folder or work, "pass_fds": ()}


def small_stacks():
    resource.setrlimit(resource.RLIMIT_STACK, (512 << 10, 512 << 10))


def few_descriptors():
    resource.setrlimit(resource.RLIMIT_NOFILE, (64, 64))


def closed():
    os.close(0)
    os.close(2)


def deaf_to_pipes():
    signal.signal(signal.SIGPIPE, signal.SIG_IGN)


def no_umask():
    os.umask(0)


def all_of(*steps):
    def prepare():
        for step in steps:
            step()

    return prepare


def hostile(work):
    """A folder of traps: modules and libraries by the names that programs look for, which leave a mark."""
    folder = work / "hostile"
    folder.mkdir()
    for name in TRAPS:
        (folder / f"{name}.py").write_text(f"open({str(work / 'TRAPPED')!r}, 'a').write({name!r} + chr(10))\nraise SystemExit(99)\n")
    for name in ("libOpenCL.so.1", "smartvis.so", "host_sim", "sv_validate", "share"):
        (folder / name).write_text("no library")
    return folder


def talkative(work):
    """A site's own module, as clusters have, which prints."""
    folder = work / "site"
    folder.mkdir()
    (folder / "sitecustomize.py").write_text("print('Welcome to the cluster', flush=True)\n")
    return folder


def comma(work):
    """Environment of a locale with a comma; None where the system has no sources of locales."""
    with contextlib.suppress(FileNotFoundError):
        subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", work / "comma"], capture_output=True, check=False)
    return {"LOCPATH": str(work), "LC_ALL": "comma"} if (work / "comma/LC_NUMERIC").exists() else None


def first_process():
    """What starts a program as the first process of its own namespace; none where that may not be made."""
    command = ["unshare", "--pid", "--fork", "--mount-proc", "--kill-child"]
    made = shutil.which("unshare") and subprocess.run([*command, "true"], capture_output=True, check=False).returncode == 0
    return command if made else []


def machines(work):
    home = {"HOME": "/proc/nowhere", "XDG_CACHE_HOME": None, "TMPDIR": None}
    folder, site, locale, first = hostile(work), {"PYTHONPATH": str(talkative(work))}, comma(work), first_process()
    missing = [name for name, there in (("a comma locale", locale), ("PID 1", first)) if not there]
    if missing:
        print(f"not tried here: {', '.join(missing)}")
    steps = (small_stacks, few_descriptors, deaf_to_pipes, no_umask, closed)
    yield Machine("all at once", all_of(*steps), {**home, **site, **(locale or {})}, folder, first)
    if not NIGHT and ONLY is None:
        return
    yield Machine("no home to write to, no cache named", environment={**home, "POCL_CACHE_DIR": None}, tells=True)
    yield Machine("a full disk under the cache", environment={"LD_PRELOAD": str(BUILD / "tests/full_disk.so")}, tells=True)
    yield Machine("no home to write to", environment=home)
    yield Machine("standard input and error closed", closed)
    yield Machine("a hostile working folder", folder=folder)
    yield Machine("a sitecustomize that prints", environment=site)
    yield Machine("64 descriptors", few_descriptors)
    yield Machine("stacks of 512 KiB", small_stacks)
    yield Machine("stacks of 256 KiB", lambda: resource.setrlimit(resource.RLIMIT_STACK, (256 << 10, 256 << 10)), tells=True)
    yield Machine("umask 0", no_umask)
    yield Machine("SIGPIPE ignored", deaf_to_pipes)
    if locale:
        yield Machine("a comma locale", environment=locale)
    if first:
        yield Machine("PID 1", by=first)


# ---------------------------------------------------------------------------------------------- programs --
# Each returns (exit code, what it said, what it made): the last is compared with the plain machine's.


def ended(machine, work, command, made=lambda said: said):
    done = subprocess.run([*machine.by, *map(str, command)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, timeout=SECONDS,
                          check=False, **machine.settings(work))
    said = done.stdout.decode(errors="replace") + done.stderr.decode(errors="replace")
    # What a site prints is nobody's result.
    right = done.returncode == 0
    return done.returncode, said, made(done.stdout.decode(errors="replace").replace("Welcome to the cluster\n", "")) if right else None


def files(folder, *patterns):
    return {str(path.relative_to(folder)): path.read_bytes() for pattern in patterns for path in sorted(folder.glob(pattern))}


def run(machine, work, out):
    return ended(machine, work, [BUILD / "host_sim", "run", "--volume", work / "scan.mha", "--guard", "--setting", "smartvis", "--frames", "1",
                                 "--few-pictures", "--write", "depthmap", "--out", out], lambda _: files(out, "depthmap.mha"))


def list_(machine, work, _):
    return ended(machine, work, [BUILD / "host_sim", "list", "--guard"])


def report(machine, work, out):
    return ended(machine, work, [BUILD / "host_sim", "report", "--case", "E01", "--size", "32", "--coarse", "--frames", "0", "--out", out],
                 lambda _: files(out, "*.csv"))


def validate(machine, work, _):
    return ended(machine, work, [BUILD / "sv_validate", "--only", "first-frame,descriptors", BUILD / "smartvis.so"], lambda said: re.findall(r"(?m)^\w+ +[a-z-]+", said))


def replay(machine, work, _):
    return ended(machine, work, [BUILD / "sv_replay", work / "recording"], lambda said: "\nthe same\n" in said)


def clip(machine, work, out):
    return ended(machine, work, [PYTHON.with_name("smartvis"), "clip", work / "scan.mha", "--write", "clipped,depth", "--out", out], lambda _: files(out, "*.nrrd"))


def batch(machine, work, out):
    return ended(machine, work, [PYTHON.with_name("smartvis"), "batch", work / "study", "--workers", "1", "--write", "depth", "--out", out],
                 lambda _: files(out, "**/*.nrrd"))


def console(machine, work, _):
    """A page, and a picture in it."""
    try:
        server = Console(str(BUILD), ["--plugin", str(BUILD / "smartvis.so"), "--stay"], err=subprocess.PIPE, by=machine.by, **machine.settings(work))
    except AssertionError:  # it has ended: so it does once more, and says why
        return ended(machine, work, [BUILD / "host_sim", "console", "--stay"])
    try:
        page = Page(server, timeout=SECONDS)
        page.must("hello")
        shown = page.show()
        made = [page.pictures[0][5]] if shown["type"] == "frame" else None
        page.close()
        if not machine.by:  # unshare hears nothing for its child
            server.interrupt()
            assert server.wait(60) == 0, "the console does not end well"
        # A page is told what a program would end with.
        return (0, "", made) if made else (5, shown["text"], None)
    finally:
        server.end()


def serve(machine, work, _):
    """A volume there and back."""
    with subprocess.Popen([*machine.by, PYTHON.with_name("smartvis"), "serve", "--port", "0"], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True, **machine.settings(work)) as server:
        try:
            line = "Welcome to the cluster"
            while line.startswith("Welcome to the cluster"):
                line = server.stdout.readline()
            if not line:
                return server.wait(SECONDS), server.stderr.read(), None
            with socket.create_connection(("127.0.0.1", int(line.split(":")[2].split(";")[0])), timeout=SECONDS) as peer:
                peer.sendall((work / "volume.igtl").read_bytes())
                said = []
                while not said or said[-1][0] not in (b"STRING", b"STATUS"):  # which come last
                    head, body = read_message(peer)
                    said.append((head[2:14].rstrip(b"\0"), body))
            told = b" ".join(body for kind, body in said if kind in (b"STATUS", b"STRING")).decode("latin-1")
            made = [body for _, body in said] if len(said) == 3 else None
        finally:
            # The first process of a namespace hears only what it listens to; unshare waits for it.
            for child in children(server.pid) if machine.by else [server.pid]:
                os.kill(child, signal.SIGTERM)
            try:
                code = server.wait(60)
            finally:
                server.kill()
        return (code, told, made) if made else (5, told, None)


def not_ended(by, work):
    """Of programs with work for long, those that SIGTERM does not end where they are a container's first process, with what became of them."""
    (work / "many").mkdir()
    for number in range(60):
        shutil.copy(work / "scan.mha", work / f"many/{number}.mha")
    smartvis, many = [PYTHON, "-P", "-m", "smartvis"], sorted((work / "many").iterdir())
    busy = {"run": [BUILD / "host_sim", "run", "--scene", "E01", "--size", "32", "--frames", "100000", "--picture", "32", "--few-pictures"],
            "smartvis clip": [*smartvis, "clip", *many], "smartvis batch": [*smartvis, "batch", work / "many", "--workers", "1"]}
    for program, command in busy.items():
        out = work / f"ended {program}"
        with subprocess.Popen([*by, *command, "--out", out], cwd=work, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as first:
            until = time.monotonic() + SECONDS
            while first.poll() is None and time.monotonic() < until:
                time.sleep(0.2)  # before it listens, it does not hear
                for child in children(first.pid) if out.exists() else []:
                    os.kill(child, signal.SIGTERM)
            first.kill()
        if first.returncode != 128 + signal.SIGTERM:
            yield program, f"as the first process it ended with {first.returncode}, expected {128 + signal.SIGTERM}"


def children(pid):
    with contextlib.suppress(OSError):
        return [int(one) for one in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    return []


PROGRAMS = {"run": run, "list": list_, "report": report, "console": console, "sv_validate": validate, "sv_replay": replay,
            "smartvis clip": clip, "smartvis batch": batch, "smartvis serve": serve}


# ------------------------------------------------------------------------------------------------ table --


def prepare(work):
    """What the programs work on, made by the plain machine."""
    def must(*command, **more):
        done = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=SECONDS, check=False, env={**os.environ, **more})
        assert done.returncode == 0, f"{command}: {done.stderr}"

    must(BUILD / "host_sim", "scenes", "D01", "--size", "48", "--export", "--out", work / "scene")
    shutil.copy(work / "scene/D01_full.mha", work / "scan.mha")
    (work / "study").mkdir()
    shutil.copy(work / "scan.mha", work / "study/one.mha")
    must(BUILD / "host_sim", "run", "--scene", "E01", "--size", "48", "--frames", "2", "--few-pictures", "--setting", "smartvis", "--no-guard",
         "--plugin", BUILD / "smartvis_check.so", "--out", work / "recorded", SMARTVIS_CHECK_PLUGIN=str(BUILD / "smartvis.so"),
         SMARTVIS_RECORD=str(work / "recording"))
    must(PYTHON, "-P", "-c", "import sys, numpy; from pyigtl.messages import ImageMessage; v = numpy.full((32, 32, 32), 200, numpy.uint8); v[:19] = 10; v[:6] = 100; "
         "open(sys.argv[1], 'wb').write(ImageMessage(v, ijk_to_world_matrix=numpy.eye(4), device_name='Scan', timestamp=1.0).pack())", work / "volume.igtl")


def cell(machine, program, work, plain):
    """The table's word, and what is wrong, if anything is."""
    out = work / "out"
    shutil.rmtree(out, ignore_errors=True)
    try:
        code, said, made = PROGRAMS[program](machine, work, out)
    except (OSError, AssertionError, subprocess.TimeoutExpired) as failure:
        return "HANGS", f"{failure!r}"
    if code == 0 and made is not None:
        return ("right", None) if plain is None or made == plain else ("OTHER", "what it made is not what the plain machine makes")
    if "Traceback" in said or not said.strip():
        return "TRACE", f"exit code {code}: {said}"
    if code not in TOLD and (program, code) != ("smartvis batch", 1):
        return f"EXIT {code}", said
    return f"told ({code})", None if machine.tells else f"is told: {said}"


def main():
    if not PYTHON.exists():
        print("skipped: there is no environment of Python (PyPI)")
        return 77
    os.environ.setdefault("POCL_CACHE_DIR", str(BUILD / "pocl_cache"))
    os.environ["SMARTVIS_HOST_SIM"] = str(BUILD / "host_sim")
    failed = 0
    with tempfile.TemporaryDirectory(prefix="sv_machines_") as name:
        work = Path(name)
        prepare(work)
        plain_machine = Machine("plain")
        by_day = [program for program in PROGRAMS if NIGHT or ONLY is not None or program not in ("report", "smartvis batch")]
        programs = [PROGRAM] if PROGRAM else by_day  # what others start takes long
        plain = {}
        for program in programs:
            out = work / "plain" / program.replace(" ", "_")
            code, said, plain[program] = PROGRAMS[program](plain_machine, work, out)
            assert code == 0 and plain[program] and plain[program] is not None, f"{program} on a plain machine: {code}: {said}"
        width = 38
        print(" " * width + "  ".join(programs), flush=True)
        for machine in machines(work):
            if ONLY not in (None, "", machine.name):
                continue
            row = []
            for program in programs:
                word, wrong = cell(machine, program, work, plain[program])
                row.append(word.ljust(len(program)))
                if wrong:
                    failed += 1
                    print(f"FAIL: {machine.name}: {program}: {wrong}")
            print(machine.name.ljust(width) + "  ".join(row), flush=True)
        for program, wrong in not_ended(first, work) if (first := first_process()) and ONLY is None else ():
            failed += 1
            print(f"FAIL: {program}: {wrong}")
        if (work / "TRAPPED").exists():
            failed += 1
            print(f"FAIL: a program has run Python of its working folder: {(work / 'TRAPPED').read_text()}")
    print(json.dumps({"failed": failed}))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
