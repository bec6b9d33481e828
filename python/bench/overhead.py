# SPDX-License-Identifier: MIT
"""What a frame costs in Python beyond the same calls in C: overhead.py [SIDE [FRAMES]].

Both run the plugin of the package with its defaults on the same volume. The least time of many frames is taken,
in turns, so that other work on the machine does not count. At 128^3 less than 0.2 ms are promised; exit code 1
if it is more.
"""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import smartvis

HERE = Path(__file__).resolve().parent
ROUNDS = 5
PROMISED = {128: 0.2}  # ms by side


def least_in_python(clipper: smartvis.Clipper, volume: np.ndarray, frames: int) -> float:
    """Milliseconds of the fastest frame."""
    least = 1e9
    for number in range(frames):
        start = time.perf_counter()
        clipper(volume)
        if number > 2:
            least = min(least, 1e3 * (time.perf_counter() - start))
    return least


def measure(side: int = 128, frames: int = 200) -> tuple[float, float]:
    """Milliseconds of a frame in C and in Python."""
    volume = np.empty((side, side, side), np.uint8)
    volume[:] = 200
    volume[: 3 * side // 5] = 10
    volume[: side // 5] = 100
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "c_frames"
        include = HERE.parents[1] / "include"
        build = ["cc", "-O2", "-std=c11", "-D_GNU_SOURCE", "-I", include, HERE / "c_frames.c", "-o", program, "-ldl"]
        subprocess.run(list(map(str, build)), check=True)
        command = [str(program), smartvis.load().path, str(side), str(frames)]
        in_c = in_python = 1e9
        with smartvis.Clipper(volume.shape, (1, 1, 1)) as clipper:
            for _ in range(ROUNDS):
                in_c = min(in_c, float(subprocess.run(command, check=True, capture_output=True, text=True).stdout))
                in_python = min(in_python, least_in_python(clipper, volume, frames))
    return in_c, in_python


if __name__ == "__main__":
    side, frames = int(sys.argv[1]) if len(sys.argv) > 1 else 128, int(sys.argv[2]) if len(sys.argv) > 2 else 200
    in_c, in_python = measure(side, frames)
    print(f"{side}^3: a frame in C {in_c:.3f} ms, in Python {in_python:.3f} ms, overhead {in_python - in_c:.3f} ms")
    sys.exit(in_python - in_c > PROMISED.get(side, np.inf))
