"""What those have in common who speak to a rack by chance.

An actor connects and then carries out chapters: `chapters` names them, `act(name)` does one. What a device refuses or
does not answer is part of the story.
"""

import contextlib
import struct

from ethercat_host import Refused
from rack_process import Silent

PATIENCE = 0.15  # s; what is not answered then is not answered
ETHERCAT_PORT, CAN_PORT, SERIAL_PORT = 34980, 29537, 29142
SAVE, LOAD = 0x65766173, 0x64616F6C
MODES = {"pp": 1, "pv": 3, "tq": 4, "hm": 6, "csp": 8, "csv": 9, "cst": 10}
SAFE = (Refused, Silent, struct.error, IndexError, ValueError)


def log_uniform(rng, low, high):
    return int(low * (high / low) ** rng.random())


class Actor:
    chapters = ()
    first = None  # the chapter it begins with

    def __init__(self, rng, counts):
        self.rng = rng
        self.counts = counts  # collections.Counter: what was done

    def connect(self):
        raise NotImplementedError

    def act(self, chapter):
        """Counts the chapter, and how it ended."""
        self.counts[chapter] += 1
        try:
            getattr(self, chapter)()
        except SAFE as reason:
            self.counts["refused" if isinstance(reason, Refused) else "not answered"] += 1

    def try_to(self, do, *arguments):
        """What a device may refuse without the master giving up."""
        with contextlib.suppress(Refused):
            return do(*arguments)
        self.counts["refused"] += 1
        return None


class Axis:
    """The drive of CiA 402 behind a number of objects, moved in one mode after the other."""

    def __init__(self, rng, offset):
        self.rng = rng
        self.offset = offset
        self.cycle = 0
        self.position = 0
        self.plan()

    def plan(self):
        self.mode = self.rng.choice(list(MODES))
        self.target = self.rng.choice((-1, 1)) * log_uniform(self.rng, 500, 400000)
        self.velocity = self.rng.choice((-1, 1)) * log_uniform(self.rng, 50, 60000)
        self.torque = self.rng.randrange(-400, 400)
        self.length = self.rng.randrange(40, 160)
        self.ending = self.rng.choice((0x0F, 0x0F, 0x10F, 0x02, 0x00, 0x07))
        self.cycle = 0

    def values(self):
        """{object: value} of the next cycle."""
        number = self.cycle
        self.cycle += 1
        word = (0x80, 0x00, 0x06, 0x06, 0x07, 0x07, 0x0F, 0x0F)[number] if number < 8 else 0x0F
        if number >= 8 and self.mode in ("pp", "hm") and number % 16 < 8:
            word = 0x1F if self.mode == "hm" or self.target % 2 else 0x5F
        if number > self.length - 12:
            word = self.ending
        step = self.velocity // 500 or 1
        if number >= 8 and self.mode == "csp":
            self.position += step
        if number > self.length:
            self.plan()
        values = {
            0x6040: word,
            0x6060: MODES[self.mode],
            0x60FF: self.velocity,
            0x6071: self.torque,
            0x607A: self.position if self.mode == "csp" else self.target,
        }
        return {index + self.offset: value for index, value in values.items()}
