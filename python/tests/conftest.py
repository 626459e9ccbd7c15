"""What the tests of the package share."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

import stator

pytest_plugins = ["pytester"]

#: A TMCC160 with its data sheet, alone on a bus.
SPINDLE = {"bus": [{"device": [{"type": "tmcc160", "name": "spindle", "node_id": 1, "friendly": True}]}]}
#: A TMCM-142 on a serial line.
FEEDER = {"device": [{"type": "tmcm-142", "name": "feeder", "rs485": "pty:/tmp/stator-test-line"}]}


@pytest.fixture
def stepper() -> Iterator[stator.Rack]:
    """One TMCM-3315."""
    with stator.Rack("tmcm-3315", limit=300) as rack:
        yield rack


@pytest.fixture
def spindle() -> Iterator[stator.Rack]:
    """One TMCC160 on a CAN bus."""
    with stator.Rack(SPINDLE, limit=300) as rack:
        yield rack
