"""The program ``stator`` that comes with the package."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import NoReturn


def path() -> Path:
    """Where the program is."""
    return Path(__file__).parent / "bin" / "stator"


def main() -> NoReturn:
    """Becomes the program."""
    program = path()
    if not program.exists():
        sys.exit(f"{program} is missing: this package was built without the program")
    os.execv(program, [str(program), *sys.argv[1:]])
