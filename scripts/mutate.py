# SPDX-License-Identifier: MIT
"""mutate.py: does a test notice?

Makes small changes at random places of the sources in C, OpenCL C and Python, of headers only in those that authors include, one at a
time, in a copy of what is committed. Builds each, runs the tests that should notice, and prints the survivors: changes that no test noticed. A survivor is a test
to write, or a line that nothing needs, or a change that means the same; a person decides. Exit code 0 also with survivors, 1 if the
unchanged sources do not build, 2 for a wrong command line.
"""

import argparse
import random
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

# What stands in code, and what it becomes. The blanks keep pointers, includes and unary operators out.
CHANGES = [
    (" < ", " <= "), (" <= ", " < "), (" > ", " >= "), (" >= ", " > "), (" == ", " != "), (" != ", " == "),
    (" && ", " || "), (" || ", " && "), (" + ", " - "), (" - ", " + "), (" * ", " / "), (" |= ", " = "), (" += ", " = "),
    (" ? ", " ? !"), ("return false", "return true"), ("return true", "return false"), ("if (", "if (!("),
    ("= 0;", "= 1;"), ("= true", "= false"), ("= false", "= true"),
    (" and ", " or "), (" or ", " and "), ("if not ", "if "), ("return True", "return False"), ("return False", "return True"),
    (" is None", " is not None"), (" += ", " -= "),
]  # fmt: skip

# Where a source lies, and the tests that should notice, as a regular expression of CTest; the first that fits counts.
TESTS = [
    (r"python", r"^python/"),
    (r"include/smartvis/author", r"test_(author|programs|quick_programs|plugin|frame_path|devices)"),
    (r"include", r"test_(guarded|layer|author|needs|devices|loader|examples)"),
    (r"sdk/(rules|layer)", r"test_layer|validate_cli"),
    (r"sdk/(record|replay)", r"test_re(cording|play)|replay_recording"),
    (r"sdk", r"validate/|test_(recording|formats|plugin_slabs)$"),
    (r"host_sim/console", r"console|replay_console"),
    (r"lab/surfaces", r"golden/test_sites|test_wall_(invariance|tilt)"),
    (r"lab", r"test_(eval|box)|golden/test_(report|demo|measure)"),
    (r"wall", r"test_wall($|_answer|_beams|_constants|_definition|_fluid|_limbs|_rim)$|test_confidence$"),
    (r"cl/(profile|common|mean|chain|minimum)|src/ref|src/quantise", r"test_(profile|mean|formats|scanned|method|box)"),
    (r"spline|grid", r"test_(spline|method)"),
    (r"src/(method|frame|device)", r"test_(method|mean|cl_faults|plugin|frame_path|formats|confidence)"),
    (r"src/abi", r"contract/|test_plugin|test_cl_faults|test_layout|test_settings"),
    (r"host_sim/volume", r"test_(metaimage|kretz|volume|beams|fan_fit|levels|pose|spacing|unscanned|hostile|files)|replay_(metaimage|kretz)"),
    (r"host_sim/scene", r"test_scene|test_handover|replay_scene|golden/test_scenes"),
    (r"host_sim/render", r"test_(dvr|lit|scan|camera|host_launch|loop)"),
    (r"base/(guard|guarded|plugin)", r"test_(child|guard|loader|loop)"),
    (r"host_sim/loop", r"test_(loop|files|metaimage_loop|confidence|slices)|golden/"),
    (r"host_sim/(picture|result)|host_sim/show", r"test_(picture|slices|result|loop)|golden/"),
    (r"base|host_sim", r"test_(cli|text|output_file|loop)|golden/test_(demo|scenes)"),
]  # fmt: skip


def run(command: list[str], limit: int, **kwargs: object) -> bool:
    """True if the command ends well within `limit` seconds, and CTest has skipped nothing."""
    try:
        ended = subprocess.run(command, timeout=limit, capture_output=True, check=False, **kwargs)
        return ended.returncode == 0 and b"***Skipped" not in ended.stdout
    except subprocess.TimeoutExpired:
        return False


