"""pysoem on racks with links, in the same process."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

MASTER = Path(__file__).parent / "pysoem_master.py"
ALONE = ("unshare", "--user", "--map-root-user", "--net")


def own_network() -> tuple[str, ...]:
    """What begins a command that has a network of its own, in which it may open raw sockets."""
    if shutil.which("unshare") is None or shutil.which("ip") is None:
        pytest.skip("util-linux and iproute2 are missing")
    for begin in (("unshare", "--net"), ALONE):
        if subprocess.run([*begin, "true"], capture_output=True, check=False).returncode == 0:
            return begin
    pytest.skip("this machine gives no network namespace; run as root")


def test_pysoem_moves_a_drive_over_a_cable() -> None:
    pytest.importorskip("pysoem")
    done = subprocess.run(
        [*own_network(), sys.executable, str(MASTER)], capture_output=True, text=True, check=False, timeout=300
    )
    assert done.returncode == 0, done.stderr
    moved = re.search(r"moved to (\d+), (\d+) beside", done.stdout)
    assert moved, done.stdout + done.stderr
    assert [int(position) for position in moved.groups()] == pytest.approx([20_000, 20_000], abs=20)
