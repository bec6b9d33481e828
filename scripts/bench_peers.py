#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""bench_peers.py [BUILD_FOLDER]: the mean filter and the spline of other libraries on the points of
sv_surfaces_bench, after its own table in the same run. Needs numpy and scipy, and cv2 (opencv-python-headless)
for the box filter; what is missing is skipped with a message. Nothing else in the project needs Python."""
import os
import subprocess
import sys
import tempfile
import time

SIZES = (128, 171, 512)
KERNELS = (11, 23, 55)
Q = 0.5
FILLED = 0.5  # weight of pixels that an earlier pass filled, against 1 of initial points
MERGE = 8     # cells per side for the spline's points
FRAMES, SECONDS = 10, 2.0


def load(program, size):
    """Status, and both interval ends, as maps."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "points.txt")
        subprocess.run([program, "--size", str(size), "--points", path], check=True)
        x, y, near_end, far_end = np.loadtxt(path, unpack=True)
    maps = np.zeros((3, size, size))
    maps[:, y.astype(int), x.astype(int)] = np.ones_like(x), near_end, far_end
    return maps


def mean_filter(box, maps):
    """Passes until every pixel has a surface; box(map) sums windows. Returns S(q) and the passes."""
    initial = maps[0] > 0
    weight, near_sum, far_sum = maps[0].copy(), maps[1].copy(), maps[2].copy()
    passes = 0
    while True:
        weight, near_sum, far_sum = box(weight), box(near_sum), box(far_sum)
        passes += 1
        filled = weight > 0.25  # the smallest weight is 0.5; running sums may leave crumbs
        divisor = np.where(filled, weight, 1)
        near_end, far_end = near_sum / divisor, far_sum / divisor
        if filled.all():
            return far_end + Q * (near_end - far_end), passes
        weight = np.where(filled, np.where(initial, 1, FILLED), 0).astype(maps.dtype)
        near_sum, far_sum = near_end * weight, far_end * weight


def merged(maps):
    """Means of the points in MERGE x MERGE cells: places (x, y) and depths S(q)."""
    size = maps.shape[1]
    y, x = np.nonzero(maps[0])
    depth = maps[2][y, x] + Q * (maps[1][y, x] - maps[2][y, x])
    cell = (y * MERGE // size) * MERGE + x * MERGE // size
    count = np.bincount(cell, minlength=MERGE * MERGE)
    sums = [np.bincount(cell, weights=values, minlength=MERGE * MERGE) for values in (x, y, depth)]
    x, y, depth = (values[count > 0] / count[count > 0] for values in sums)
    return np.column_stack([x, y]), depth


def dense_spline(places, depth, pixels):
    """The definition: the whole matrix of the thesis' Eq. 3.8 in float64."""
    def phi(a, b):
        r2 = ((a[:, None, :] - b[None, :, :]) ** 2).sum(axis=2)
        return 0.5 * r2 * np.log(np.where(r2 > 0, r2, 1))
    n = len(places)
    plane = np.column_stack([np.ones(n), places])
    matrix = np.block([[phi(places, places), plane], [plane.T, np.zeros((3, 3))]])
    solution = np.linalg.solve(matrix, np.concatenate([depth, np.zeros(3)]))
    return phi(pixels, places) @ solution[:n] + np.column_stack([np.ones(len(pixels)), pixels]) @ solution[n:]


def timed(work):
    """Times in ms of several runs, and the last result."""
    times, start = [], time.perf_counter()
    while len(times) < 3 or (len(times) < FRAMES and time.perf_counter() - start < SECONDS):
        begin = time.perf_counter()
        result = work()
        times.append((time.perf_counter() - begin) * 1e3)
    return times, result


def show(label, passes, times, surface, exact):
    error = "%9s %9s" % ("-", "-") if exact is None else "%9.2e %9.2e" % (
        np.abs(surface - exact).max(), np.abs(surface - exact).mean())
    print("%-24s %4s %6u | %9s %9.3f %9.3f | %7s %8s %13s | %s" % (
        label, "-", passes, "-", np.median(times), min(times), "-", "-", "-", error), flush=True)


def peers(program, size):
    maps = load(program, size)
    print("\nPeers, %u x %u pixels, %u initial points; milliseconds, errors against float64, slices" % (
        size, size, maps[0].sum()))
    single = maps.astype(np.float32)
    for k in KERNELS:
        def scipy_box(a, k=k):
            return ndimage.uniform_filter(a, k, mode="constant") * (k * k)
        times, (surface, passes) = timed(lambda: mean_filter(scipy_box, maps))
        exact = None
        if cv2:
            def cv_box(a, k=k):
                return cv2.boxFilter(a, -1, (k, k), normalize=False, borderType=cv2.BORDER_CONSTANT)
            double_times, (exact, _) = timed(lambda: mean_filter(cv_box, maps))
            single_times, (close, _) = timed(lambda: mean_filter(cv_box, single))
            show("OpenCV box %u, f32" % k, passes, single_times, close, exact)
            show("OpenCV box %u, f64" % k, passes, double_times, exact, None)
        show("SciPy uniform %u, f64" % k, passes, times, surface, exact)
    places, depth = merged(maps)
    pixels = np.stack(np.meshgrid(np.arange(size), np.arange(size)), axis=-1).reshape(-1, 2).astype(float)
    times, surface = timed(
        lambda: interpolate.RBFInterpolator(places, depth, kernel="thin_plate_spline")(pixels))
    show("SciPy RBF, merged %u" % MERGE, 1, times, surface, dense_spline(places, depth, pixels))


def main():
    build = sys.argv[1] if len(sys.argv) > 1 else "build"
    program = os.path.join(build, "sv_surfaces_bench")
    if not os.path.exists(program):
        sys.exit("bench_peers: %s: no such program; build it, or name the build folder" % program)
    if cv2 is None:
        print("bench_peers: no cv2 (opencv-python-headless): its box filter is skipped")
    methods = ["--method", "mean", "--method", "spline"]
    subprocess.run([program, "--quick", "--no-truth", "--no-fit"] + methods, check=True)
    for size in SIZES:
        peers(program, size)


try:
    import numpy as np
    from scipy import interpolate, ndimage
except ImportError as missing:
    print("bench_peers: skipped: %s" % missing)
    sys.exit(0)
try:
    import cv2
except ImportError:
    cv2 = None
if __name__ == "__main__":
    main()