def places(tree: Path) -> list[tuple[Path, int, int, str, str]]:
    """Every (file, line, column, before, after) that could be changed: code only, no comment, text or directive."""
    found = []
    # Comments, texts and directives become blanks of the same length.
    text_of_c = r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"|^[ \t]*#(?:[^\n]*\\\n)*[^\n]*|^static_assert[^;]*;'
    text_of_python = r'""".*?"""|"(?:\\.|[^"\\\n])*"|#[^\n]*'
    for top in ("src", "cl", "base", "sdk", "host_sim", "lab", "python/smartvis", "include/smartvis"):
        kinds = {".h"} if top == "include/smartvis" else {".c", ".cl", ".clh", ".py"}
        for path in sorted(p for p in (tree / top).rglob("*") if p.suffix in kinds):
            if re.search(r"lab/bench|windows|_pe\.c$", str(path)):  # these measure, or are of another system
                continue
            text = path.read_text()
            blank = re.sub(
                text_of_python if path.suffix == ".py" else text_of_c,
                lambda m: re.sub(r"[^\n]", " ", m.group()),
                text,
                flags=re.DOTALL | re.MULTILINE,
            )
            for number, line in enumerate(blank.split("\n")):
                for before, after in CHANGES:
                    found += [(path, number, m.start(), before, after) for m in re.finditer(re.escape(before), line)]
    return found


def changed(line: str, column: int, before: str, after: str) -> str | None:
    """The line with that change; a condition that is turned round needs its closing bracket on the same line."""
    rest = line[column + len(before) :]
    if before == "if (":
        depth = 1
        for at, letter in enumerate(rest):
            depth += {"(": 1, ")": -1}.get(letter, 0)
            if depth == 0:
                return line[:column] + after + rest[:at] + ")" + rest[at:]
        return None
    return line[:column] + after + rest


def tests_for(path: str) -> str:
    return next(tests for pattern, tests in TESTS if re.search(pattern, path))


class Copy:
    """The committed sources in a folder of their own, built there."""

    def __init__(self, tree: Path, cache: Path) -> None:
        self.tree, self.build = tree, tree / "build"
        shutil.rmtree(tree, ignore_errors=True)
        tree.mkdir(parents=True)
        archive = subprocess.run(["git", "archive", "HEAD"], cwd=ROOT, capture_output=True, check=True).stdout
        subprocess.run(["tar", "-x"], cwd=tree, input=archive, check=True)
        configure = ["cmake", "-S", str(tree), "-B", str(self.build), "-G", "Ninja"]
        if not run([*configure, f"-DSV_TEST_CACHE={cache}", "-DSV_TEST_TIMEOUT=150"], 300) or not self.builds():
            sys.exit("mutate: the unchanged sources do not build")

    def builds(self) -> bool:
        return run(["cmake", "--build", str(self.build)], 3600)

    def passes(self, tests: str) -> bool:
        slow = "|".join(word for word in ("python", "browser", "package", "report", "sites") if word not in tests)
        command = ["ctest", "--test-dir", str(self.build), "-R", tests, "-E", slow, "-j", "2", "--stop-on-failure"]
        return run(command, 1800)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=20, help="how many changes [20]")
    parser.add_argument("--seed", type=int, help="of the places, to see the same changes again [random]")
    parser.add_argument("--only", default="", help="sources whose path holds this text")
    parser.add_argument("--tree", type=Path, default=ROOT / "out/mutate", help="where the copy is made [out/mutate]")
    parser.add_argument("--cache", type=Path, default=ROOT / "build/pocl_cache", help="compiled kernels of the tests")
    options = parser.parse_args()
    if options.count < 1:
        parser.error(f"--count {options.count}: at least 1")
    seed = options.seed if options.seed is not None else random.SystemRandom().randrange(10**6)
    tree = options.tree.resolve()
    copy = Copy(tree, options.cache.resolve())
    candidates = [p for p in places(tree) if options.only in str(p[0].relative_to(tree))]
    if not candidates:
        parser.error(f"--only {options.only}: no source has such a path")
    random.Random(seed).shuffle(candidates)
    print(f"mutate: seed {seed}, {len(candidates)} places", flush=True)
    tried, survivors = 0, []
    passing: dict[str, bool] = {}
    for path, number, column, before, after in candidates:
        if tried == options.count:
            break
        name = str(path.relative_to(tree))
        text = path.read_text()
        lines = text.split("\n")
        line = changed(lines[number], column, before, after)
        if line is None:
            continue
        tests = tests_for(name)
        if tests not in passing:
            passing[tests] = copy.builds() and copy.passes(tests)
            if not passing[tests]:
                print(f"mutate: left out, fails without a change: ctest -R '{tests}'", flush=True)
        if not passing[tests]:
            continue
        lines[number] = line
        path.write_text("\n".join(lines))
        built = copy.builds()
        noticed = built and not copy.passes(tests)
        path.write_text(text)
        if not built:
            continue
        tried += 1
        print(f"{tried}/{options.count} {'noticed ' if noticed else 'SURVIVED'} {name}:{number + 1}: {line.strip()}", flush=True)
        if not noticed:
            survivors.append(f"{name}:{number + 1}: {line.strip()}")
    print(f"mutate: {tried - len(survivors)} of {tried} changes were noticed; survivors: {len(survivors)}")
    for survivor in survivors:
        print(f"  {survivor}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
