#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""bench_against.py COMMIT: how fast is this checkout beside that commit?

Builds both in folders of its own, with and without AVX-512 where the processor has it, runs both in turn, and prints a table: before,
after, ratio and goal. Before and after are medians; the ratio is the median of the ratios of pairs, whose two runs followed each other.
A goal with x is one for the ratio, another is one for the value after.

Exit code 0: all goals are met; 1: a goal is missed; 2: the command line is wrong; 3: a commit cannot be built or a run fails.
"""

import argparse
import csv
import json
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
import zlib
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
WITHOUT = "without AVX-512"
SIZE = 400  # voxels an axis of the scanned volumes
MOVING = 2  # volumes in turn


class Row(NamedTuple):
    """A row of the table: its measure and its number there, its goal, and the goal without AVX-512 if that is another."""

    title: str
    measure: str
    key: str
    goal: str
    goal_without: str = ""


# The numbers are those of a run of a measure (see MEASURES), or a quotient of two.
ROWS = [
    Row("first picture [s]", "first", "picture", "0.45 x"),
    Row("processor time up to it [s]", "first", "processor", "0.45 x"),
    Row("wall, hot, 128^3 [ms]", "hot", "wall", "1.2"),
    Row("the same / plain C's mean-filter frame", "hot", "wall/plain", "8"),
    Row("wall in the loop, straight [ms]", "straight", "plugin", ""),
    Row("the same / hot", "straight", "plugin/hot", "1.5"),
    Row("wall in the loop, 30, 20 degrees [ms]", "turned", "plugin", ""),
    Row("the same / hot", "turned", "plugin/hot", "2.2"),
    Row("lit picture, straight [ms]", "straight", "dvr", ""),
    Row("whole loop, straight [ms]", "straight", "loop", "0.625 x"),
    Row("whole loop, 30, 20 degrees [ms]", "turned", "loop", "0.625 x"),
    Row("mean, 512^3, k 55 / plain C", "mean", "mean/plain", "0.7", "0.5"),
    Row("peak memory of run of a scene, volumes of 400^3", "memory", "volumes", "4"),
]


class Side(NamedTuple):
    """A build, and where its runs keep kernels and write."""

    build: Path
    kernels: Path
    out: Path
    scans: list[Path]


def stop(text: str) -> None:
    """Ends with exit code 3."""
    print(f"bench_against: {text}", file=sys.stderr)
    sys.exit(3)


def call(command: list[str], **how: object) -> str:
    """Runs a command that must succeed; what it printed."""
    ended = subprocess.run(command, capture_output=True, text=True, check=False, **how)  # type: ignore[call-overload]
    if ended.returncode != 0:
        stop(f"{' '.join(command)} ended with {ended.returncode}:\n{(ended.stdout + ended.stderr)[-3000:]}")
    return str(ended.stdout)


def run(side: Side, program: str, *arguments: str) -> str:
    """Runs a program of a build with its kernels."""
    environment = os.environ | {"POCL_CACHE_DIR": str(side.kernels)}
    return call([str(side.build / program), *arguments], env=environment, cwd=side.out)


def processor_time(process: int) -> float:
    """Seconds that a process and its children that have ended took of the processors."""
    fields = Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()
    return sum(map(int, fields[11:15])) / os.sysconf("SC_CLK_TCK")


def measure_first(side: Side) -> dict[str, float]:
    """Times a run up to result.png, kernels never compiled."""
    with tempfile.TemporaryDirectory() as cold:
        environment, picture = os.environ | {"POCL_CACHE_DIR": f"{cold}/kernels"}, Path(cold) / "result.png"
        command = [side.build / "host_sim", "run", "--scene", "E01", "--frames", "1", "--setting", "smartvis", "--out", cold]
        took, start = 0.0, time.time()
        with subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as process:
            while process.poll() is None and not picture.exists():
                took = processor_time(process.pid)
                time.sleep(0.01)
            errors = process.communicate()[1]
        if process.returncode != 0:
            stop(f"the run of a first picture ended with {process.returncode}:\n{errors[-3000:]}")
        return {"picture": picture.stat().st_mtime - start, "processor": took}


def bench(side: Side, size: int) -> str:
    """What sv_bench says of frames that are read in place."""
    return run(side, "sv_bench", "--only", "plugin", "--size", str(size), "--slab", "32", "--route", "place-own")


def numbers(text: str, table: str) -> list[float]:
    """Returns the numbers of the first row of sv_bench's table whose heading begins so."""
    row = text[text.index(table) :].split("\n")[2]
    return [float(n) for n in re.findall(r"\d+\.\d+", row)]


def measure_hot(side: Side) -> dict[str, float]:
    """Frames of 128^3 voxels one after the other."""
    text = bench(side, 128)
    return {"wall": numbers(text, "Frame with method wall")[0], "plain": numbers(text, "Plugin frame")[0]}


