# SPDX-License-Identifier: MIT
"""Where plugin, machine and ABI are looked for: of a wheel, a clone that pip installed, an editable one, a build
folder. tests/python/editable.sh installs one."""

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest
from conftest import BUILD, SOURCE

from smartvis import _places

Install = Callable[..., None]


@pytest.fixture
def clone(tmp_path: Path, monkeypatch) -> Path:
    """A clone with a package in it; it has no plugin yet."""
    (tmp_path / "clone" / "python" / "smartvis").mkdir(parents=True)
    monkeypatch.setattr(_places, "_PACKAGE", tmp_path / "site" / "smartvis")
    return tmp_path / "clone"


@pytest.fixture
def install(clone: Path, monkeypatch) -> Install:
    """What pip writes down."""

    def write(said: object) -> None:
        site = clone.parent / "site"
        pip = SimpleNamespace(read_text=lambda name: json.dumps(said), locate_file=lambda name: site / name)
        monkeypatch.setattr("smartvis._places.metadata.distribution", lambda name: pip)
        _places._installed.cache_clear()

    return write


@pytest.fixture(autouse=True)
def fresh() -> object:
    yield
    _places._installed.cache_clear()


def put(path: Path) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.touch()
    return path


def test_of_a_wheel_only_its_own_counts(clone: Path, install: Install) -> None:
    install({"archive_info": {}, "url": (clone / "out" / "smartvis.whl").as_uri()})
    built = put(clone / "build" / "host_sim")
    assert _places.find("host_sim") != built
    own = put(clone.parent / "site" / "smartvis" / "plugin" / "host_sim")
    assert _places.find("host_sim") == own


def test_the_clone_that_pip_was_given_is_known(clone: Path, install: Install) -> None:
    install({"dir_info": {}, "url": (clone / "python").as_uri()})
    built = put(clone / "build" / "host_sim")
    assert _places.clone() == clone and _places.find("host_sim") == built
    own = put(clone.parent / "site" / "smartvis" / "plugin" / "host_sim")
    assert _places.find("host_sim") == own and _places.built("host_sim") == built


def test_of_an_editable_one_the_rest_is_where_pip_put_it(clone: Path, install: Install, monkeypatch) -> None:
    monkeypatch.setattr(_places, "_PACKAGE", clone / "python" / "smartvis")
    install({"dir_info": {"editable": True}, "url": (clone / "python").as_uri()})
    there = put(clone.parent / "site" / "smartvis" / "plugin" / "smartvis.so")
    assert _places.find("smartvis.so") == there and _places.clone() == clone


def test_another_installation_says_nothing_of_this_one(clone: Path, install: Install, monkeypatch) -> None:
    monkeypatch.setattr(_places, "_PACKAGE", clone.parent / "other" / "python" / "smartvis")
    for how in ({"editable": True}, {}):
        install({"dir_info": how, "url": (clone / "python").as_uri()})
        assert _places.clone() == clone.parent / "other"


def test_a_build_folder_imports_the_package_and_not_the_plugin() -> None:
    code = "import smartvis; print(smartvis.__file__, smartvis.load().path, smartvis.parameters()['q'].default)"
    done = subprocess.run([sys.executable, "-c", code], cwd=BUILD, check=True, capture_output=True, text=True)
    package, plugin, q = done.stdout.split()
    assert Path(package).resolve() == SOURCE / "python" / "smartvis" / "__init__.py"
    assert Path(plugin) == BUILD / "smartvis.so" and 0 < float(q) < 1
