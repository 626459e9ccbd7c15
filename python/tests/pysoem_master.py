"""pysoem, unmodified, as the master of a rack in the same process: run by test_pysoem.py in a network of its own.

Plugs a cable (a veth pair), opens a rack at one end and pysoem at the other, takes the drive to Operational and moves it.
Prints "moved to POSITION".
"""

from __future__ import annotations

import struct
import subprocess
import time
from typing import Any

import pysoem

import stator

MASTER, SLAVES = "client", "slaves"
TARGET = 20_000
WATCHDOG = 5000.0  # ms; a busy machine may take its time between two frames
PATIENCE = 60.0


def move(master: Any, slave: Any) -> int:
    """Enables the first axis and sends it to TARGET; where it is then, or after PATIENCE."""
    end = time.monotonic() + PATIENCE
    position = 0
    words = iter((0x06, 0x07, 0x0F, 0x1F))
    word = 0
    while abs(position - TARGET) > 20 and time.monotonic() < end:
        word = next(words, word)
        image = bytearray(slave.output)
        struct.pack_into("<Hii", image, 0, word, TARGET, 0)
        slave.output = bytes(image)
        for _ in range(10):
            master.send_processdata()
            master.receive_processdata(100_000)
            time.sleep(0.001)
        (position,) = struct.unpack_from("<i", slave.input, 2)
    return position


def main() -> None:
    subprocess.run(["ip", "link", "add", MASTER, "type", "veth", "peer", "name", SLAVES], check=True)
    for end in (MASTER, SLAVES):
        subprocess.run(["ip", "link", "set", end, "up"], check=True)
    table = {"segment": [{"link": f"ethercat:{SLAVES}", "device": [{"type": "tmcm-3315", "name": "gantry"}]}]}
    with stator.Rack(table, links=True) as rack:
        master = pysoem.Master()
        master.open(MASTER)
        assert master.config_init() == 1
        (slave,) = master.slaves
        assert slave.name == "TMCM-3315", slave.name
        assert slave.sdo_read(0x1018, 1, 4) == struct.pack("<I", 0x286)
        slave.set_watchdog("processdata", WATCHDOG)
        master.config_map()
        assert master.state_check(pysoem.SAFEOP_STATE, 5_000_000) == pysoem.SAFEOP_STATE
        master.send_processdata()
        master.receive_processdata(100_000)
        master.state = pysoem.OP_STATE
        master.write_state()
        assert master.state_check(pysoem.OP_STATE, 5_000_000) == pysoem.OP_STATE
        slave.sdo_write(0x6060, 0, b"\x01")
        for index, value in ((0x6081, 50_000), (0x6083, 200_000), (0x6084, 200_000)):
            slave.sdo_write(index, 0, struct.pack("<I", value))
        position = move(master, slave)
        print(f"moved to {position}, {rack['gantry'].objects[0x6064]} beside the network", flush=True)
        master.state = pysoem.INIT_STATE
        master.write_state()
        master.close()


main()
