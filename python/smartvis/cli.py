# SPDX-License-Identifier: MIT
"""The command ``smartvis``. Exit codes are those of host_sim: 0 all went well, 1 a part failed, 2 the command
line is wrong, 3 bad input, 4 the plugin failed, 5 OpenCL did, 6 a result cannot be written, 7 memory ran out."""

from __future__ import annotations

import argparse
import contextlib
import json
import logging
import os
import signal
import sys
import threading
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NoReturn

from . import _kretz, _process, _runtime
from ._errors import FileError, HostError, LoadError, OutputError, PluginError, SmartVisError, state_of
from ._files import SUFFIXES, Source, stem
from ._found import find_files
from ._options import Parser, add_clip_options, add_product_options, finite, pairs_of, positive, settings_of, signed
from ._plugin import Parameter, load
from ._products import PRODUCTS
from ._text import plain
from ._version import FULL
from ._work import Row, Sequences, Settings, clip_one, name_of

OK, FAILED, USAGE, INPUT, PLUGIN, DEVICE, OUTPUT, MEMORY = 0, 1, 2, 3, 4, 5, 6, 7
CODES = {"ok": OK, "input": INPUT, "plugin": PLUGIN, "device": DEVICE, "output": OUTPUT, "memory": MEMORY}


def progress(total: int | None, what: str) -> contextlib.AbstractContextManager[Any]:
    """A progress bar on stderr, if that is a terminal and tqdm is there. None: how many there are is not known yet."""
    try:
        from tqdm import tqdm
    except ImportError:
        none = SimpleNamespace(update=lambda: None, reset=lambda count: None, write=print)
        return contextlib.nullcontext(none)
    bar: contextlib.AbstractContextManager[Any] = tqdm(total=total, desc=what, unit="volume", disable=None)
    return bar


def make_folder(path: str) -> Path:
    """The folder for results; OutputError if it cannot be made."""
    folder = Path(path)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{folder}: {error.strerror}") from None
    return folder


def check_mirror(settings: Settings, files: Sequence[Path]) -> None:
    """ValueError if nothing could be mirrored."""
    if settings.mirror and not any(path.is_file() and _kretz.is_one(path) for path in files):
        raise ValueError("--mirror: is for Kretz volumes, and none was given")


def command_clip(args: argparse.Namespace) -> int:
    """Clips files."""
    settings = settings_of(args)
    files = [part for path in map(Path, args.file) for part in (_kretz.split(path) if path.is_dir() else [path])]
    check_mirror(settings, files)
    _process.limit = args.seconds
    taken: dict[str, Path] = {}
    for path in files:
        if (name := stem(path)) in taken:
            raise ValueError(f"{taken[name]} and {path} would both be written as {name}; clip one at a time")
        taken[name] = path
    out = make_folder(args.out)
    code, written, last = OK, False, ""
    with progress(len(files), "clip") as bar:
        for path in files:
            try:
                source = Source(path, mirror=settings.mirror, spacing=settings.spacing)
            except FileError as error:  # takes only itself
                tell(error)
                code = code or INPUT
                continue
            sequences: Sequences = {}
            for frame in range(source.count):
                if source.count > 1 and (name := name_of(source, frame)) in taken:
                    raise ValueError(f"{taken[name]} and {path} would both be written as {name}; clip one at a time")
                row = clip_one(source, frame, settings, out, sequences=sequences)
                if row.state == "ok" or row.reason != last:  # what is wrong with all of a sequence is said once
                    bar.write(plain(line_of(row, source.count > 1, source.names[frame])), file=sys.stdout)
                code, written, last = code or CODES[row.state], written or row.state == "ok", row.reason
            for writer in sequences.values():
                if not writer.close():
                    print(f"smartvis: {writer.path}: not written, since volumes of it failed", file=sys.stderr)
            bar.update()
    if written:
        print(plain(f"Files are in {out}"))
    return code


