# SPDX-License-Identifier: MIT
"""numpy in, numpy out: clips a synthetic volume, moves the surface, and says how much was in the way."""

import numpy as np

import smartvis

# A skin, a gap of fluid, and a ball in it before the back of the sac.
z, y, x = np.mgrid[:96, :96, :96]
volume = np.where(z < 20, 110, 12).astype(np.uint8)
volume[90:] = 130
volume[(x - 48) ** 2 + (y - 48) ** 2 + (z - 70) ** 2 < 22**2] = 200

result = smartvis.clip(volume, spacing=(0.8, 0.8, 0.8))
print(f"outcome {result.outcome.name}; over the ball the surface is at {result.depth_mm[48, 48]:.1f} mm")

clipped = result.apply(volume)
print(f"{np.count_nonzero(volume == 110)} voxels of skin before, {np.count_nonzero(clipped == 110)} after")
print(f"{np.count_nonzero(volume == 200)} voxels of the ball before, {np.count_nonzero(clipped == 200)} after")

# A sequence: the plugin is activated once.
with smartvis.Clipper(volume.shape, spacing=(0.8, 0.8, 0.8)) as clipper:
    for shift in range(0, 12, 4):
        depth = clipper(np.roll(volume, shift, axis=2)).depth
        print(f"ball moved by {shift:2} voxels: mean depth {depth.mean():.2f} slices")
    print(f"surface position 0: {clipper.adjust(q=0).depth.mean():.2f} slices")
