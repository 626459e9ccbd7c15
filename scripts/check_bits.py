#!/usr/bin/env python3
"""Fails when the numeric core ends a long run in other bits than it should.

Compiles base, plant and the batched current loops of control with a program that hashes long runs
(tests/plant/bits_main.cpp), with several compilers, optimisation levels and processors, and compares
what they print. Whole axes with averaged and switched inverters, and axes side by side with every
instruction set this processor has, are in it; the latter have to agree among themselves as well.

  scripts/check_bits.py [COMPILER...]      default: g++ clang++
"""

import collections
import concurrent.futures
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
ROOMS = ("base", "plant")
CONTROL = "current_loop_*.cpp"
LEVELS = {"-O1": ["-O1"], "-O3": ["-O3"], "-O3 x86-64-v3": ["-O3", "-march=x86-64-v3"]}
VECTORS = {"_avx2": ["-mavx2"], "_avx512": ["-mavx512f", "-mavx512dq", "-mavx512vl", "-mavx512bw"]}


def flags_of(compiler):
    """What cmake/compiler.cmake gives the numeric core."""
    flags = ["-std=c++20", "-DNDEBUG", "-ffp-contract=off", f"-I{ROOT / 'src'}"]
    version = subprocess.run([compiler, "--version"], check=True, stdout=subprocess.PIPE, text=True)
    return flags if "clang" in version.stdout else flags + ["-fno-tree-slp-vectorize"]


def sources():
    found = [
        path
        for room in ROOMS
        for path in sorted((ROOT / "src" / "stator" / room).rglob("*.cpp"))
        if path.parent.name != "keys"
    ]  # read configurations and compute nothing
    found += sorted((ROOT / "src" / "stator" / "control").rglob(CONTROL))
    return found + [ROOT / "tests" / "plant" / "bits_main.cpp"]


def compile_one(compiler, flags, source, folder):
    vector = next((extra for end, extra in VECTORS.items() if source.stem.endswith(end)), [])
    target = folder / f"{source.parent.name}-{source.stem}.o"
    launcher = ["ccache"] if shutil.which("ccache") else []
    # Every clone shares the cache.
    environment = os.environ | {"CCACHE_BASEDIR": str(ROOT), "CCACHE_NOHASHDIR": "1"}
    subprocess.run([*launcher, compiler, *flags, *vector, "-c", source, "-o", target], check=True, env=environment)
    return target


def run(compiler, level):
    """The lines that the program prints, built with these flags."""
    flags = flags_of(compiler) + LEVELS[level]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            objects = list(pool.map(lambda s: compile_one(compiler, flags, s, folder), sources()))
        program = folder / "bits"
        subprocess.run([compiler, *objects, "-o", program], check=True)
        done = subprocess.run([program], check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    return done.stdout.splitlines()


def main():
    if len(sys.argv) > 1 and sys.argv[1].startswith("-"):
        print(__doc__.strip())
        return 2
    compilers = sys.argv[1:] or ["g++", "clang++"]
    failed = False
    results = {}
    for compiler in compilers:
        for level in LEVELS:
            results[f"{compiler} {level}"] = lines = run(compiler, level)
            batches = collections.defaultdict(set)
            for line in lines:
                subject, value = line.split()
                if subject.startswith("batch"):
                    batches[subject].add(value)
            for subject, values in batches.items():
                if len(values) > 1:
                    failed = True
                    print(
                        f"{compiler} {level}: {subject} depends on the instruction set: {', '.join(sorted(values))}",
                        file=sys.stderr,
                    )
    (first, expected), *others = results.items()
    for name, lines in others:
        for mine, theirs in zip(expected, lines, strict=True):
            if mine != theirs:
                failed = True
                print(
                    f"{name} prints {theirs}, {first} {mine}: see Determinism in docs/architecture.md", file=sys.stderr
                )
    print(f"same bits: {len(expected)} runs, {len(results)} builds" if not failed else "other bits")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
