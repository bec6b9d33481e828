# SPDX-License-Identifier: MIT
"""OpenCL runtimes that come from PyPI, for machines without one of their own."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Mapping
from importlib import metadata
from pathlib import Path

from . import _abi

WINDOWS = os.name == "nt"
LIBRARY = ".dll" if WINDOWS else ".so"  #: what a library's name ends with
_VENDORS = Path("/etc/OpenCL/vendors")  #: where the system's runtimes are listed
#: Of the loaders of Debian and of Khronos, in this order. Whoever sets one of them has chosen.
_VARIABLES = ("OCL_ICD_VENDORS", "OCL_ICD_FILENAMES")
#: Packages with a runtime for the processor, and its library. The second is free software and small.
_PACKAGES = (("intel-opencl-rt", r"libintelocl\.so[.\d]*"), ("pocl-binary-distribution", r"libpocl.*\.so[.\d]*"))
_POCL = "pip install pocl-binary-distribution"
_INTEL = "pip install intel-opencl-rt intel-cmplr-lib-rt"


def open_standard() -> None:
    """Descriptors 0 to 2, which a daemon may have closed: else a file that is opened next becomes one of them, and
    gets what libraries print."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # becomes the lowest that is free


_used_in: list[int] = []  # the processes in which OpenCL was used, of this one and those it was forked from


def is_forked() -> bool:
    """True if OpenCL was used before this process was forked."""
    return bool(_used_in) and _used_in[0] != os.getpid()


def check_process() -> None:
    """To be called before OpenCL is used. RuntimeError: it was used before this process was forked, and does not
    survive that: whoever waits for its threads waits for ever."""
    if not _used_in:
        _used_in.append(os.getpid())
    if is_forked():
        raise RuntimeError(
            "smartvis was used before this process was forked, which OpenCL does not survive: start processes with "
            "multiprocessing.get_context('spawn') or 'forkserver'"
        )


def use_one() -> None:
    """Tells the loader of a runtime from PyPI, if the system has none and nobody has chosen. To be called before the
    process' first use of OpenCL."""
    os.environ.update(chosen())


def chosen() -> dict[str, str]:
    """The variables that tell the loader of a runtime from PyPI; none if the system has one, or somebody has chosen."""
    found = find()
    if (
        found
        and not _lacks_linker(found)
        and not any(_VENDORS.glob("*.icd"))
        and not any(name in os.environ for name in _VARIABLES)
    ):
        return dict.fromkeys(_VARIABLES, found)
    return {}


def find() -> str | None:
    """The library of an installed runtime from PyPI."""
    for package, library in _PACKAGES:
        try:
            files = metadata.files(package) or []
        except metadata.PackageNotFoundError:
            continue
        for file in files:
            if re.fullmatch(library, file.name):
                return os.path.abspath(str(file.locate()))
    return None


def _lacks_linker(library: str) -> bool:
    """True if that is PoCL on a machine without a linker, which it calls for every kernel: it would end the process."""
    return "libpocl" in library and shutil.which("ld") is None


def cure(said: str, environment: Mapping[str, str] | None = None) -> str:
    """`mend` for the machine's code, which says in words alone that OpenCL is what is missing."""
    return mend(_abi.SV_ERR_NO_DEVICE if "no OpenCL " in said else _abi.SV_ERR_BUILD, said, environment)


def mend(status: int, reason: str, environment: Mapping[str, str] | None = None) -> str:
    """What to do where OpenCL is what is missing: " (...)" for the end of a message, else nothing. `environment` is of
    the process that misses it, None: this one."""
    found = find()
    if status == _abi.SV_ERR_BUILD and "unknown target CPU" in reason:
        return f" (this PoCL is older than the processor: {_INTEL})"
    if status != _abi.SV_ERR_NO_DEVICE:
        return ""
    if WINDOWS:
        return " (a driver with OpenCL is missing: that of the graphics card or of the processor)"
    if found is None:
        return f" (a runtime for the processor: {_POCL if shutil.which('ld') else _INTEL})"
    if _lacks_linker(found):
        return f" (PoCL needs a linker, which is missing: {_INTEL})"
    told = (os.environ if environment is None else environment).get(_VARIABLES[0])
    return f" (the one from PyPI: export {_VARIABLES[0]}={found})" if told != found else ""
