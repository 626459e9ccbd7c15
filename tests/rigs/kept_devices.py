"""Devices as the kill rig orders them to keep something, and as it reads back what they have kept.

A device yields orders from `orders(rng)`: pairs of the cells that one order sets together (see KeptModel) and of
what gives the order and returns when it is answered. The generator is sent False where it was refused.
"""

import itertools
import time

from can_host import CanHost, SdoClient
from ethercat_host import BOOT, OP, PREOP, SAFEOP, Refused, Slave
from rack_process import PATIENCE, Silent
from tmcl_host import (
    GAP,
    GCO,
    GGP,
    LOADED,
    QUIT_DOWNLOAD,
    RSAP,
    RSGP,
    SAP,
    SCO,
    SGP,
    STAP,
    START_DOWNLOAD,
    STGP,
    CanModule,
    Module,
    SerialHost,
)

ETHERCAT_PORT, CAN_PORT, SERIAL_PORT = 34980, 29537, 29142
SAVE, LOAD = 0x65766173, 0x64616F6C


class Device:
    """`burst`: about how many orders it gets before it is killed."""

    burst = 8

    def __init__(self, rack, position=0):
        self.rack = rack  # address, and whether time moves only with frames
        self.position = position

    def connect(self):
        raise NotImplementedError

    def close(self):
        raise NotImplementedError

    def read(self, rng):
        """{cell: value} of everything that `orders` writes."""
        raise NotImplementedError

    def orders(self, rng):
        raise NotImplementedError


class Sii(Device):
    """Words at the end of the EEPROM, beyond what a master or the controller interprets."""

    burst = 30
    FIRST, COUNT = 0x3C0, 48

    def connect(self):
        self.slave = Slave(self.rack.address, ETHERCAT_PORT, self.position)

    def close(self):
        self.slave.close()

    def read(self, rng):
        words = self.slave.read_sii(self.FIRST, self.COUNT)
        return {f"word {self.FIRST + at:03x}h": word for at, word in enumerate(words)}

    def orders(self, rng):
        while True:
            begin = self.FIRST + rng.randrange(self.COUNT)
            for word in range(begin, min(begin + rng.choice((1, 1, 2, 8)), self.FIRST + self.COUNT)):
                value = rng.randrange(0x10000)
                yield {f"word {word:03x}h": value}, lambda: self.slave.write_sii(word, value)


class StoredObjects(Device):
    """Objects that 1010h stores and 1011h restores, group by group or all at once."""

    burst = 4
    GROUPS = {}  # subindex of 1010h and 1011h: [(index, subindex, size, values)]
    ALL = 1

    def __init__(self, rack, position=0):
        super().__init__(rack, position)
        self.defaults = None  # as the first start showed them
        self.objects = [each for group in self.GROUPS.values() for each in group]

    def read(self, rng):
        self.present = {self.cell(each): self.client.upload(*each[:2]) for each in self.objects}
        self.defaults = self.defaults or dict(self.present)
        return dict(self.present)

    @staticmethod
    def cell(each):
        return f"{each[0]:04x}h:{each[1]:02x}"

    def members(self, subindex):
        return [self.cell(each) for each in (self.objects if subindex == self.ALL else self.GROUPS[subindex])]

    def orders(self, rng):
        while True:
            subindex = rng.choice((self.ALL, self.ALL, self.ALL, *self.GROUPS))
            if rng.random() < 0.2:
                yield (
                    {cell: self.defaults[cell] for cell in self.members(subindex)},
                    lambda: self.client.download(0x1011, subindex, LOAD, 4),
                )
                continue
            for each in self.objects:
                value = rng.choice(each[3])
                self.client.download(*each[:2], value, each[2])
                self.present[self.cell(each)] = value
            yield (
                {cell: self.present[cell] for cell in self.members(subindex)},
                lambda: self.client.download(0x1010, subindex, SAVE, 4),
            )


