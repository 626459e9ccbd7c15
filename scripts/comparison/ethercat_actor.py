"""A master of EtherCAT, by chance."""

import struct

import ethercat_host
from comparison.actors import ETHERCAT_PORT, LOAD, MODES, PATIENCE, SAVE, Actor, Axis, log_uniform
from ethercat_host import APRD, BOOT, INIT, OP, PREOP, SAFEOP
from rack_process import Silent

ARMW = 13  # the first slave's register to all behind it
LOGICAL = 0x10000  # where process data begin
READ = (
    0x0000,
    0x0010,
    0x0012,
    0x0110,
    0x0120,
    0x0130,
    0x0134,
    0x0220,
    0x0300,
    0x0308,
    0x0400,
    0x0420,
    0x0440,
    0x0500,
    0x0800,
    0x0910,
    0x092C,
    0x0932,
    0x0990,
    0x09B0,
)
INPUTS = 0x1400  # of the I/O block, behind its outputs


class Slave(ethercat_host.Slave):
    patience = PATIENCE

    def send_mail(self, kind, payload):
        if self.mailboxes is None:
            raise Silent("its mailbox was never opened")
        super().send_mail(kind, payload)


class Drive:
    """What a segment's master knows of a slave with a mailbox."""

    def __init__(self, slave, product, rng):
        self.slave = slave
        self.product = product
        self.axes = [Axis(rng, 0x800 * number) for number in range(3 if product.type == "tmcm-3315" else 1)]
        self.outputs = []  # (index, offset in bytes, size)


