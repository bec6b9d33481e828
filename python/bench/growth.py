# SPDX-License-Identifier: MIT
"""Time and memory against the size of a volume: growth.py [--size X,Y,Z]... [--csv FILE] [--svg FILE].

A scene of 128^3, stretched to each size, as a file. *run* is `host_sim run` of it with new volumes: medians of the
stages of its loop, and its peak of memory. *picture* is the same run, once, with all that it writes. *clip* is
`smartvis clip` of the file. A peak is in bytes of the volume, without what the same command needs for a volume of 32^3,
which is mostly the OpenCL runtime or Python. The growth is the time for each voxel, in that of the first size. The plot
needs matplotlib.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import SimpleITK as sitk

import smartvis
from smartvis import _host

sys.path.append(str(Path(__file__).parent / "shared"))
from tables import Row, add_outputs, save

SIZES = ((128, 128, 128), (256, 256, 256), (400, 400, 400), (512, 512, 512), (1024, 1024, 512))
SCENE, SCENE_SIZE, SMALL, EXTENT_MM = "D01", 128, (32, 32, 32), 120.0
STAGES = {"upload": "upload", "convert": "scan_conversion", "plugin": "plugin", "picture": "dvr"}
# The peak of a process that starts another one belongs to it, so each command has one that asks.
ASKS = """import resource, subprocess, sys
code = subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL).returncode
print(code, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)"""


def write(size: tuple[int, ...], path: Path) -> None:
    """The scene with so many voxels along x, y and z, each the nearest one's."""
    voxels = smartvis.scene(SCENE, size=SCENE_SIZE).full
    for axis, count in enumerate(reversed(size)):
        voxels = np.take(voxels, np.arange(count) * SCENE_SIZE // count, axis=axis)
    image = sitk.GetImageFromArray(voxels)
    image.SetSpacing([EXTENT_MM / count for count in size])
    sitk.WriteImage(image, str(path))


def peak(*command: object) -> tuple[float, float]:
    """Seconds that a command takes, and the bytes that it holds at most. RuntimeError if it fails."""
    begin = time.perf_counter()
    asked = subprocess.run([sys.executable, "-c", ASKS, *map(str, command)], capture_output=True, text=True, check=True)
    code, kib = map(int, asked.stdout.split()[-2:])
    if code:
        raise RuntimeError(f"{' '.join(map(str, command))} ends with {code}\n{asked.stderr}")
    return time.perf_counter() - begin, 1024.0 * kib


def measure(size: tuple[int, ...], folder: Path, frames: int) -> dict[str, float]:
    """Times in ms of the loop's stages, and peaks in bytes."""
    path, out = folder / "volume.mha", folder / "out"
    write(size, path)
    few = ("--setting", "smartvis", "--few-pictures", "--no-guard", "--out", out)
    loop = ("--live", "--frames", frames, "--json", folder / "loop.json")
    _, run = peak(_host.find(), "run", "--volume", path, *few, *loop)
    _, picture = peak(_host.find(), "run", "--volume", path, "--frames", 1, *few)
    seconds, clip = peak(sys.executable, "-P", "-m", "smartvis", "clip", path, "--write", "depth", "--out", out)
    stages = json.loads((folder / "loop.json").read_text())["settings"]["smartvis"]["stages"]
    times = {name: stages[stage]["median_ms"] for name, stage in STAGES.items()}
    return {**times, "clip": 1e3 * seconds, "run_peak": run, "picture_peak": picture, "clip_peak": clip}


def plot(rows: list[Row], path: str) -> None:
    """Time and memory against the voxels, and what is linear."""
    from matplotlib.figure import Figure

    figure = Figure((12, 5), layout="constrained")
    times, memory = figure.subplots(1, 2)
    voxels = [row["voxels"] for row in rows]
    for name in (*STAGES, "clip"):
        times.plot(voxels, [row[name] for row in rows], "o-", label=name)
    least, most = min(row["convert"] for row in rows), voxels[-1] / voxels[0]
    times.plot([voxels[0], voxels[-1]], [least, least * most], ":", color="0.5", label="linear")
    times.set(xscale="log", yscale="log", xlabel="voxels", ylabel="time, ms")
    for name in ("run_peak", "picture_peak", "clip_peak"):
        memory.plot(voxels, [row[name] for row in rows], "o-", label=name.removesuffix("_peak"))
    memory.set(xscale="log", ylim=(0, None), xlabel="voxels", ylabel="peak beyond that of 32³, volumes")
    for axes in (times, memory):
        axes.legend()
        axes.grid(alpha=0.3)
    figure.savefig(path)


def size_of(text: str) -> tuple[int, ...]:
    """X,Y,Z, or one number for all three."""
    size = tuple(int(part) for part in text.split(","))
    if len(size) not in (1, 3) or min(size) < 32:
        raise argparse.ArgumentTypeError(f"'{text}' is not X,Y,Z from 32 on")
    return size if len(size) == 3 else 3 * size


def main() -> None:
    parse = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parse.add_argument("--size", type=size_of, action="append", metavar="X,Y,Z", help="these sizes only; N: a cube")
    parse.add_argument("--frames", type=int, default=15, help="new volumes in the loop (%(default)s)")
    add_outputs(parse)
    given = parse.parse_args()
    rows = list[Row]()
    names = (*STAGES, "clip")
    heads = " ".join(f"{name:>8}" for name in names)
    print(f"{'size':>16} | ms: {heads} | volumes: {'run':>5} picture  clip", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        os.environ.pop("SMARTVIS_QUICK_KERNELS", None)
        least = measure(SMALL, Path(folder), given.frames)
        for size in given.size or SIZES:
            row: Row = measure(size, Path(folder), given.frames)
            row |= {"voxels": int(np.prod(size)), "size": " x ".join(map(str, size))}
            row |= {name: (row[name] - least[name]) / row["voxels"] for name in row if name.endswith("_peak")}
            rows.append(row)
            peaks = "{run_peak:5.1f} {picture_peak:7.1f} {clip_peak:5.1f}".format(**row)
            times = " ".join(f"{row[name]:8.1f}" for name in names)
            print(f"{row['size']:>16} |     {times} |          {peaks}", flush=True)
    for name in names:
        growth = [row[name] / row["voxels"] * rows[0]["voxels"] / rows[0][name] for row in rows]
        print(f"{name:>16}: {' '.join(f'{times:.2f}' for times in growth)} times as long for each voxel")
    save(rows, given, plot)


if __name__ == "__main__":
    main()
