# SPDX-License-Identifier: MIT
"""What tests of the lab in Python share: its modules, and small cases that scenes export."""

import os
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(os.environ["SV_SOURCE_DIR"]) / "lab" / "surfaces"))


@pytest.fixture(scope="session")
def exported(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str, int], str]:
    """Makes a scene's files of so many voxels an axis: FULL,TRUTH,LABEL."""
    from smartvis import _host

    @cache
    def export(name: str, size: int) -> str:
        folder = tmp_path_factory.mktemp(f"{name}_{size}")
        _host.run(["scenes", name, "--size", str(size), "--export", "--out", str(folder)])
        return ",".join(f"{folder}/{name}_{part}.mha" for part in ("full", "truth", "label"))

    return export