def measure_mean(side: Side) -> dict[str, float]:
    """Frames of 512^3 voxels with the mean filter."""
    plain, _, mean, *_ = numbers(bench(side, 512), "Plugin frame")
    return {"mean": mean, "plain": plain}


def loop(side: Side, *view: str) -> dict[str, float]:
    """Returns medians of the stages of the scan loop, a new volume every frame."""
    volumes = [argument for scan in side.scans for argument in ("--volume", str(scan))]
    run(side, "host_sim", "run", *volumes, "--live", "--setting", "smartvis", "--frames", "60", "--few-pictures", "--no-guard",
        "--out", ".", "--json", "loop.json", *view)  # fmt: skip
    stages = json.loads((side.out / "loop.json").read_text())["settings"]["smartvis"]["stages"]
    return {name: stage["median_ms"] for name, stage in stages.items()}


def measure_memory(side: Side) -> dict[str, float]:
    """Most memory of a run of one volume, from a process of its own that asks."""
    asks = "import resource, subprocess, sys; subprocess.run(sys.argv[1:], check=True, stdout=subprocess.DEVNULL)\n"
    asks += "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)"
    scene = ["run", "--scene", "D01", "--size", str(SIZE), "--setting", "smartvis", "--frames", "3", "--out", "."]
    environment = os.environ | {"POCL_CACHE_DIR": str(side.kernels)}
    kib = int(call([sys.executable, "-c", asks, str(side.build / "host_sim"), *scene], env=environment, cwd=side.out).split()[-1])
    return {"volumes": kib * 1024 / SIZE**3}


MEASURES = {
    "first": measure_first,
    "hot": measure_hot,
    "straight": loop,
    "turned": lambda side: loop(side, "--yaw", "30", "--pitch", "20"),
    "mean": measure_mean,
    "memory": measure_memory,
}


def build(source: Path, folder: Path, flags: str) -> None:
    """Builds what is measured."""
    told = [f"-DCMAKE_C_FLAGS={flags}"] if flags else []
    call(["cmake", "-S", str(source), "-B", str(folder), "-G", "Ninja", *told])
    call(["ninja", "-C", str(folder), "sv_bench", "host_sim", "smartvis"])


def checkout(commit: str, folder: Path) -> None:
    """Makes the commit's files a folder."""
    asked = ["git", "-C", str(ROOT), "rev-parse", "-q", "--verify", f"{commit}^{{commit}}"]
    if subprocess.run(asked, capture_output=True, check=False).returncode != 0:
        print(f"bench_against: {commit}: no commit of this repository", file=sys.stderr)
        sys.exit(2)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    archive = subprocess.Popen(["git", "-C", str(ROOT), "archive", commit], stdout=subprocess.PIPE)
    call(["tar", "-x", "-C", str(folder)], stdin=archive.stdout)
    archive.wait()


def scans(out: Path, sides: list[Path]) -> list[Path]:
    """Scans of one scene, made once; not compressed, since that is not what is measured."""
    files = [out / "scans" / f"D01_full_{i}.mha" for i in range(MOVING)]
    if not all(file.exists() for file in files):
        made = out / "scans" / "made"
        for i, file in enumerate(files):
            scene = ["scenes", "D01", "--size", str(SIZE), "--seed", str(i + 1), "--export", "--out", str(made)]
            call([str(sides[1] / "host_sim"), *scene])
            header, voxels = (made / "D01_full.mha").read_bytes().split(b"ElementDataFile = LOCAL\n", 1)
            header = re.sub(rb"Compressed.*\n", b"", header)
            file.write_bytes(header + b"ElementDataFile = LOCAL\n" + zlib.decompress(voxels))
        shutil.rmtree(made)
    return files


def measured(wanted: list[str], pairs: dict[str, int], sides: list[Side]) -> dict[str, list[list[dict[str, float]]]]:
    """Runs each measure on both sides in turn, the first of them in turn, too: measure, pair, side, numbers."""
    found: dict[str, list[list[dict[str, float]]]] = {}
    for name in wanted:
        found[name] = []
        if name != "first":
            for side in sides:
                MEASURES[name](side)  # compiles
        for i in range(pairs[name]):
            print(f"{name}: pair {i + 1} of {pairs[name]} ...", end="\r", file=sys.stderr)
            pair = [MEASURES[name](side) for side in (sides if i % 2 == 0 else sides[::-1])]
            found[name].append(pair if i % 2 == 0 else pair[::-1])
    for name in {"straight", "turned"} & found.keys():
        for pair, hot in zip(found[name], found.get("hot", []), strict=False):
            for at, numbers_of in enumerate(pair):
                numbers_of["hot"] = hot[at]["wall"]
    return found


