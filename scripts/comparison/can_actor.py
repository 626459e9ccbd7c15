"""Programs at a CAN bus, by chance."""

import contextlib
import struct
import time

import can_host
import tmcl_host
from comparison.actors import CAN_PORT, LOAD, MODES, PATIENCE, SAFE, SAVE, Actor, Axis, log_uniform
from comparison.tmcl_actors import Module
from rack_process import Gone


class CanHost(can_host.CanHost):
    patience = PATIENCE

    def drain(self, seconds=0.0):
        """Frames that came; nobody looks at them."""
        end = time.monotonic() + seconds
        count = self.received.count(b"\r")
        self.received = b""
        while True:
            self.socket.settimeout(max(end - time.monotonic(), 0.0005))
            try:
                data = self.socket.recv(65536)
            except TimeoutError:
                return count
            except OSError as error:
                raise Gone(str(error)) from None
            if not data:
                raise Gone("the adapter has closed the connection")
            count += data.count(b"\r")


class Bus(Actor):
    """Programs at a CAN bus: NMT, SDOs, PDOs and SYNC of a TMCC160, LSS; TMCL of a TMCM-142."""

    chapters = (
        "node",
        "node",
        "moves",
        "moves",
        "moves",
        "syncs",
        "syncs",
        "objects",
        "store",
        "layer_settings",
        "noise",
        "module",
    )

    def __init__(self, rng, counts, address, objects, node, module):
        super().__init__(rng, counts)
        self.address = address
        self.objects_of_node = objects
        self.number = node
        self.module_id = module

    def connect(self):
        self.host = CanHost(self.address, CAN_PORT)
        self.client = can_host.SdoClient(self.host, self.number)
        self.axis = Axis(self.rng, 0)
        if self.number:
            with contextlib.suppress(*SAFE):
                self.client.wait_for_node()

    def close(self):
        self.host.close()

    def node(self):
        command = self.rng.choice((1, 1, 1, 1, 1, 2, 0x80, 0x81, 0x82))
        self.host.send(0x000, bytes((command, self.rng.choice((0, self.number)))))
        self.host.drain(0.002)
        if command > 0x80:
            self.syncs()
        if self.rng.random() < 0.3:
            self.try_to(self.client.download, 0x1017, 0, self.rng.choice((0, 5, 20)), 2)
        if self.rng.random() < 0.3:
            for _ in range(5):
                self.host.send(0x700 + self.number, b"")
        self.counts["NMT commands"] += 1

    def syncs(self):
        if self.number and self.rng.random() < 0.5:
            self.try_to(self.client.download, 0x1800, 2, self.rng.choice((0, 1, 3, 254, 255)), 1)
        for number in range(self.rng.randrange(20, 120)):
            if number % 4 == 0:
                word = self.axis.values()[0x6040]
                self.host.send(0x200 + self.number, struct.pack("<H", word))
            self.host.send(0x080, b"")
            self.counts["SYNCs"] += 1
            if number % 16 == 0:
                self.host.drain()
        self.host.drain(0.002)

    def moves(self):
        if not self.number:
            return
        self.host.send(0x000, bytes((1, self.number)))
        axis = self.axis
        axis.plan()
        download = self.client.download
        self.try_to(download, 0x6060, 0, MODES[axis.mode], 1)
        for index, value, size in (
            (0x607A, axis.target, 4),
            (0x60FF, axis.velocity, 4),
            (0x6071, axis.torque, 2),
            (0x6081, abs(axis.velocity), 4),
            (0x6083, 100000, 4),
        ):
            self.try_to(download, index, 0, value & (1 << 8 * size) - 1, size)
        for word in (0x80, 0x06, 0x07, 0x0F, 0x1F):
            self.try_to(download, 0x6040, 0, word, 2)
            for _ in range(self.rng.randrange(10)):
                self.host.send(0x080, b"")
        for _ in range(self.rng.randrange(20, 80)):
            self.host.send(0x080, b"")
        self.try_to(self.client.upload, 0x6064, 0)
        self.try_to(self.client.upload, 0x6041, 0)
        self.counts["moves"] += 1

    def objects(self):
        if not self.number:
            return
        for _ in range(self.rng.randrange(3, 12)):
            index, subindex, size, writable = self.rng.choice(self.objects_of_node)
            self.try_to(self.client.upload, index, subindex)
            if writable and self.rng.random() < 0.3:
                self.try_to(self.client.download, index, subindex, self.rng.randrange(1 << 8 * min(size, 2)), size)

    def store(self):
        if not self.number:
            return
        for _ in range(self.rng.randrange(1, 3)):
            self.try_to(self.client.download, 0x6083, 0, log_uniform(self.rng, 1000, 100000), 4)
            kind, word = self.rng.choice(((0x1010, SAVE), (0x1010, SAVE), (0x1011, LOAD)))
            self.try_to(self.client.download, kind, self.rng.choice((1, 2, 4)), word, 4)
        self.counts["parameters stored, tmcc160"] += 1

    def layer_settings(self):
        if self.rng.random() < 0.5:
            return
        for data in ((4, 1), (0x5A, 0), (0x5E, 0), (0x11, self.number or 5), (0x17, 0), (4, 0), (0x4C, 0)):
            self.host.send(0x7E5, bytes(data).ljust(8, b"\0"))
        self.host.drain(0.002)

    def noise(self):
        for _ in range(self.rng.randrange(20)):
            self.host.send(self.rng.randrange(0x800), self.rng.randbytes(self.rng.randrange(9)))
        self.host.drain(0.002)

    def module(self):
        if self.module_id:
            program = Module(self.rng, self.counts, lambda: tmcl_host.CanModule(self.host))
            program.connect()
            program.act(self.rng.choice(program.chapters))
