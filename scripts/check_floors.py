#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""check_floors.py ROOT [BUILD]: the walls between the folders. Prints every breach; exit code 1 if there is one.

- A file includes only what its floor may include, by the table below, and lies in a folder that the table knows.
- Nothing includes in a circle. A source and its header count as one: x.c and x.h.
- With BUILD, a built folder: includes do not tell who calls whom, since a header may declare what a file of a higher floor
  defines. So the symbols of the objects of src/, base/, sdk/, host_sim/ and lab/ are looked at: neither sources nor their
  folders may use each other in a circle.
"""

import graphlib
import os
import re
import subprocess
import sys
from pathlib import Path

# Folders or files | what its "..." includes may name | which <...> groups it may use. The first line that fits counts.
#   FOLDER  a file directly in it        .         its own folder
#   abi     include/, include/smartvis/  shared    cl/*/*_shared.h
#   any     whatever is found            kernels   the embedded kernels and pages that the build generates
FLOORS = """
include | | fixed
include/smartvis/author*.h include/smartvis/band.h include/smartvis/lengths.h include/smartvis/lookup.h include/smartvis/probe.h | abi | fixed libc
include/smartvis/device.h | abi | fixed libc
include/smartvis/open.h | abi | fixed libc windows
include/smartvis | abi | fixed
cl/common | . |
cl/* | cl/common . |
src | abi shared . | libc
src/ref | shared src . | libc
src/device | abi shared kernels . | libc opencl
src/method | abi shared kernels src src/ref src/device . | libc opencl
src/frame | abi shared kernels src src/ref src/device src/method . | libc opencl
src/abi | abi shared src src/device src/method src/frame . | libc opencl
base/core/system_windows.c | . | libc windows
base/core | . | libc json
base/guard/child_windows.c | base/core . | libc windows
base/guard | base/core . | libc
host_sim/volume | abi base/core . | libc zlib
host_sim/picture/*_windows.c | base/core . | libc windows
host_sim/picture | base/core . | libc drawing zlib
base/plugin | abi base/core . | libc
host_sim/scene | base/core host_sim/volume . | libc json
host_sim/render | abi base/core base/opencl host_sim/volume kernels . | libc opencl
host_sim/render/cl | . |
base/opencl | abi base/core . | libc opencl
base/guarded | abi base/core base/guard base/plugin base/opencl . | libc opencl
host_sim/loop | abi MACHINE . | libc opencl
host_sim/door/smartvis_host.h | . | fixed
host_sim/door | abi MACHINE host_sim/loop host_sim/result . | libc opencl
host_sim/result | abi MACHINE host_sim/loop . | libc opencl
host_sim/program/not_here_windows.c | base/core host_sim/console lab/report . | libc
host_sim/show | abi MACHINE host_sim/picture host_sim/loop . | libc opencl
host_sim/commands | abi HOST host_sim/show . | libc opencl json
lab/page | base/core host_sim/picture . | libc
lab/eval | abi MACHINE host_sim/loop . | libc opencl zlib
lab/report | abi HOST host_sim/show host_sim/commands lab/page lab/eval . | libc opencl json zlib
host_sim/console | abi HOST host_sim/show host_sim/commands kernels . | libc opencl json web
lab/bench | abi HOST sdk/stage . | libc opencl futex
sdk/layer | abi base/core sdk/rules sdk/record . | libc opencl
sdk/record | abi base/core sdk/rules . | libc opencl zlib
sdk/replay | abi base/core base/guard base/plugin base/opencl base/guarded sdk/rules sdk/record . | libc opencl drawing
sdk/validate/spy/*_pe.c | . | libc windows
sdk/validate/spy | base/core . | libc opencl elf
sdk/rules | abi . | libc
sdk/stage | abi base/core . | libc opencl
sdk/validate/drive/process_windows.c | sdk/validate/spy . | libc windows
sdk/validate/drive | abi base/core base/plugin sdk/rules sdk/stage sdk/validate/spy . | libc opencl
sdk/validate/checks | abi base/core base/plugin sdk/rules sdk/stage sdk/validate/spy sdk/validate/drive . | libc opencl
sdk/validate | abi base/core base/guard sdk/validate/drive sdk/validate/checks . | libc json
host_sim/program | abi HOST host_sim/commands lab/report host_sim/console . | libc
examples/* | abi kernels . | libc opencl
bindings/rust/src | abi |
tests/* | any kernels | any
tests/*/* | any kernels | any
"""
MACHINE = "base/core base/guard base/opencl base/guarded host_sim/volume" \
          " base/plugin host_sim/scene host_sim/render"
HOST = MACHINE + " host_sim/picture host_sim/loop host_sim/result"

GROUPS = {
    "fixed": "stdint.h stddef.h",
    "libc": "assert.h ctype.h dirent.h dlfcn.h errno.h fcntl.h fenv.h float.h getopt.h glob.h inttypes.h limits.h locale.h math.h "
            "malloc.h poll.h pthread.h sched.h setjmp.h signal.h stdalign.h stdarg.h stdatomic.h stdbool.h stddef.h stdint.h stdio.h stdlib.h "
            "string.h strings.h threads.h time.h unistd.h wchar.h sys/*",
    "opencl": "CL/*",
    "elf": "elf.h link.h",
    "windows": "io.h psapi.h sddl.h shellapi.h tlhelp32.h windows.h",
    "futex": "linux/futex.h",
    "zlib": "zlib.h",
    "json": "jansson.h",
    "web": "civetweb.h arpa/* netdb.h",
    "drawing": "png.h turbojpeg.h cairo.h fontconfig/*",
}
# Where a "..." may be found from each part of the tree.
ROOTS = {
    "include": "include", "cl": "cl", "src": "include src cl", "base": "include base", "host_sim": "include base host_sim lab",
    "sdk": "include base sdk", "lab": "include base host_sim lab sdk",
    "examples": "include", "bindings": "include", "python": "include",
    "tests": "include tests tests/sdk tests/host_sim base sdk lab host_sim src cl",
}


def fits(name, pattern):
    """True if a path is the pattern's, where * stands for what has no slash."""
    return re.fullmatch(re.escape(pattern).replace(r"\*", "[^/]*"), name) is not None


