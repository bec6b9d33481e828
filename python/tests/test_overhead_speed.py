# SPDX-License-Identifier: MIT
"""A frame of 128^3 in Python costs less than 0.2 ms more than the same calls in C (python/bench/overhead.py)."""

import sys

from conftest import SOURCE

sys.path.insert(0, str(SOURCE / "python" / "bench"))

from overhead import measure  # noqa: E402


def test_a_frame_costs_little_more_than_in_c() -> None:
    in_c, in_python = measure(128, 60)
    print(f"a frame in C {in_c:.3f} ms, in Python {in_python:.3f} ms")
    assert in_python - in_c < 0.2
