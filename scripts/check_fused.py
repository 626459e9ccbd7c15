#!/usr/bin/env python3
"""Fails when an object file contains a fused multiply-add instruction.

A fused operation rounds once where a multiplication and an addition round twice, so a simulation
would end in other bits on another compiler or processor. GCC emits them from its straight-line
vectoriser even with contraction switched off, hence this look at the machine code itself.

  scripts/check_fused.py FILE...      static libraries or object files
"""

import re
import subprocess
import sys

# x86: vfmadd, vfmsub, vfnmadd, vfnmsub, vfmaddsub, vfmsubadd. Arm: fmadd, fmsub, fnmadd, fnmsub,
# fmla, fmls and their SVE relatives.
FUSED = re.compile(r"^v?fn?m(?:add|sub|addsub|subadd|la|ls|ad|sb)[0-9a-z]*$")
MEMBER = re.compile(r"^(\S.*\.(?:o|obj)):\s+file format")
FUNCTION = re.compile(r"^[0-9a-f]+ <(.*)>:$")
INSTRUCTION = re.compile(r"^\s*[0-9a-f]+:\s+([a-z][\w.]*)")


def find_fused(disassembly):
    """(object file, function, instruction) of every fused operation in `objdump -d` output."""
    member = function = "?"
    for line in disassembly.splitlines():
        if match := MEMBER.match(line):
            member = match.group(1)
        elif match := FUNCTION.match(line):
            function = match.group(1)
        elif (match := INSTRUCTION.match(line)) and FUSED.match(match.group(1)):
            yield member, function, match.group(1)


def main():
    if len(sys.argv) < 2 or sys.argv[1].startswith("-"):
        print(__doc__.strip())
        return 2
    count = instructions = 0
    for path in sys.argv[1:]:
        disassembly = subprocess.run(
            ["objdump", "--disassemble", "--no-show-raw-insn", "--demangle", path],
            check=True,
            stdout=subprocess.PIPE,
            text=True,
        ).stdout
        instructions += sum(1 for line in disassembly.splitlines() if INSTRUCTION.match(line))
        for member, function, instruction in find_fused(disassembly):
            count += 1
            print(
                f"{path}({member}): {function}: {instruction}; compile with the flags of cmake/compiler.cmake",
                file=sys.stderr,
            )
    if instructions == 0:
        print("no instruction found in these files; nothing was checked", file=sys.stderr)
        return 1
    print(f"fused multiply-add: {count} in {instructions} instructions of {len(sys.argv) - 1} files")
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main())