def line_of(row: Row, sequence: bool = False, called: str = "") -> str:
    """One line about one volume, and below it why nothing is clipped, and what to do."""
    name = row.file + (f" [{row.frame}{': ' if called else ''}{called}]" if sequence else "")
    if row.state != "ok":
        return row.reason if row.reason.startswith(row.file) else f"{name}: {row.reason}"
    size = f"{row.width} x {row.height} x {row.slices}"
    notes = [f"  Beams: {row.beams}"]
    notes += [f"  Why: {row.why}"] if row.why else []
    notes += [f"  Try: {row.try_this}"] if row.try_this else []
    notes += [f"  {row.doubt}"] if row.doubt and row.doubt != row.why else []
    return "\n".join([f"{name}: {size}, {found_in(row)}; {row.clip_ms:.0f} ms", *notes])


def found_in(row: Row) -> str:
    """What became of a volume that could be clipped, in a few words."""
    share = f"{100 * row.clipped_share:.0f} % of the rays clipped"
    return f"{row.outcome}, {share}, {row.depth_mm:.1f} {row.unit} on average"


def command_serve(args: argparse.Namespace) -> int:
    """Serves OpenIGTLink until it is interrupted."""
    from .serve import Server

    settings = settings_of(args)
    try:
        memory, together = (m and m << 20 for m in (args.memory, args.all_memory))
        bounds = {"limit": args.limit << 20, "clients": args.clients, "memory": memory, "all_memory": together}
        server = Server(settings, args.host, args.port, **bounds)
    except (OSError, OverflowError) as error:
        why = getattr(error, "strerror", None) or error
        raise ValueError(f"--host {args.host} --port {args.port}: {why}") from None
    host, port = server.server_address[:2]
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGTERM, lambda *_: sys.exit(OK))
    shown = f"[{host!s}]" if ":" in str(host) else str(host)
    print(f"smartvis: listening at {shown}:{port}; Ctrl-C ends it", flush=True)
    with server:
        server.serve_forever()
    return OK


def command_console(args: argparse.Namespace) -> int:
    """Opens files in the machine's console."""
    from .console import open_files

    return open_files(args.file, ["--port", str(args.port), *(["--stay"] if args.stay else [])])


def command_dicom(args: argparse.Namespace) -> int:
    """Writes saved pictures as DICOM."""
    from ._capture import write

    print(plain(str(write(args.picture, Path(args.out), Path(args.of) if args.of else None))))
    return OK


def command_batch(args: argparse.Namespace) -> int:
    """Clips every volume of a study."""
    from . import _study, _sweep

    each = {name: settings_of(args, pairs) for name, pairs in _sweep.choices(pairs_of(args)).items()}
    files = find_files(args.folder, Path(args.out), tell)
    if not files:
        raise FileError(f"{' '.join(args.folder)}: there is no volume; suffixes are {' '.join(SUFFIXES)}")
    check_mirror(next(iter(each.values())), files)  # the same in all
    out = make_folder(args.out)
    with (
        _study.cluster(args.scheduler, args.workers, lambda link: tell(f"dashboard at {link}")) as client,
        progress(None, "batch") as bar,
    ):

        def batch(settings: Settings, folder: Path) -> list[dict[str, Any]]:
            if folder != out:
                tell(f"{folder.name}, one of {len(each)}")
            return _study.batch(files, settings, folder, client, bar.update, args.seconds, bar.reset, tell)

        rows = _sweep.sweep(each, out, batch) if len(each) > 1 else batch(each[""], out)
    failed = [row for row in rows if row["state"] != "ok"]
    volumes = len({(row["file"], row["frame"]) for row in rows})
    many = "volumes" if volumes == len(rows) else "results"
    of_file = Counter(row["file"] for row in failed)
    for row in failed:
        if count := of_file.pop(row["file"], 0):  # the first of a file; the table has all
            more = f"; {count} of its {many} failed" if count > 1 else ""
            print(plain(line_of(Row(**row), True)) + more, file=sys.stderr)
    of_all = f" of {volumes} volumes" if many == "results" else ""
    done = f"{len(rows) - len(failed)} {many}{of_all} clipped, {len(failed)} not"
    print(plain(f"{done}; the page is {out / 'index.html'}, the table {out / 'table.csv'}"))
    return FAILED if failed else OK


