#!/usr/bin/python3
"""How long an order to keep something takes, from the order to its answer, and what process data notice of it.

    store_times.py --stator PROGRAM [--count 200] [--only PART]... [--directory DIR] [--limit 1.0]

Real clock: median, 99th percentile and worst of --count orders in milliseconds, kept below --directory (whose disk
counts), while a master exchanges process data every millisecond (on CAN: a SYNC with one PDO in answer). Of these:
how many, how many with another working counter (CAN: without answer), and the longest time from one to the next.
Lockstep: simulated milliseconds of 20 orders, median, and whether all took the same. "document" is what the
device's page says. Exit status 1 if a working counter was wrong or an order took longer than --limit seconds.
"""

import argparse
import pathlib
import random
import statistics
import struct
import sys
import tempfile
import threading
import time

from can_host import CanHost, SdoClient
from ethercat_host import BOOT, LRW, OP, PREOP, SAFEOP, SYNC_MANAGER, Refused, Slave
from kept_devices import (
    BOARD,
    BUS,
    CAN_PORT,
    ETHERCAT_PORT,
    PINS,
    SAVE,
    SERIAL_MODULE,
    SERIAL_PORT,
    TMCC160,
    BoardEeprom,
    segment,
)
from rack_process import PATIENCE, Gone, RackProcess, Silent, own_address
from tmcl_host import GGP, LOADED, QUIT_DOWNLOAD, SAP, SCO, SGP, STAP, START_DOWNLOAD, STGP, Module, SerialHost

FMMU, LOGICAL_HIGH = 0x0600, 1  # process data lie at logical address 10000h
SYNC_MANAGERS, END_OF_CATEGORIES = 41, 0xFFFF
TICK_TIMER = 132
STEP = 0.01  # ms of simulated time for each frame in lockstep


def sync_managers(slave):
    """(start, length, control) of each, as the SII has them."""
    at = 0x40
    while True:
        category, words = slave.read_sii(at, 2)
        if category == END_OF_CATEGORIES:
            raise Refused("the SII has no sync managers")
        if category == SYNC_MANAGERS:
            content = struct.pack(f"<{words}H", *slave.read_sii(at + 2, words))
            return [struct.unpack_from("<HHB", content, each) for each in range(0, len(content), 8)]
        at += 2 + words


def process_data_length(slave, assignment):
    bits = 0
    for number in range(slave.upload(assignment, 0)):
        mapping = slave.upload(assignment, number + 1)
        bits += sum(slave.upload(mapping, entry + 1) & 0xFF for entry in range(slave.upload(mapping, 0)))
    return bits // 8


def go_operational(slave, mailbox):
    """Number of bytes of the LRW that is then to be sent in every cycle."""
    if mailbox:
        slave.open_mailbox(PREOP)
    else:
        slave.go(PREOP)
    size = 0
    for number, (start, length, control) in enumerate(sync_managers(slave)[-2:]):
        if mailbox:
            length = process_data_length(slave, 0x1C12 + number)
        slave.write(SYNC_MANAGER + 8 * (2 * mailbox + number), struct.pack("<HHBBBB", start, length, control, 0, 1, 0))
        slave.write(
            FMMU + 16 * number, struct.pack("<IHBBHBBB3x", LOGICAL_HIGH << 16, length, 0, 7, start, 0, 2 - number, 1)
        )
        size = max(size, length)
    slave.go(SAFEOP)
    cycle(slave, size)
    slave.go(OP)
    return size


def cycle(slave, size):
    """The working counter: 3 if outputs were taken and inputs given."""
    return slave.exchange(LRW, LOGICAL_HIGH, bytes(size), position=0)[1]


class Cycles(threading.Thread):
    """Process data every millisecond."""

    def __init__(self):
        super().__init__(daemon=True)
        self.count = self.wrong = 0
        self.longest = 0.0
        self.ended = False

    def exchange(self):
        raise NotImplementedError

    def run(self):
        following = before = time.monotonic()
        while not self.ended:
            try:
                good = self.exchange()
            except (Gone, Silent):
                good = False
            now = time.monotonic()
            self.count += 1
            self.wrong += not good
            self.longest = max(self.longest, now - before)
            before = now
            following = max(following + 0.001, now)
            time.sleep(max(0.0, following - time.monotonic()))


class EtherCatCycles(Cycles):
    def __init__(self, address, size):
        super().__init__()
        self.slave = Slave(address, ETHERCAT_PORT)
        self.size = size

    def exchange(self):
        return cycle(self.slave, self.size) == 3