class Tmc8670Parameters(StoredObjects):
    GROUPS = {
        2: [(0x10F1, 2, 2, range(1, 60000))],
        3: [(0x6065, 0, 4, range(1, 1 << 20)), (0x6083, 0, 4, range(1, 1 << 20)), (0x6085, 0, 4, range(1, 1 << 20))],
        4: [(0x2031, 2, 2, range(1, 60000)), (0x2031, 3, 4, range(1, 1 << 20))],
    }

    def connect(self):
        self.client = Slave(self.rack.address, ETHERCAT_PORT, self.position)
        self.client.open_mailbox()

    def close(self):
        self.client.close()


class Tmcc160Parameters(StoredObjects):
    GROUPS = {
        2: [(0x2704, 0, 2, (20, 50, 100, 125, 250, 500, 800, 1000))],
        4: [(0x6067, 0, 4, range(1, 1 << 20)), (0x6081, 0, 4, range(1, 100000)), (0x6083, 0, 4, range(1, 100000))],
    }

    def connect(self):
        self.client = SdoClient(CanHost(self.rack.address, CAN_PORT), 5)
        self.client.wait_for_node()

    def close(self):
        self.client.host.close()


class Firmware(Device):
    """The image that FoE loads in Bootstrap and reads back."""

    burst = 3

    def connect(self):
        self.slave = Slave(self.rack.address, ETHERCAT_PORT, self.position)
        self.slave.open_mailbox(BOOT)

    def close(self):
        self.slave.close()

    def read(self, rng):
        try:
            return {"image": self.slave.read_file()}
        except Refused:
            return {"image": None}

    def orders(self, rng):
        while True:
            image = rng.randbytes(int(2 ** rng.uniform(0, 17)))
            yield {"image": image}, lambda: self.slave.write_file(image)


class BoardEeprom(Device):
    """An I2C EEPROM at the pins of a TMC8461, by the chip's registers in process data; a page write is one order. It is
    answered when the part acknowledges its address again and shows what was written."""

    burst = 6
    TIMEBASE, CONTROL, ADDRESS, DATA_WRITE, STATUS, DATA_READ = 0x1000, 0x1004, 0x1008, 0x100C, 0x1200, 0x1204
    START, STOP, SEND_ADDRESS, SEND, RECEIVE, RECEIVE_LAST = 0x20, 0x10, 0x08, 0x04, 0x02, 0x01
    ADDRESSED, ACKNOWLEDGED, ENDED = 0x34, 0x30, {0x01, 0x02, 0x34, 0x2C, 0x54, 0x4C, 0x48, 0x28, 0x30, 0x50}
    PART, PAGE, PAGES, USED = 0xA0, 32, 4, 12

    def connect(self):
        self.slave = Slave(self.rack.address, ETHERCAT_PORT, self.position)
        for state in (PREOP, SAFEOP, OP):  # the chip follows by itself; outputs need Operational
            self.slave.go(state)
        self.slave.write(self.TIMEBASE, b"\x02")

    def close(self):
        self.slave.close()

    def command(self, command, register=None, value=0):
        """The status it ends with."""
        if register is not None:
            self.slave.write(register, bytes([value]))
        self.slave.write(self.CONTROL, bytes([command]))
        end = time.monotonic() + PATIENCE
        while (status := self.slave.read(self.STATUS, 1)[0]) not in self.ENDED and command != self.STOP:
            if time.monotonic() > end:
                raise Silent(f"I2C command {command:02x}h stays at status {status:02x}h")
        return status

    def address(self, place):
        """Waits until the part is no longer busy."""
        end = time.monotonic() + PATIENCE
        while True:
            self.command(self.START)
            if self.command(self.SEND_ADDRESS, self.ADDRESS, self.PART) == self.ADDRESSED:
                break
            self.stop()
            if time.monotonic() > end:
                raise Silent("the EEPROM does not acknowledge its address")
        for byte in place.to_bytes(2, "big"):
            self.command(self.SEND, self.DATA_WRITE, byte)

    def stop(self):
        self.command(self.STOP)
        end = time.monotonic() + PATIENCE
        while self.slave.read(self.STATUS, 1)[0] != 0:
            if time.monotonic() > end:
                raise Silent("the I2C master does not come to its stop")

    def read_page(self, page):
        self.address(page * self.PAGE)
        self.command(self.START)
        self.command(self.SEND_ADDRESS, self.ADDRESS, self.PART | 1)
        data = []
        for at in range(self.USED):
            self.command(self.RECEIVE if at + 1 < self.USED else self.RECEIVE_LAST)
            data.append(self.slave.read(self.DATA_READ, 1)[0])
        self.stop()
        return data

    def read(self, rng):
        return {
            f"byte {page * self.PAGE + at:04x}h": byte
            for page in range(self.PAGES)
            for at, byte in enumerate(self.read_page(page))
        }

    def write_page(self, place, data):
        self.address(place)
        for byte in data:
            self.command(self.SEND, self.DATA_WRITE, byte)
        self.stop()
        page, begin = divmod(place, self.PAGE)
        if bytes(self.read_page(page)[begin : begin + len(data)]) != data:
            raise Refused("the page shows what it held before")

    def orders(self, rng):
        while True:
            begin = rng.randrange(self.USED)
            data = rng.randbytes(rng.randrange(1, self.USED - begin + 1))
            place = rng.randrange(self.PAGES) * self.PAGE + begin
            yield (
                {f"byte {place + at:04x}h": byte for at, byte in enumerate(data)},
                lambda: self.write_page(place, data),
            )


