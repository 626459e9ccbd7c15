"""The program beside the package under test."""

from __future__ import annotations

import os
from pathlib import Path

import stator._program


def stator_program() -> str:
    """Where the program is: in the package, or, of a build directory, beside it."""
    if stator._program.path().exists():
        return str(stator._program.path())
    built = Path(stator.__file__).resolve().parents[3]
    return os.environ.get("STATOR_PROGRAM", str(built / "build/release/src/cli/stator"))