class SyncCycles(Cycles):
    """The node's statusword in answer to each SYNC, over a port of its own."""

    def __init__(self, address):
        super().__init__()
        self.host = CanHost(address, CAN_PORT)
        client = SdoClient(self.host, 5)
        client.wait_for_node()
        client.download(0x1800, 1, 0xC0000185, 4)
        client.download(0x1800, 2, 1, 1)
        client.download(0x1800, 1, 0x40000185, 4)
        self.host.send(0, b"\x01\x05")

    def exchange(self):
        self.host.send(0x80, b"")
        return bool(self.host.receive(0x185))


class Store:
    """`order(number)` gives one order and returns when it is answered. `simulated()` is the simulated time so far in
    ms, from what moves it in lockstep."""

    document = "not described"
    files = {}  # that the rack file names

    def __init__(self, address, lockstep):
        self.address = address
        self.lockstep = lockstep
        self.rng = random.Random(1)
        self.open()

    def cycles(self):
        return None


class SiiWord(Store):
    rack = None
    mailbox = 1
    document = "0.5 (I2C, one word)"

    def open(self):
        self.slave = Slave(self.address, ETHERCAT_PORT)
        self.size = 0 if self.lockstep else go_operational(self.slave, self.mailbox)

    def cycles(self):
        return EtherCatCycles(self.address, self.size)

    def order(self, number):
        self.slave.write_sii(0x3C0 + number % 48, self.rng.randrange(0x10000))

    def simulated(self):
        return self.slave.frames * STEP


class SiiTmc8461(SiiWord):
    rack = segment("tmc8461") + "device_emulation = true\n"
    mailbox = 0


class SiiTmc8670(SiiWord):
    rack = segment("tmc8670")


class SiiTmcm3315(SiiWord):
    rack = segment("tmcm-3315")


class SaveTmc8670(SiiWord):
    rack = segment("tmc8670")
    document = "not described, F-81"

    def open(self):
        super().open()
        if self.lockstep:
            self.slave.open_mailbox()

    def order(self, number):
        self.slave.download(0x6083, 0, number + 1, 4)
        self.begin()
        self.slave.download(0x1010, 1, SAVE, 4)

    def begin(self):
        """What comes before is not the order's."""


class FirmwareTmcm3315(Store):
    rack = segment("tmcm-3315")

    def open(self):
        self.slave = Slave(self.address, ETHERCAT_PORT)
        self.slave.open_mailbox(BOOT)

    def order(self, number):
        self.slave.write_file(self.rng.randbytes(2000))

    def simulated(self):
        return self.slave.frames * STEP


class SaveTmcc160(Store):
    rack = BUS + TMCC160

    def open(self):
        self.client = SdoClient(CanHost(self.address, CAN_PORT), 5)
        self.client.wait_for_node()

    def cycles(self):
        return SyncCycles(self.address)

    def order(self, number):
        self.client.download(0x6083, 0, number + 1, 4)
        self.begin()
        self.client.download(0x1010, 1, SAVE, 4)

    begin = SaveTmc8670.begin


class BoardPage(Store):
    """Until the part acknowledges its address again, and a look at the page."""

    rack = BOARD
    files = {"pins.toml": PINS}
    document = "5 (24LC64)"

    def open(self):
        self.part = BoardEeprom(self)
        self.part.connect()

    def order(self, number):
        self.part.write_page(number % 4 * 32, self.rng.randbytes(8))

    def simulated(self):
        return self.part.slave.frames * STEP


class Module142(Store):
    rack = SERIAL_MODULE
    document = "5 (T-86)"

    def open(self):
        self.module = Module(SerialHost(self.address, SERIAL_PORT))
        self.module.ask(SGP, 84, 0, 1)

    def simulated(self):
        return self.module.ask(GGP, TICK_TIMER)


class Stap(Module142):
    def order(self, number):
        self.module.ask(SAP, 212, 0, number + 1)
        self.begin()
        self.module.ask(STAP, 212)

    begin = SaveTmc8670.begin


class Stgp(Module142):
    def order(self, number):
        self.module.ask(SGP, 5, 2, number + 1)
        self.begin()
        self.module.ask(STGP, 5, 2)

    begin = SaveTmc8670.begin


class Sco(Module142):
    def order(self, number):
        self.module.ask(SCO, 3, 0, number + 1)