def value(numbers_of: dict[str, float], key: str) -> float | None:
    """Returns a number of a run, or the quotient that the key names; None: it was not measured."""
    parts = [numbers_of.get(part) for part in key.split("/")]
    if any(part is None for part in parts):
        return None
    return parts[0] / parts[1] if len(parts) == 2 else parts[0]  # type: ignore[operator]


def rows_of(found: dict[str, list[list[dict[str, float]]]], processor: str) -> list[list[str]]:
    """Makes the lines of the table."""
    lines = []
    for row in ROWS:
        pairs = [[value(side, row.key) for side in pair] for pair in found.get(row.measure, [])]
        known = [(before, after) for before, after in pairs if before and after]
        if not known:
            continue
        before, after = (statistics.median(pair[side] for pair in known) for side in (0, 1))
        ratio = statistics.median(pair[1] / pair[0] for pair in known)
        goal = (processor == WITHOUT and row.goal_without) or row.goal
        limit = float(goal.split()[0]) if goal else 0.0
        met = "" if not goal else "yes" if (ratio if goal.endswith("x") else after) <= limit else "no"
        lines.append([processor, row.title, f"{before:.2f}", f"{after:.2f}", f"{ratio:.2f}", goal, met, str(len(known))])
    return lines


HEADINGS = ["processor", "work", "before", "after", "ratio", "goal", "met", "pairs"]


def print_table(lines: list[list[str]]) -> None:
    """Prints the table with columns as wide as their longest entry."""
    widths = [max(len(line[i]) for line in [HEADINGS, *lines]) for i in range(len(HEADINGS))]
    for line in [HEADINGS, *lines]:
        left = "  ".join(entry.ljust(width) for entry, width in zip(line[:2], widths, strict=False))
        print(left, *(entry.rjust(width) for entry, width in zip(line[2:], widths[2:], strict=True)), sep="  ")


def processors(only: str | None) -> list[tuple[str, str]]:
    """Which processors this one can be, and what plain C is compiled with for them."""
    flags = Path("/proc/cpuinfo").read_text() if Path("/proc/cpuinfo").exists() else ""
    both = [("as it is", "")] + ([(WITHOUT, "-mno-avx512f")] if "avx512f" in flags else [])
    return [one for one in both if only is None or (one[0] == WITHOUT) == (only == "without")]


def inside(asked: argparse.Namespace, processor: str, flags: str, out: Path) -> list[list[str]]:
    """Builds and measures as one processor."""
    kind = "without" if processor == WITHOUT else "with"
    builds = [out / kind / side for side in ("before", "after")]
    for source, folder in zip((out / "source", ROOT), builds, strict=True):
        build(source, folder, flags)
    files = scans(out, builds)
    sides = [Side(folder, folder / "kernels", folder / "out", files) for folder in builds]
    for side in sides:
        side.kernels.mkdir(exist_ok=True)
        side.out.mkdir(exist_ok=True)
    pairs = {name: asked.first if name == "first" else asked.pairs for name in MEASURES}
    return rows_of(measured(asked.only or list(MEASURES), pairs, sides), processor)


def main() -> int:
    """Reads the command line, measures, prints."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("commit", help="what this checkout is compared with")
    parser.add_argument("--pairs", type=int, default=20, help="pairs of runs (default 20)")
    parser.add_argument("--first", type=int, default=5, help="pairs of first pictures, some 30 s each (default 5)")
    parser.add_argument("--quick", action="store_true", help="3 pairs, 1 of first pictures, and this processor as it is")
    parser.add_argument("--only", action="append", choices=list(MEASURES), help="this measure; may be repeated (default: all)")
    parser.add_argument("--processor", choices=["with", "without"], help="with or without AVX-512 only (default: both)")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "bench_against", help="where builds and table.csv go")
    parser.add_argument("--inside", metavar="FILE", type=Path, help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.quick:
        asked.pairs, asked.first, asked.processor = 3, 1, asked.processor or "with"
    out = asked.out.resolve()
    if asked.inside:
        asked.inside.write_text(json.dumps(inside(asked, *processors(asked.processor)[0], out)))
        return 0
    checkout(asked.commit, out / "source")
    lines = []
    for processor, flags in processors(asked.processor):
        if processor != WITHOUT:
            lines += inside(asked, processor, flags, out)
            continue
        file = out / "without.json"
        again = [sys.executable, __file__, *sys.argv[1:], "--processor", "without", "--inside", str(file)]
        if subprocess.run([str(ROOT / "scripts" / "without_avx512.sh"), *again], check=False).returncode != 0:
            stop("the runs without AVX-512 failed")
        lines += json.loads(file.read_text())
    print_table(lines)
    with (out / "table.csv").open("w", newline="") as file:
        csv.writer(file).writerows([HEADINGS, *lines])
    return int(any(line[6] == "no" for line in lines))


if __name__ == "__main__":
    sys.exit(main())
