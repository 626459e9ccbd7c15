"""The build folder of a campaign: a copy of the tree in which the sampled places are rewritten."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from places import rewrite

HERE = Path(__file__).resolve().parent
ROUNDS = 8  # of compiling again without the mutants that do not compile

# Options of the rewritten sources only: everything else is compiled as always, which is what a
# compiler cache needs. A step outside a span or an array ends the program.
CMAKE = """
function(stator_mutants)
  include("@HERE@/sources.cmake")
  foreach(source IN LISTS sources)
    string(REGEX MATCH "^src/stator/([^/]+)" room "${source}")
    set_source_files_properties("${CMAKE_SOURCE_DIR}/${source}"
      TARGET_DIRECTORY stator_${CMAKE_MATCH_1}
      PROPERTIES COMPILE_OPTIONS "-w;-Wno-narrowing;-O1;-D_GLIBCXX_ASSERTIONS")
  endforeach()
  foreach(suite IN LISTS STATOR_MUTATED_SUITES)
    target_sources(test_${suite} PRIVATE "@HERE@/listener.cpp")
  endforeach()
endfunction()
if(PROJECT_IS_TOP_LEVEL)
  cmake_language(DEFER CALL stator_mutants)
endif()
"""


def write_if_changed(path, data):
    if not path.exists() or path.read_bytes() != data:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)


class Build:
    """A copy of `root` in `work`, which may hold that of an earlier campaign."""

    def __init__(self, root, work, suites, jobs):
        self.root, self.tree = root, work / "tree"
        self.folder = self.tree / "build" / "release"  # where a compiler cache knows it from
        self.include = work / "include"
        self.suites, self.jobs = suites, jobs

    def program(self, suite):
        return self.folder / "tests" / suite / f"test_{suite}"

    def prepare(self, sample):
        """Copies the tree with the sample's places rewritten; times of unchanged files stay."""
        done = subprocess.run(
            ["git", "-C", str(self.root), "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
            capture_output=True,
            check=True,
        )
        kept = set()
        for name in filter(None, done.stdout.decode().split("\0")):
            source, target = self.root / name, self.tree / name
            if not source.is_file():
                continue
            kept.add(target)
            data = source.read_bytes()
            if name in sample.places:
                data = self.rewritten(data.decode(), sample.places[name]).encode()
            write_if_changed(target, data)
            shutil.copymode(source, target)
        for left in [
            p
            for p in self.tree.rglob("*")
            if p.is_file() and p not in kept and not p.is_relative_to(self.tree / "build")
        ]:
            left.unlink()
        for name in ("schemata.hpp", "listener.cpp"):
            write_if_changed(self.include / name, (HERE / name).read_bytes())
        names = "".join(f"  {name}\n" for name in sorted(sample.places))
        write_if_changed(self.include / "sources.cmake", f"set(sources\n{names})\n".encode())
        write_if_changed(self.include / "mutants.cmake", CMAKE.replace("@HERE@", self.include.as_posix()).encode())

    def rewritten(self, text, places):
        return rewrite(text, places, (self.include / "schemata.hpp").as_posix()) if places else text

    def configure(self):
        done = subprocess.run(
            [
                "cmake",
                "-S",
                str(self.tree),
                "-B",
                str(self.folder),
                "-G",
                "Ninja",
                "-DCMAKE_BUILD_TYPE=Release",
                "-DSTATOR_BUILD_BENCHMARKS=OFF",
                "-DSTATOR_BUILD_EXAMPLES=OFF",
                f"-DCMAKE_PROJECT_INCLUDE={self.include / 'mutants.cmake'}",
                f"-DSTATOR_MUTATED_SUITES={';'.join(self.suites)}",
            ],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
        )
        if done.returncode != 0:
            sys.exit(f"scripts/mutation: cmake failed\n{done.stdout}")

    def compile(self, sample):
        """Builds the suites; numbers of the mutants that do not compile, which are taken out."""
        dropped = set()
        for _ in range(ROUNDS):
            done = subprocess.run(
                [
                    "cmake",
                    "--build",
                    str(self.folder),
                    "--target",
                    *(f"test_{s}" for s in self.suites),
                    "--",
                    "-k",
                    "0",
                    "-j",
                    str(self.jobs),
                ],
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                check=False,
            )
            if done.returncode == 0:
                return dropped
            bad = self._drop_failing(done.stdout, sample)
            if not bad:
                break
            dropped |= bad
        sys.exit(f"scripts/mutation: the rewritten tree does not build\n{done.stdout[-4000:]}")

    def _drop_failing(self, output, sample):
        """Takes out the places on lines with errors; all of a file that fails elsewhere."""
        lines = {}
        for path, line in re.findall(r"^(\S+?\.cpp):(\d+):(?:\d+:)? (?:fatal )?error: ", output, re.MULTILINE):
            name = os.path.relpath((self.folder / path).resolve(), self.tree)
            if name in sample.places:
                lines.setdefault(name, set()).add(int(line))
        for path in re.findall(r"FAILED: \S*/CMakeFiles/\S+?\.dir/(\S+)\.o", output):
            for name in sample.places:
                if name.endswith("/" + path):
                    lines.setdefault(name, set())
        dropped = set()
        for name, failing in lines.items():
            places = sample.places.get(name, [])
            text = (self.root / name).read_text(encoding="utf-8")
            bad = [
                p
                for p in places
                if failing & set(range(text.count("\n", 0, p.start) + 1, text.count("\n", 0, p.end) + 2))
                and text.count("\n", 0, p.end) - text.count("\n", 0, p.start) < 6
            ] or places
            dropped |= {number for place in bad for number in place.identities}
            sample.places[name] = [p for p in places if p not in bad]
            write_if_changed(self.tree / name, self.rewritten(text, sample.places[name]).encode())
        return dropped