def floors():
    """The table's lines: names, what may be included, groups."""
    lines = FLOORS.replace(" HOST ", f" {HOST} ").replace(" MACHINE ", f" {MACHINE} ").strip().splitlines()
    return [[column.split() for column in line.split("|")] for line in lines]


def may_name(allowed, source, name, path):
    """True if a file of a floor may include "name", which lies at `path` (None: nowhere)."""
    if name == "sv_version.h":  # which the build makes, and nothing depends on
        return True
    if "kernels" in allowed and re.fullmatch(r"((hs_)?kernels|hs_page)_[a-z_]+\.h", name):
        return True
    if path is None or (".." in name and "any" not in allowed):
        return False
    folder = str(path.parent)
    kinds = {"any": True, "abi": folder in {"include", "include/smartvis"}, "shared": fits(str(path), "cl/*/*_shared.h"),
             ".": path.parent == source.parent}
    return any(kinds.get(word, word == folder) for word in allowed)


def circles(arrows, what):
    """Names a circle of the graph {node: what it needs}, if there is one."""
    try:
        graphlib.TopologicalSorter(arrows).prepare()
    except graphlib.CycleError as error:
        yield from (f"{node}: in a circle of {what}" for node in sorted(set(error.args[1])))


def includes(root):
    """Every breach of the table in the sources below `root`."""
    table, arrows = floors(), {}
    sources = [path.relative_to(root) for path in root.rglob("*") if path.suffix in {".c", ".h", ".cl", ".clh"} and path.is_file()]
    sources = sorted(path for path in sources if not re.match(r"build|out$|\.", path.parts[0]))
    for source in sources:
        floor = next((line for line in table if any(fits(str(source if "." in pattern else source.parent), pattern)
                                                     for pattern in line[0])), None)
        if floor is None:
            yield f"{source}:1: a source in a folder without a rule"
            continue
        for number, line in enumerate((root / source).read_text().splitlines(), 1):
            found = re.match(r"\s*(?:#|%:)\s*(?:include|import|embed)(?:\s*([<\"])([^>\"]*)[>\"])?", line)
            if not found:
                continue
            kind, name = found.groups()
            system = (one for group in floor[2] for one in (["*", "*/*"] if group == "any" else GROUPS[group].split()))
            if kind is None or "%:" in line:
                yield f"{source}:{number}: include a file by its name: {line}"
            elif kind == "<" and not any(fits(name, pattern) for pattern in system):
                yield f"{source}:{number}: <{name}> is not for {source.parent}"
            elif kind == '"':
                places = [source.parent, *map(Path, ROOTS.get(source.parts[0], "").split())]
                near = ((root / place / name).resolve() for place in places)
                path = next((place.relative_to(root) for place in near if place.is_file()), None)
                if not may_name(floor[1], source, name, path):
                    yield f'{source}:{number}: "{name}" is not for {source.parent}'
                if path and path.with_suffix("") != source.with_suffix(""):
                    arrows.setdefault(str(source.with_suffix("")), set()).add(str(path.with_suffix("")))
    yield from circles(arrows, "includes")


def source_of(place):
    """The source of an object below obj/, where "__" is the folder above that of its target."""
    path = re.sub(r"^.*/obj/|CMakeFiles/[^/]*\.dir/|\.o:$", "", place)
    return os.path.normpath(re.sub("^door/", "host_sim/door/", path).replace("__", ".."))


def calls(build):
    """Circles among the objects of a build folder, by who uses whose symbols."""
    owner, uses, arrows = {}, [], ({}, {})
    objects = [path for path in (build / "obj").rglob("*.c.o") if path.relative_to(build).parts[1] not in {"tests", "examples"}]
    listed = subprocess.run(["nm", "-A", "-g", "-P", *objects], capture_output=True, text=True, check=True).stdout
    for place, symbol, kind, *_ in map(str.split, listed.splitlines()):
        source = source_of(place)
        if kind == "U":
            uses.append((source, symbol))
        elif kind != "w" and not re.search(r"/spy/|/old_libc\.c$", source):  # these define names of libc and OpenCL
            owner[symbol] = source
    for user, symbol in uses:
        used = owner.get(symbol, user)
        pairs = ((user, used), (str(Path(user).parent), str(Path(used).parent)))
        for graph, (one, other) in zip(arrows, pairs, strict=True):
            if one != other:
                graph.setdefault(one, set()).add(other)
    yield from circles(arrows[0], "calls of sources")
    yield from circles(arrows[1], "calls of folders")


if __name__ == "__main__":
    breaches = list(includes(Path(sys.argv[1]).resolve()))
    if len(sys.argv) > 2:
        breaches += calls(Path(sys.argv[2]).resolve())
    for breach in breaches:
        print("floors:", breach)
    sys.exit(bool(breaches))
