#!/usr/bin/env python3
"""SDO round trips of python-canopen: on a rack in this process, and over socketcand on one that `stator run` runs.

    benchmarks/python_sdo.py [--stator PROGRAM] [--seconds N]

Needs the package `stator` with canopen. The two take turns, so that what else the machine does meets both; prints the median
of a round trip in each turn, in microseconds, and how many times as many the rack in this process makes.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import socket
import statistics
import subprocess
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import canopen

import stator

TABLE = '[[bus]]\nports = ["socketcand:{port}"]\n[[bus.device]]\ntype = "tmcc160"\nname = "s"\nfriendly = true\n'
TURNS = 5
PATIENCE = 60.0


@contextlib.contextmanager
def in_process() -> Iterator[canopen.RemoteNode]:
    """A node of a rack in this process, in lockstep."""
    with stator.Rack({"bus": [{"device": [{"type": "tmcc160", "name": "s", "friendly": True}]}]}, signals=()) as rack:
        network = canopen.Network()
        network.connect(interface="stator", channel=rack.bus())
        rack["s"].wait_for_boot_up()
        yield network.add_node(1, rack["s"].eds())
        network.disconnect()


@contextlib.contextmanager
def over_socketcand(program: str) -> Iterator[canopen.RemoteNode]:
    """A node of a rack in another process."""
    with tempfile.TemporaryDirectory() as folder, socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
        probe.close()
        file = Path(folder) / "rack.toml"
        file.write_text(TABLE.format(port=port))
        rack = subprocess.Popen([program, "run", str(file)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            end = time.monotonic() + PATIENCE
            while True:
                try:
                    socket.create_connection(("127.0.0.1", port)).close()
                    break
                except OSError:
                    if time.monotonic() > end:
                        raise
                    time.sleep(0.05)
            network = canopen.Network()
            network.connect(interface="socketcand", host="127.0.0.1", port=port, channel="can0")
            eds = Path(folder) / "s.eds"
            subprocess.run([program, "export", "eds", "tmcc160", "-o", str(eds)], check=True, stdout=subprocess.DEVNULL)
            node = network.add_node(1, str(eds))
            # A node that starts does not hear.
            while time.monotonic() < end:
                with contextlib.suppress(canopen.SdoCommunicationError):
                    node.sdo[0x6064].raw  # noqa: B018  read over the bus
                    break
            node.sdo.RESPONSE_TIMEOUT = PATIENCE
            yield node
            network.disconnect()
        finally:
            rack.terminate()
            rack.wait()


def round_trips(node: canopen.RemoteNode, seconds: float) -> list[float]:
    """Microseconds of each round trip."""
    trips = []
    end = time.perf_counter() + seconds
    before = time.perf_counter()
    while before < end:
        node.sdo[0x6064].raw  # noqa: B018  read over the bus
        after = time.perf_counter()
        trips.append((after - before) * 1e6)
        before = after
    return trips


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--stator", default=os.environ.get("STATOR_PROGRAM", "stator"), help="the program")
    parser.add_argument("--seconds", type=float, default=2.0, help="of each turn")
    arguments = parser.parse_args()
    ratios = []
    with in_process() as near, over_socketcand(arguments.stator) as far:
        for node in (near, far):
            round_trips(node, 0.2)
        for _ in range(TURNS):
            here = statistics.median(round_trips(near, arguments.seconds))
            there = statistics.median(round_trips(far, arguments.seconds))
            ratios.append(there / here)
            print(f"in process {here:6.0f} us, socketcand {there:6.0f} us, {there / here:.2f} times as many")
    print(f"median: {statistics.median(ratios):.2f} times as many round trips in process")


if __name__ == "__main__":
    main()
