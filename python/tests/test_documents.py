"""The programs in documents are run as they stand there."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
BLOCK = re.compile(r"<!-- python(?:: (?P<kind>\w+))? -->\n+```python\n(?P<code>.*?)```", re.DOTALL)


def blocks() -> list:
    """Every program of a document, and whether it is a test."""
    found = []
    for document in sorted(ROOT.glob("docs/**/*.md")):
        for number, match in enumerate(BLOCK.finditer(document.read_text())):
            name = f"{document.stem}-{number}"
            found.append(pytest.param(match["code"], match["kind"], id=name))
    return found


@pytest.mark.parametrize(("code", "kind"), blocks())
def test_a_program_of_a_document_runs(code: str, kind: str | None, tmp_path: Path) -> None:
    (tmp_path / "racks").symlink_to(ROOT / "racks")
    name = "test_document.py" if kind == "pytest" else "program.py"
    (tmp_path / name).write_text(code)
    command = [sys.executable, "-m", "pytest", "-q", name] if kind == "pytest" else [sys.executable, name]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_there_are_programs_in_documents() -> None:
    assert len(blocks()) >= 4