class Tmcm142(Device):
    """Cells of the EEPROM and the program memory, by every command that writes them."""

    burst = 20
    # Parameters whose value changes nothing that would disturb the rig, with the values they take.
    AXIS = {
        47: range(1, 8388607),
        48: range(-(2**31), 2**31),
        50: range(-(2**31), 2**31),
        51: range(-(2**31), 2**31),
        64: range(256),
        212: range(1, 2**31),
        6: range(16),
        194: range(1, 2**31),
    }
    GLOBAL = {83: range(0x300, 0x700)}
    VARIABLES = range(0, 56, 9)
    COORDINATES = range(1, 21, 4)
    PROGRAM = 24

    def connect(self):
        self.module = Module(self.host())
        if self.module.ask(GGP, 84) != 1:  # coordinates live in the EEPROM
            self.module.ask(SGP, 84, 0, 1)

    def close(self):
        self.module.close()

    def read(self, rng):
        ask = self.module.ask
        if rng.random() < 0.3:  # as RSAP and RSGP bring it back from the EEPROM
            for number, values in self.AXIS.items():
                ask(SAP, number, 0, rng.choice(values))
                ask(RSAP, number)
            for number in self.VARIABLES:
                ask(SGP, number, 2, 1)
                ask(RSGP, number, 2)
        found = {f"axis {number}": ask(GAP, number) for number in self.AXIS}
        found |= {f"global {number}": ask(GGP, number) for number in self.GLOBAL}
        found |= {f"variable {number}": ask(GGP, number, 2) for number in self.VARIABLES}
        found |= {f"coordinate {number}": ask(GCO, number) for number in self.COORDINATES}
        found |= {f"instruction {at}": self.module.instruction(at) for at in range(self.PROGRAM)}
        return found

    def orders(self, rng):
        ask = self.module.ask
        kinds = itertools.cycle(rng.sample(range(5), 5))
        for kind in kinds:
            if kind == 0:
                number, values = rng.choice(list(self.AXIS.items()))
                value = rng.choice(values)
                ask(SAP, number, 0, value)
                yield {f"axis {number}": value}, lambda: ask(STAP, number)
            elif kind == 1:
                number, values = rng.choice(list(self.GLOBAL.items()))
                value = rng.choice(values)
                yield {f"global {number}": value}, lambda: ask(SGP, number, 0, value)
            elif kind == 2:
                number, value = rng.choice(self.VARIABLES), rng.randrange(-(2**31), 2**31)
                ask(SGP, number, 2, value)
                yield {f"variable {number}": value}, lambda: ask(STGP, number, 2)
            elif kind == 3:
                number, value = rng.choice(self.COORDINATES), rng.randrange(-(2**31), 2**31)
                yield {f"coordinate {number}": value}, lambda: ask(SCO, number, 0, value)
            else:
                yield from self.download(rng)

    def download(self, rng):
        ask = self.module.ask
        begin = rng.randrange(self.PROGRAM - 1)
        kept = yield {}, lambda: ask(START_DOWNLOAD, 0, 0, begin)
        for at in range(begin, rng.randrange(begin, self.PROGRAM)):
            if kept is False:
                break
            words = (
                rng.choice((SAP, SGP, SCO)),
                rng.randrange(256),
                rng.randrange(256),
                rng.randrange(-(2**31), 2**31),
            )
            kept = yield {f"instruction {at}": words}, lambda: ask(*words, expected=LOADED)
        yield {}, lambda: ask(QUIT_DOWNLOAD)