def tell(text: object) -> None:
    """What is no result."""
    print(plain(f"smartvis: {text}"), file=sys.stderr, flush=True)


def command_parameters(args: argparse.Namespace) -> int:
    """Tells what the plugin can be set to."""
    plugin = load(args.plugin)
    if args.json:
        facts = [{k: v for k, v in vars(p).items() if k != "id"} for p in plugin.parameters.values()]
        print(json.dumps({"id": plugin.id, "version": plugin.version, "parameters": facts}, indent=1))
        return OK
    print(plain(f"{plugin.name} {plugin.version} ({plugin.id}): {plugin.summary}"))
    for parameter in plugin.parameters.values():
        print(plain(f"  {parameter.key:18} {value_range(parameter):34} {parameter.help}"))
    return OK


def command_doctor(args: argparse.Namespace) -> int:
    """Looks at the installation: Python's part, then the machine's."""
    from . import _doctor

    failed = False
    for what, stands, details in _doctor.facts():
        failed = failed or stands == "FAILS"
        print(plain(f"{what:20} {stands:9}  {details}"), flush=True)
    deadline = ["--deadline", str(args.deadline)] if args.deadline is not None else []
    return _doctor.verify([*deadline, "--frames", str(args.frames), "--out", args.out]) or (FAILED if failed else OK)


def value_range(p: Parameter) -> str:
    """What values a parameter takes, in a few words."""
    if p.choices:
        return f"{p.default} [{'|'.join(p.choices)}]"
    if p.type == "bool":
        return f"{int(bool(p.default))} [0|1]"
    return f"{p.default:g} [{p.minimum:g} .. {p.maximum:g}] {p.unit}".rstrip()


