"""Hosts at serial lines, by chance."""

import contextlib
import struct
import time

import tmcl_host
from comparison.actors import PATIENCE, Actor, log_uniform


class SerialHost(tmcl_host.SerialHost):
    patience = PATIENCE


class Module(Actor):
    """A host of a TMCM-142: commands, moves, programs, what it keeps."""

    chapters = ("commands", "moves", "moves", "moves", "program", "program", "keep", "text", "bytes")

    def __init__(self, rng, counts, open_host):
        super().__init__(rng, counts)
        self.open_host = open_host

    def connect(self):
        self.host = self.open_host()
        self.module = tmcl_host.Module(self.host)

    def close(self):
        self.host.close()

    def commands(self):
        for _ in range(self.rng.randrange(5, 25)):
            command = self.rng.choice((6, 6, 10, 15, 14, 5, 9, 136, 135, 31, 13, 3, 12, 8))
            kind = 1 if command == 136 else self.rng.choice((1, 3, 4, 8, self.rng.randrange(256)))
            if command == 9:
                kind = self.rng.choice((75, 76, 79, 80))
            self.try_to(self.module.ask, command, kind, 0, self.rng.randrange(2000))

    def moves(self):
        ask = self.module.ask
        for number, value in (
            (4, log_uniform(self.rng, 10, 2047)),
            (5, log_uniform(self.rng, 10, 2047)),
            (6, self.rng.randrange(256)),
            (140, self.rng.randrange(9)),
        ):
            if self.rng.random() < 0.6:
                self.try_to(ask, tmcl_host.SAP, number, 0, value)
        command, kind, value = self.rng.choice(
            (
                (4, 0, self.rng.randrange(-200000, 200000)),
                (4, 1, self.rng.randrange(-50000, 50000)),
                (1, 0, self.rng.randrange(2048)),
                (2, 0, self.rng.randrange(2048)),
                (13, 0, 0),
                (3, 0, 0),
            )
        )
        self.try_to(ask, command, kind, 0, value)
        for _ in range(self.rng.randrange(20, 120)):
            self.try_to(ask, tmcl_host.GAP, self.rng.choice((1, 3, 8)))
        self.counts["moves"] += 1

    def program(self):
        """Loads a program that moves, runs it and looks at it."""
        ask = self.module.ask
        program = [
            (5, 4, 0, log_uniform(self.rng, 50, 2000)),
            (1, 0, 0, log_uniform(self.rng, 50, 2000)),
            (27, 0, 0, self.rng.randrange(1, 4)),
            (9, self.rng.randrange(56), 2, self.rng.randrange(1000)),
            (6, 1, 0, 0),
            (20, 0, 0, self.rng.randrange(1000)),
            (21, 4, 0, 2),
            (3, 0, 0, 0),
            (22, 0, 0, 1),
        ]
        self.try_to(ask, 128)
        self.try_to(ask, tmcl_host.START_DOWNLOAD)
        for words in program:
            self.try_to(lambda *words: ask(*words, expected=tmcl_host.LOADED), *words)
        self.try_to(ask, tmcl_host.QUIT_DOWNLOAD)
        self.counts["programs by TMCL"] += 1
        self.try_to(ask, 129, self.rng.randrange(2))
        for _ in range(self.rng.randrange(10, 60)):
            self.try_to(ask, *self.rng.choice(((135,), (6, 1), (6, 3), (10, 0, 2))))
        self.try_to(ask, self.rng.choice((128, 130, 131)))

    def keep(self):
        ask = self.module.ask
        for _ in range(self.rng.randrange(1, 6)):
            number = self.rng.randrange(56)
            command = self.rng.choice(
                (
                    (5, 4, 0, self.rng.randrange(2048)),
                    (7, 4),
                    (8, 4),
                    (9, number, 2, number),
                    (11, number, 2),
                    (12, number, 2),
                    (30, 1 + number % 20, 0, number),
                )
            )
            self.try_to(ask, *command)

    def text(self):
        if not isinstance(self.host, tmcl_host.SerialHost) or self.rng.random() < 0.7:
            return
        self.host.socket.sendall(b"\x01\x8b\0\0\0\0\0\0\x8c")
        self.host.socket.sendall(b"AGAP 1, 0\rAMVP REL, 0, 1000\rBIN\r")
        self.host.socket.settimeout(0.02)
        with contextlib.suppress(TimeoutError):
            while self.host.socket.recv(4096):
                pass

    def bytes(self):
        if isinstance(self.host, tmcl_host.SerialHost):
            self.host.socket.sendall(self.rng.randbytes(self.rng.randrange(1, 20)))
            time.sleep(0.02)
            self.host.socket.settimeout(0.02)
            with contextlib.suppress(TimeoutError):
                self.host.socket.recv(4096)


class Line(Actor):
    """A host at the serial interface of a drive: what it tells, and its boot loader."""

    chapters = ("questions", "questions", "questions", "boot_loader", "datagrams")
    KEY = (242, 0x81, 0x92, 0xA3B4C5D6)

    def __init__(self, rng, counts, open_host, product, interface):
        super().__init__(rng, counts)
        self.product = product
        self.open_host = open_host
        self.interface = interface
        if interface == "hardware-uart":
            self.chapters = ("datagrams",)

    def connect(self):
        self.host = self.open_host()
        self.module = tmcl_host.Module(self.host)

    def close(self):
        self.host.close()

    def questions(self):
        for _ in range(self.rng.randrange(3, 12)):
            command, kind = self.rng.choice(
                ((6, self.rng.randrange(256)), (10, 66), (15, 0), (136, 1), (1, 0), (99, 0))
            )
            self.try_to(self.module.ask, command, kind)
        time.sleep(0.01)

    def tell(self, command, kind, bank, value):
        """What is never answered."""
        telegram = struct.pack(">BBBBI", 1, command, kind, bank, value)
        self.host.socket.sendall(telegram + bytes([sum(telegram) & 0xFF]))

    def boot_loader(self):
        if self.rng.random() < 0.3:
            return
        self.tell(*self.KEY)
        time.sleep(0.01)
        ask = self.module.ask
        page, start = ask(206, 0), ask(206, 1)
        ask(200)
        image = self.rng.randbytes(self.rng.choice((20, 256, 300)))
        whole = image.ljust(-(-len(image) // page) * page, b"\xff")
        for at in range(0, len(whole), page):
            for word in range(page // 4):
                place = at + 4 * word
                ask(201, word % 256, word // 256, int.from_bytes(whole[place : place + 4], "little", signed=True))
            ask(202, 0, 0, start + at)
        ask(203, 0, 0, start + len(image) - 1)
        wrong = self.rng.random() < 0.2
        ask(208, 0, 0, len(image))
        ask(208, 1, 0, sum(image) + wrong)
        self.tell(205, 0, 0, 0)
        if wrong:
            ask(200)
            ask(208, 0, 0, 0)
            self.tell(205, 0, 0, 0)
        time.sleep(0.01)
        self.counts[f"firmware by boot loader, {self.product}"] += 1

    def datagrams(self):
        if self.interface != "hardware-uart":
            return
        for _ in range(self.rng.randrange(5, 20)):
            register = self.rng.randrange(0x80)
            write = self.rng.random() < 0.1
            self.host.socket.sendall(bytes([register | (0x80 if write else 0)]) + self.rng.randbytes(4))
            self.host.socket.settimeout(0.02)
            with contextlib.suppress(TimeoutError):
                self.host.socket.recv(64)
            self.counts["UART datagrams"] += 1
        time.sleep(0.02)
