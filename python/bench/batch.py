# SPDX-License-Identifier: MIT
"""Volumes a second of a batch with 1 and 2 workers, against reading the files:
batch.py [VOLUMES [SIDE [WORKERS...]]]."""

import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import SimpleITK as sitk

from smartvis import _study
from smartvis._files import Source
from smartvis._work import Settings


def write_study(folder: Path, count: int, side: int) -> list[Path]:
    """Volumes of skin, fluid and fetus, each a little different."""
    z, y, x = np.mgrid[:side, :side, :side]
    files = []
    for number in range(count):
        volume = np.full((side, side, side), 200, np.uint8)
        volume[z < 0.6 * side + 0.1 * np.roll(x, number, axis=2)] = 10
        volume[z < 0.2 * side + 0.1 * y] = 100
        files.append(folder / f"scan{number:04d}.mha")
        sitk.WriteImage(sitk.GetImageFromArray(volume), str(files[-1]))
    return files


def main() -> None:
    given = [int(argument) for argument in sys.argv[1:]]
    count, side, *numbers = given + [60, 128, 1, 2][len(given) :]
    with tempfile.TemporaryDirectory() as folder:
        files = write_study(Path(folder), count, side)
        start = time.perf_counter()
        for file in files:
            Source(file).read()
        reading = time.perf_counter() - start
        print(f"{count} volumes of {side}^3; reading alone: {count / reading:.1f} a second")
        settings = Settings(parameters={"method": "mean"}, scanned="auto", products=("depth",))
        for workers in numbers:
            with _study.cluster(None, workers, lambda link: None) as client:
                first = files[: 4 * workers]
                warm = _study.batch(first, settings, Path(folder) / f"warm{workers}", client, lambda: None)
                start = time.perf_counter()
                rows = _study.batch(files, settings, Path(folder) / f"out{workers}", client, lambda: None)
                passed = time.perf_counter() - start
            busy = sum(r["read_ms"] + r["clip_ms"] + r["write_ms"] for r in rows) / 1e3
            assert all(r["state"] == "ok" for r in rows + warm)
            print(
                f"{workers} worker{'s' * (workers > 1)}: {count / passed:.1f} a second; of a volume's "
                f"{1e3 * passed * workers / count:.1f} ms in a worker {1e3 * (passed * workers - busy) / count:.1f} ms "
                "are neither reading, clipping nor writing"
            )


if __name__ == "__main__":
    main()