def parser_of() -> argparse.ArgumentParser:
    """The whole command line."""
    parser = Parser(prog="smartvis", description="Removes what hides the fetus in 3D ultrasound.")
    parser.add_argument("--version", action="version", version=f"smartvis {FULL}")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)

    one = commands.add_parser("clip", help="clip files: volume, depthmap, mesh, picture")
    one.add_argument("file", nargs="+", help="NRRD, NIfTI, MetaImage, Kretz, DICOM (also a folder), sequences of them")
    one.add_argument("--out", default="out", help="folder for the results [out]")
    add_clip_options(one)
    add_product_options(one, ",".join(PRODUCTS))
    one.set_defaults(run=command_clip)

    serve = commands.add_parser("serve", help="clip volumes that come by OpenIGTLink, as from 3D Slicer")
    serve.add_argument(
        "--host", default="127.0.0.1", help="address to listen at; who can reach it can use it [127.0.0.1]"
    )
    serve.add_argument("--port", type=int, default=18944, help="[18944]; 0: any, which is printed")
    serve.add_argument("--limit", type=positive, default=512, help="MiB of the longest message [512]")
    serve.add_argument("--memory", type=positive, help="MiB for a client's volume [a quarter of the machine's]")
    serve.add_argument("--all-memory", type=positive, help="MiB for the volumes of all [half of the machine's]")
    serve.add_argument("--clients", type=positive, default=8, help="connections at a time [8]")
    add_clip_options(serve)
    serve.set_defaults(run=command_serve)

    about = (
        "Clips every volume of a study, on many workers. --set q=0.2,0.5,0.8 does so with each value; two such lists\
 with each pair of values, in a folder named after it."
    )
    batch = commands.add_parser("batch", help="clip every volume of a study, on many workers", description=about)
    batch.add_argument("folder", nargs="+", help="folders and files; folders with all below them")
    batch.add_argument("--out", default="out", help="folder for results, index.html and table.csv [out]")
    count = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    batch.add_argument("--workers", type=positive, default=count, help=f"processes on this machine [{count}]")
    batch.add_argument("--scheduler", metavar="ADDRESS", help="a Dask scheduler instead; it sees the same files")
    add_clip_options(batch)
    add_product_options(batch, "clipped,depth")
    batch.set_defaults(run=command_batch)

    doctor = commands.add_parser(
        "doctor", help="this installation on this machine: files, device, a known frame, times"
    )
    doctor.add_argument("--deadline", metavar="MS", type=finite, help="99 of 100 frames must take no longer [none]")
    doctor.add_argument("--frames", metavar="N", type=positive, default=200, help="that are timed [200]")
    doctor.add_argument("--out", default="out/verify", help="folder for the page [out/verify]")
    doctor.set_defaults(run=command_doctor)

    live = commands.add_parser("console", help="open files in the live console, a web page; Ctrl-C ends it")
    live.add_argument("file", nargs="*", help="NRRD, NIfTI, MetaImage, Kretz, DICOM (also a folder), sequences of them")
    live.add_argument("--port", type=int, default=0, help="[0: any]")
    live.add_argument("--stay", action="store_true", help="goes on when the last page is closed")
    live.set_defaults(run=command_console)

    about = "Saved pictures, as of the console, as one DICOM file: a secondary capture, or of several pictures, or an\
 animated one, a capture of many frames. Whose they are is what the scan says that --of names, and nothing without it."
    dicom = commands.add_parser("dicom", help="saved pictures and cines as a DICOM file", description=about)
    dicom.add_argument("picture", nargs="+", help="PNG, also animated")
    dicom.add_argument("--out", default="picture.dcm", help="the file [picture.dcm]")
    dicom.add_argument("--of", metavar="SCAN", help="the DICOM file or folder that they were made of")
    dicom.set_defaults(run=command_dicom)

    facts = commands.add_parser("parameters", help="the plugin's parameters")
    facts.add_argument("--plugin", metavar="PATH", help="plugin library [the package's own]")
    facts.add_argument("--json", action="store_true", help="as JSON")
    facts.set_defaults(run=command_parameters)
    return parser


def fail(error: Exception) -> int:
    """Says what went wrong; returns the exit code."""
    tell(error)
    if isinstance(error, (FileError, HostError, LoadError, PluginError, MemoryError)):
        return CODES[state_of(error)]
    return OUTPUT if isinstance(error, OSError) and not isinstance(error, SmartVisError) else USAGE


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command line and returns the exit code."""
    args = parser_of().parse_args(signed(sys.argv[1:] if arguments is None else arguments))
    return guarded(lambda: int(args.run(args)))


def guarded(command: Callable[[], int]) -> int:
    """The exit code of a command, whatever becomes of it."""
    try:
        code = command()
        sys.stdout.flush()
        return code
    except (SmartVisError, ValueError, OSError, MemoryError) as error:
        return fail(error)
    except KeyboardInterrupt:
        return 130


def run(command: Callable[[], int] = main) -> NoReturn:
    """The entry of a console script."""
    _runtime.open_standard()
    for name, number in (("stdout", 1), ("stderr", 2)):
        if getattr(sys, name) is None:  # Python has none where its descriptor was closed
            setattr(sys, name, os.fdopen(number, "w", closefd=False))
    # Results are left as when Ctrl-C ends it; a container's first process would not hear it at all.
    signal.signal(signal.SIGTERM, lambda number, _: sys.exit(128 + number))
    os.environ["PYTHONSAFEPATH"] = "1"  # workers run nothing of the folder where the user stands
    # The plugin's errors come as exceptions, too.
    logging.getLogger("smartvis.plugin").addFilter(lambda record: record.levelno < logging.ERROR)
    code = command()
    if code == OUTPUT:  # what is left for a full disk must not fail once more at exit
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    sys.exit(code)
