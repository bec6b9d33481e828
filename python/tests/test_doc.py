# SPDX-License-Identifier: MIT
"""What the docstrings show is true, and numpy is the only package that must be there."""

import doctest
import importlib
import pkgutil
import subprocess
import sys

import pytest

import smartvis

MODULES = [smartvis.__name__, *(f"smartvis.{m.name}" for m in pkgutil.iter_modules(smartvis.__path__))]


@pytest.mark.parametrize("name", [m for m in MODULES if not m.endswith("__main__")])
def test_examples_in_docstrings_hold(name: str) -> None:
    assert doctest.testmod(importlib.import_module(name)).failed == 0


def test_there_are_examples() -> None:
    finder = doctest.DocTestFinder()
    examples = sum(len(t.examples) for m in MODULES for t in finder.find(importlib.import_module(m)))
    assert examples >= 15


def test_numpy_is_enough() -> None:
    """With every other package hidden, arrays are clipped, from any side, and what needs one says which."""
    code = """
import sys
class Hidden:
    def find_spec(self, name, path=None, target=None):
        if name.split('.')[0] in ('scipy', 'SimpleITK', 'skimage', 'tqdm', 'pyigtl', 'crcmod', 'distributed', 'dask'):
            raise ModuleNotFoundError(f'No module named {name!r}', name=name)
sys.meta_path.insert(0, Hidden())
import numpy as np, smartvis
volume = np.full((32, 32, 32), 200, np.uint8); volume[:20] = 10; volume[:6] = 100
assert smartvis.clip(volume, (1, 1, 1)).clips
assert smartvis.clip(volume, (1, 1, 1), view=(0, 1, 0)).camera.aligned
assert not smartvis.clip(volume, (1, 1, 1), view=(1, 1, 1)).camera.aligned
try:
    smartvis._images.sitk()
except smartvis.MissingExtraError as error:
    print(error)
"""
    out = subprocess.run([sys.executable, "-P", "-c", code], check=True, capture_output=True, text=True).stdout
    assert out.count("pip install 'smartvis[") == 1