class SerialTmcm142(Tmcm142):
    def host(self):
        return SerialHost(self.rack.address, SERIAL_PORT)


class CanTmcm142(Tmcm142):
    def host(self):
        return CanModule(CanHost(self.rack.address, CAN_PORT))


class Row:
    """A rack and the devices on it that are tried at the same time, in the order of their positions."""

    def __init__(self, name, rack, *devices, lockstep=True, files=None):
        self.name = name
        self.rack = rack
        self.files = files or {}  # what the rack file names, by name
        self.devices = devices
        self.lockstep = lockstep  # whether its devices answer without time that passes on its own


def segment(*products):
    return f'[[segment]]\nlink = "udp:{{address}}:{ETHERCAT_PORT}"\n' + "".join(
        f'[[segment.device]]\ntype = "{product}"\n' for product in products
    )


BUS = f'[[bus]]\nbit_rate = "unlimited"\nports = ["slcan-tcp:{{address}}:{CAN_PORT}"]\n'
TMCC160 = '[[bus.device]]\ntype = "tmcc160"\nnode_id = 5\n'
CAN_MODULE = '[[bus.device]]\ntype = "tmcm-142"\n'
SERIAL_MODULE = f'[[device]]\ntype = "tmcm-142"\nname = "module"\nrs485 = "tcp:{{address}}:{SERIAL_PORT}"\n'

BOARD = (
    segment("tmc8461")
    + """mfc = "pins.toml"
[segment.device.board.memory]
type = "i2c-eeprom"
wires = {{ scl = "MFCIO14", sda = "MFCIO15" }}
"""
)
PINS = """
[identity]
order_code = "TMC8461-MEMORY"
device_emulation = true

[pins]
MFCIO14 = "SCL"
MFCIO15 = "SDA"

[write]
start = 0x1000

[write.registers]
I2C_TIMEBASE = "always"
I2C_CONTROL = "always"
I2C_ADDRESS = "always"
I2C_DATA_W = "always"

[read]
start = 0x1200

[read.registers]
I2C_STATUS = "always"
I2C_DATA_R = "always"
"""

ROWS = [
    Row("sii-tmc8461", segment("tmc8461"), Sii),
    Row("sii-tmc8670", segment("tmc8670"), Sii),
    Row("sii-tmcm-3315", segment("tmcm-3315"), Sii),
    Row("parameters-tmc8670", segment("tmc8670"), Tmc8670Parameters),
    Row("parameters-tmcc160", BUS + TMCC160, Tmcc160Parameters, lockstep=False),
    Row("firmware-tmcm-3315", segment("tmcm-3315"), Firmware),
    Row("firmware-tmc8670", segment("tmc8670"), Firmware),
    Row("board-eeprom", BOARD, BoardEeprom, files={"pins.toml": PINS}),
    Row("serial-tmcm-142", SERIAL_MODULE, SerialTmcm142),
    Row("can-tmcm-142", BUS + CAN_MODULE, CanTmcm142),
    Row(
        "all",
        segment("tmc8461", "tmc8670", "tmcm-3315") + BUS + TMCC160 + SERIAL_MODULE,
        Sii,
        Tmc8670Parameters,
        Sii,
        Tmcc160Parameters,
        SerialTmcm142,
        lockstep=False,
    ),
]