class Instruction(Module142):
    def order(self, number):
        self.module.ask(START_DOWNLOAD, 0, 0, number % 100)
        if not self.lockstep:  # the tick timer cannot be asked for during a download
            self.begin()
        self.module.ask(SAP, 4, 0, number + 1, expected=LOADED)
        if not self.lockstep:
            self.finish()
        self.module.ask(QUIT_DOWNLOAD)

    begin = finish = SaveTmc8670.begin


STORES = {
    "SII word, TMC8461": SiiTmc8461,
    "SII word, TMC8670": SiiTmc8670,
    "SII word, TMCM-3315": SiiTmcm3315,
    "1010h:01, TMC8670": SaveTmc8670,
    "1010h:01, TMCC160": SaveTmcc160,
    "STAP, TMCM-142": Stap,
    "STGP, TMCM-142": Stgp,
    "SCO, TMCM-142": Sco,
    "instruction, TMCM-142": Instruction,
    "page, EEPROM on a board": BoardPage,
    "FoE 2000 bytes, TMCM-3315": FirmwareTmcm3315,
}


def measure(store, count, clock):
    """Time on `clock` that each order took."""
    times = []
    marks = {}
    store.begin = lambda: marks.__setitem__("begin", clock())
    store.finish = lambda: marks.__setitem__("end", clock())
    for number in range(count):
        marks.clear()
        marks["begin"] = clock()
        end = time.monotonic() + PATIENCE
        while True:
            try:
                store.order(number)
                break
            except Refused:  # still busy with the order before
                if time.monotonic() > end:
                    raise
                time.sleep(0.001)
        times.append(marks.get("end", clock()) - marks["begin"])
    return times


def run(program, directory, kind, count, lockstep):
    address = own_address()
    path = directory / "rack.toml"
    text = kind.rack.format(address=address)
    path.write_text(
        (f'clock = "lockstep"\nstep = "{int(STEP * 1000)}us"\n' if lockstep else "") + text, encoding="ascii"
    )
    for name, content in kind.files.items():
        (directory / name).write_text(content, encoding="ascii")
    with RackProcess(program, str(path), str(directory), "--state", str(directory / "state")) as process:
        store = kind(address, lockstep)
        if lockstep:
            times = measure(store, count, store.simulated)
            return times, None
        cycles = store.cycles()
        if cycles is not None:
            cycles.start()
            time.sleep(0.05)
        times = [each * 1000 for each in measure(store, count, time.monotonic)]
        if cycles is not None:
            cycles.ended = True
            cycles.join()
        process.end()
    return times, cycles


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--stator", required=True)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--only", action="append", default=[])
    parser.add_argument("--directory")
    parser.add_argument("--limit", type=float, default=1.0)
    options = parser.parse_args()
    failed = False
    print(
        f"{'ms':26}{'median':>8}{'99 %':>8}{'worst':>8}   {'document':22}{'simulated':>12}"
        f"{'cycles':>9}{'wrong':>7}{'longest':>9}"
    )
    for name, kind in STORES.items():
        if options.only and not any(part in name for part in options.only):
            continue
        with tempfile.TemporaryDirectory(prefix="stator-rig-", dir=options.directory) as directory:
            times, cycles = run(options.stator, pathlib.Path(directory), kind, options.count, False)
        simulated = "-"
        if hasattr(kind, "simulated"):
            with tempfile.TemporaryDirectory(prefix="stator-rig-", dir=options.directory) as directory:
                moved, _ = run(options.stator, pathlib.Path(directory), kind, min(options.count, 20), True)
            simulated = f"{statistics.median(moved):.2f}" + (
                "" if max(moved) - min(moved) < 1.01 else f" ±{(max(moved) - min(moved)) / 2:.2f}"
            )
        times.sort()
        wrong = cycles is not None and cycles.wrong
        late = times[-1] > options.limit * 1000
        failed |= bool(wrong or late)
        print(
            f"{name:26}{statistics.median(times):8.2f}{times[len(times) * 99 // 100]:8.2f}{times[-1]:8.2f}   "
            f"{kind.document:22}{simulated:>12}"
            + (f"{cycles.count:9}{cycles.wrong:7}{cycles.longest * 1000:9.2f}" if cycles else f"{'-':>9}")
            + ("  WRONG WORKING COUNTERS" if wrong else "")
            + ("  TOO LATE" if late else ""),
            flush=True,
        )
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
