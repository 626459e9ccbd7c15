#!/usr/bin/env python3
"""Uses Stator as projects of others do.

    outside.py project --build build/release [--compiler clang++] [--flags=-march=native]

Installs what the folder BUILD has built below a temporary folder, and there

  project      copies examples/library, which finds the package by find_package(), builds it with COMPILER and FLAGS, and
               compares what its programs print - values, and hashes of all bits of signals - with what those of BUILD
               print. One is built with pkg-config as well, and the program `stator` that was installed makes
               the same move as a scenario, to the last bit.
  subproject   configures a project that has Stator in it by add_subdirectory(): the library alone, no tests, no
               warnings as errors, nothing installed.

Prints what was compared; exit status 1 if something is not the same, with the output of the command that failed.
"""

import argparse
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
PROGRAMS = ("move_a_drive", "own_ethercat_device", "own_canopen_device", "motor_alone", "own_slave_stack")


class Different(Exception):
    """Something is not as it should be."""


def run(command, **options):
    """What the command prints."""
    command = [str(word) for word in command]
    done = subprocess.run(command, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False, **options)
    if done.returncode != 0:
        raise Different(f"{shlex.join(command)}: exit status {done.returncode}\n{done.stdout}")
    return done.stdout


def install(options, prefix):
    for component in ("library", "program"):
        run(["cmake", "--install", options.build, "--prefix", prefix, "--component", component])
    found = sorted(path.relative_to(prefix).as_posix() for path in prefix.rglob("*.hpp"))
    print(f"installed: {len(found)} headers, {len(list(prefix.rglob('*.a')))} libraries")
    inside = [path for path in found if re.search(r"/(cli|web|scenario|internal)/", path)]
    if inside:
        raise Different(f"these are internal and not to be installed: {', '.join(inside)}")


def configure(options, source, build, prefix):
    run(
        [
            "cmake",
            "-S",
            source,
            "-B",
            build,
            "-DCMAKE_BUILD_TYPE=Release",
            f"-DCMAKE_CXX_COMPILER={options.compiler}",
            f"-DCMAKE_CXX_FLAGS={options.flags}",
            f"-DCMAKE_PREFIX_PATH={prefix}",
        ]
    )


def compare_programs(options, source, build):
    inside = Path(options.build) / "examples" / "library"
    outputs = {}
    for program in PROGRAMS:
        outputs[program] = run([build / program], cwd=source)
        expected = run([inside / program], cwd=source)
        if outputs[program] != expected:
            raise Different(f"{program} prints\n{outputs[program]}and that of {inside}\n{expected}")
        if not re.search(r"^bits [0-9a-f]{16}$", outputs[program], re.MULTILINE):
            raise Different(f"{program} prints no bits:\n{outputs[program]}")
    print(f"{len(PROGRAMS)} programs print the same as those of {inside}, bits of signals among it")
    return outputs


def build_with_pkg_config(options, source, prefix, expected):
    environment = {**os.environ, "PKG_CONFIG_PATH": str(next(prefix.rglob("stator.pc")).parent)}
    flags = run(["pkg-config", "--cflags", "--libs", "stator-plant", "stator-control"], env=environment).split()
    program = source / "with_pkg_config"
    run([options.compiler, "-O2", *shlex.split(options.flags), source / "motor_alone.cpp", "-o", program, *flags])
    printed = run([program])
    if printed != expected:
        raise Different(f"built with pkg-config it prints\n{printed}instead of\n{expected}")
    # All packages know what they need.
    run(["pkg-config", "--print-errors", "--exists", "stator"], env=environment)
    print("motor_alone with pkg-config prints the same")


def same_move_by_the_program(source, prefix, printed):
    """What move_a_drive does, as a scenario; a comparison without tolerance passes for equal bits only."""
    position = printed.split()[0]
    (source / "move.toml").write_text(
        f"""name = "The move of move_a_drive"
rack = "rack.toml"
[[step]]
do = "state"
state = "operational"
[[step]]
do = "enable"
device = "x"
[[step]]
do = "move"
device = "x"
target = 512000
velocity = 512000
acceleration = 2048000
wait = false
[[step]]
do = "inject"
fault = {{ kind = "motor-stall", device = "x", at = "800ms", for = "100ms" }}
[[step]]
do = "wait"
time = "1s"
[[step]]
do = "expect-signal"
signal = "x.axis0.shaft_position"
equals = {position}
tolerance = 0.0
""",
        encoding="utf-8",
    )
    run([prefix / "bin" / "stator", "test", source / "move.toml"])
    print(f"the program that was installed moves to {position} as well")


def project(options, folder):
    prefix = folder / "prefix"
    install(options, prefix)
    source = folder / "source"
    shutil.copytree(ROOT / "examples" / "library", source)
    build = folder / "build"
    configure(options, source, build, prefix)
    run(["cmake", "--build", build, "--parallel", str(options.jobs)])
    outputs = compare_programs(options, source, build)
    build_with_pkg_config(options, source, prefix, outputs["motor_alone"])
    same_move_by_the_program(source, prefix, outputs["move_a_drive"])


def subproject(options, folder):
    source = folder / "source"
    source.mkdir()
    (source / "CMakeLists.txt").write_text(
        f"""cmake_minimum_required(VERSION 3.25)
project(outside LANGUAGES CXX)
add_subdirectory({ROOT} stator)
add_executable(outside main.cpp)
target_link_libraries(outside PRIVATE stator::plant)
foreach(target test_base bench_plant own_product stator stator_cli)
  if(TARGET ${{target}})
    message(FATAL_ERROR "a subproject has the target ${{target}}")
  endif()
endforeach()
get_target_property(options stator_compile_options INTERFACE_COMPILE_OPTIONS)
if("-Werror" IN_LIST options)
  message(FATAL_ERROR "warnings are errors in a subproject")
endif()
""",
        encoding="utf-8",
    )
    (source / "main.cpp").write_text("#include <stator/motion.hpp>\nint main() {}\n", encoding="utf-8")
    build = folder / "build"
    configure(options, source, build, folder / "nowhere")
    run(["cmake", "--build", build, "--target", "help"])
    run(["cmake", "--install", build, "--prefix", folder / "prefix"])
    installed = list((folder / "prefix").rglob("*"))
    if installed:
        raise Different(f"a subproject installs {installed[0]}")
    print("as a subproject: the library alone, no tests, no warnings as errors, nothing installed")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("part", choices=("project", "subproject"))
    parser.add_argument("--build", required=True, help="folder in which Stator was built")
    parser.add_argument("--compiler", default="c++")
    parser.add_argument("--flags", default="")
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    options.build = Path(options.build).resolve()
    with tempfile.TemporaryDirectory(prefix="stator-outside-") as folder:
        try:
            {"project": project, "subproject": subproject}[options.part](options, Path(folder))
        except Different as difference:
            print(difference, file=sys.stderr)
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