class Segment(Actor):
    """A master of EtherCAT: states, process data with and without SYNC0, SDOs, EEPROM, firmware."""

    chapters = (
        "start",
        "start",
        "cycles",
        "cycles",
        "cycles",
        "cycles",
        "registers",
        "objects",
        "objects",
        "eeprom",
        "fall",
        "store",
        "firmware",
        "chip",
    )
    first = "start"

    def __init__(self, rng, counts, address, products):
        super().__init__(rng, counts)
        self.address = address
        self.products = products
        self.image = 0

    def connect(self):
        self.drives = [
            Drive(Slave(self.address, ETHERCAT_PORT, at), product, self.rng) for at, product in enumerate(self.products)
        ]
        self.head = self.drives[0].slave

    def close(self):
        for drive in self.drives:
            drive.slave.close()

    def with_mailbox(self):
        return [drive for drive in self.drives if drive.product.objects]

    # Start

    def start(self):
        self.image = 0
        for drive in self.drives:
            if not drive.product.objects:
                for state in (INIT, PREOP, SAFEOP, OP):
                    self.try_to(drive.slave.go, state)
                continue
            drive.slave.open_mailbox()
            self.configure(drive)
        if self.rng.random() < 0.6:
            self.synchronise()
        for state in (SAFEOP, OP):
            for drive in self.with_mailbox():
                self.try_to(drive.slave.go, state)
                self.logical()
        self.counts["started"] += 1

    def configure(self, drive):
        """Sync managers and FMMUs as the objects for them say."""
        slave = drive.slave
        if self.rng.random() < 0.2:
            for mode in MODES.values():
                self.try_to(slave.download, 0x6060, 0, mode, 1)
        for axis in drive.axes:
            self.try_to(slave.download, 0x6060 + axis.offset, 0, MODES[axis.mode], 1)
            self.try_to(slave.download, 0x6081 + axis.offset, 0, log_uniform(self.rng, 500, 100000), 4)
            self.try_to(slave.download, 0x6083 + axis.offset, 0, log_uniform(self.rng, 5000, 1000000), 4)
            self.try_to(slave.download, 0x6098 + axis.offset, 0, self.rng.choice((1, 2, 17, 19, 33, 34, 35, 37)), 1)
        longest = 0
        for manager, (assignment, place) in enumerate(zip((0x1C12, 0x1C13), drive.product.areas, strict=True), 2):
            entries = self.mapped(slave, assignment)
            length = sum(bits for _, bits in entries) // 8
            longest = max(longest, length)
            output = manager == 2
            if output:
                offset = 0
                drive.outputs = []
                for index, bits in entries:
                    drive.outputs.append((index, self.image + offset, bits // 8))
                    offset += bits // 8
            control = 0x64 if output else 0x20
            slave.write(0x0800 + 8 * manager, struct.pack("<HHBBBB", place, length, control, 0, 1, 0))
            slave.write(
                0x0600 + 16 * (manager - 2),
                struct.pack("<IHBBHBBB3x", LOGICAL + self.image, length, 0, 7, place, 0, 2 if output else 1, 1),
            )
        self.image += longest

    def mapped(self, slave, assignment):
        entries = []
        for number in range(1, slave.upload(assignment, 0) + 1):
            pdo = slave.upload(assignment, number)
            for entry in range(1, slave.upload(pdo, 0) + 1):
                value = slave.upload(pdo, entry)
                entries.append((value >> 16, value & 0xFF))
        return entries

    def synchronise(self):
        """System time, offset and delay, then SYNC0 and now and then SYNC1."""
        cycle = self.rng.choice((500000, 1000000, 1000000, 2000000))
        for drive in self.drives:
            self.counts[f"SYNC0, {drive.product.type}"] += 1
            slave = drive.slave
            slave.write(0x0900, bytes(4))
            local = struct.unpack("<Q", slave.read(0x0918, 8))[0]
            slave.write(0x0920, struct.pack("<Q", (10**9 - local) & 2**64 - 1))
            slave.write(0x0928, struct.pack("<I", self.rng.randrange(2000)))
            self.try_to(slave.write, 0x0980, b"\0\0")
            if drive.product.objects:
                for assignment in (0x1C32, 0x1C33):
                    self.try_to(slave.download, assignment, 1, 2, 2)
                    self.try_to(slave.download, assignment, 2, cycle, 4)
            now = struct.unpack("<Q", slave.read(0x0910, 8))[0]
            second = self.rng.random() < 0.3
            slave.write(0x09A0, struct.pack("<II", cycle, cycle // 2 if second else 0))
            slave.write(0x0990, struct.pack("<Q", now + self.rng.choice((200000, 2000000, 2345678))))
            slave.write(0x0980, bytes((0, 7 if second else 3)))
        for _ in range(self.rng.randrange(10)):
            self.head.exchange(ARMW, 0x0910, bytes(8))  # FRMW: the first one's time to all

    # Process data

    def logical(self):
        """One exchange of process data of all."""
        image = bytearray(max(self.image, 1))
        for drive in self.with_mailbox():
            for axis in drive.axes:
                values = axis.values()
                for index, offset, size in drive.outputs:
                    if index in values:
                        image[offset : offset + size] = (values[index] & (1 << 8 * size) - 1).to_bytes(size, "little")
        self.head.exchange_logical(LOGICAL, bytes(image))
        self.counts["process data"] += 1

    def cycles(self):
        for _ in range(self.rng.randrange(50, 250)):
            self.logical()
            if self.rng.random() < 0.02:
                self.head.exchange(ARMW, 0x0910, bytes(8))

    # Around them

    def registers(self):
        slave = self.rng.choice(self.drives).slave
        for _ in range(self.rng.randrange(5, 30)):
            register = self.rng.choice(READ)
            slave.exchange(APRD, register, bytes(self.rng.choice((1, 2, 4, 8, 16))))
        for register, data in (
            (0x0010, self.rng.randbytes(2)),
            (0x0300, bytes(8)),
            (0x0400, b"\xc2\x09"),
            (0x0420, struct.pack("<H", self.rng.randrange(20, 2000))),
            (0x0932, struct.pack("<H", self.rng.randrange(0x1000))),
            (0x0900, bytes(4)),
            (0x0F80, self.rng.randbytes(4)),
            (0x0200, self.rng.randbytes(2)),
        ):
            if self.rng.random() < 0.3:
                self.try_to(slave.write, register, data)

    def objects(self):
        drives = self.with_mailbox()
        if not drives:
            return
        drive = self.rng.choice(drives)
        for _ in range(self.rng.randrange(3, 15)):
            index, subindex, size, writable = self.rng.choice(drive.product.objects)
            self.try_to(drive.slave.upload, index, subindex)
            if writable and self.rng.random() < 0.4:
                value = self.rng.choice((0, 1, self.rng.randrange(256), self.rng.randrange(1 << 8 * size)))
                self.try_to(drive.slave.download, index, subindex, value % (1 << 8 * size), size)
            if self.rng.random() < 0.3:
                self.logical()

    def eeprom(self):
        slave = self.rng.choice(self.drives).slave
        slave.read_sii(self.rng.randrange(0x40), 4)
        for _ in range(self.rng.randrange(3)):
            slave.write_sii(0x3C0 + self.rng.randrange(48), self.rng.randrange(0x10000))

    def fall(self):
        slave = self.rng.choice(self.drives).slave
        slave.go(self.rng.choice((INIT, PREOP, SAFEOP, SAFEOP)))
        for _ in range(self.rng.randrange(20)):
            self.logical()
        self.try_to(slave.go, self.rng.choice((OP, SAFEOP, PREOP, BOOT, 5)))

    def store(self):
        """Parameters to the memory and back to those of delivery, where there are such objects."""
        drives = [drive for drive in self.with_mailbox() if any(each[0] == 0x1010 for each in drive.product.objects)]
        if not drives:
            return
        drive = self.rng.choice(drives)
        slave = drive.slave
        for _ in range(self.rng.randrange(1, 4)):
            self.try_to(slave.download, 0x6083, 0, log_uniform(self.rng, 1000, 1000000), 4)
            if self.rng.random() < 0.7:
                self.try_to(slave.download, 0x1010, self.rng.randrange(1, 5), SAVE, 4)
            else:
                self.try_to(slave.download, 0x1011, self.rng.randrange(1, 5), LOAD, 4)
        self.counts[f"parameters stored, {drive.product.type}"] += 1

    def firmware(self):
        drives = self.with_mailbox()
        if not drives or self.rng.random() < 0.4:
            return
        drive = self.rng.choice(drives)
        slave = drive.slave
        slave.open_mailbox(BOOT)
        image = self.rng.randbytes(log_uniform(self.rng, 1, 12000))
        if self.rng.random() < 0.3:
            self.try_to(slave.read_file)
        slave.write_file(image)
        self.counts[f"firmware by FoE, {drive.product.type}"] += 1
        if self.rng.random() < 0.3:
            slave.read_file()
        slave.go(INIT)
        self.start()

    def chip(self):
        """The I/O block of chips without firmware, by its registers in process data."""
        chips = [drive for drive in self.drives if drive.product.block]
        if not chips:
            return
        drive = self.rng.choice(chips)
        self.try_to(drive.slave.go, OP)
        block = drive.product.block
        for name, value in (
            ("ENC_MODE", self.rng.randrange(256)),
            ("SD_STEPLENGTH", 50),
            ("SD_CH0_STEPRATE", self.rng.choice((-1, 1)) * log_uniform(self.rng, 1000, 2000000)),
            ("SD_CFG", 1),
            ("PWM_CFG", self.rng.randrange(256)),
            ("PWM1", self.rng.randrange(2000)),
            ("PWM2", self.rng.randrange(2000)),
            ("GPO", self.rng.randrange(256)),
            ("DAC_VAL", self.rng.randrange(65536)),
        ):
            if name in block and self.rng.random() < 0.8:
                address, size = block[name]
                self.try_to(drive.slave.write, address, (value & (1 << 8 * size) - 1).to_bytes(size, "little"))
        names = [name for name in block if block[name][0] < INPUTS]
        for _ in range(self.rng.randrange(20, 100)):
            if self.rng.random() < 0.1 and names:
                address, size = block[self.rng.choice(names)]
                self.try_to(drive.slave.write, address, self.rng.randbytes(size))
            self.try_to(drive.slave.read, INPUTS, 16)
            self.logical()
        self.counts["I/O block written"] += 1
