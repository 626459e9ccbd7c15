"""An EtherCAT master in a few lines, over UDP: registers, SII, mailbox, CoE and FoE of one slave at a time.

It retries what the standards let a master retry (a busy EEPROM, a full mailbox, FoE's "busy") and nothing else.
"""

import socket
import struct
import time

from rack_process import PATIENCE, Gone, Silent

APRD, APWR, LRW = 1, 2, 12
AL_CONTROL, AL_STATUS, AL_STATUS_CODE = 0x0120, 0x0130, 0x0134
SII_CONTROL, SII_ADDRESS, SII_DATA = 0x0502, 0x0504, 0x0508
SII_READ, SII_WRITE, SII_BUSY, SII_ERRORS = 0x0100, 0x0201, 0x8000, 0x6000
INIT, PREOP, BOOT, SAFEOP, OP = 1, 2, 3, 4, 8
SYNC_MANAGER = 0x0800
COE, FOE = 3, 4
MAILBOX_HEADER = 6
KNOCK = 0.05  # s
NO_OPERATION = struct.pack("<HBBHHHHH", 0x100C, 0, 0, 0, 0, 0, 0, 0)
SII_PATIENCE = 0.5  # s after which a device ends the access to a memory that does not answer
READ, WRITE, DATA, ACKNOWLEDGE, ERROR, BUSY = range(1, 7)  # operations of FoE


class Refused(Exception):
    """The device said no, in the words of the protocol."""


class GivenUp(Refused):
    """The device has ended an access that its memory had not; what it said no to may be kept all the same."""


class Slave:
    """The slave at `position`; it has a socket of its own, so slaves may be used from several threads."""

    patience = PATIENCE

    def __init__(self, address, port, position=0):
        self.position = position
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.connect((address, port))
        self.index = 0
        self.frames = 0  # sent so far
        self.counter = 0
        self.mailboxes = None

    def close(self):
        self.socket.close()

    # Frames

    def exchange(self, command, register, data, position=None):
        """Data and working counter of one datagram that goes around the segment."""
        adp = -(self.position if position is None else position) & 0xFFFF
        return self._exchange(command, struct.pack("<HH", adp, register), data)

    def exchange_logical(self, address, data, command=LRW):
        """The same of the segment's logical memory."""
        return self._exchange(command, struct.pack("<I", address), data)

    def _exchange(self, command, address, data):
        self.index = (self.index + 1) & 0xFF
        self.frames += 1
        head = struct.pack("<BB4sHH", command, self.index, address, len(data), 0)
        body = head + data + b"\0\0"
        frame = struct.pack("<H", len(body) | 0x1000) + body
        try:
            self.socket.send(frame)
            answer = self._receive(head[:2])
        except OSError as error:
            raise Gone(str(error)) from None
        return answer[12 : 12 + len(data)], struct.unpack_from("<H", answer, 12 + len(data))[0]

    def _receive(self, begin):
        """The frame that begins so. Who waits knocks: that a port is closed is told to who sends there."""
        end = time.monotonic() + self.patience
        while time.monotonic() < end:
            self.socket.settimeout(KNOCK)
            try:
                answer = self.socket.recv(2048)
            except TimeoutError:
                self.socket.send(NO_OPERATION)
                continue
            if answer[2:4] == begin:
                return answer
        raise Silent(f"no answer to a frame within {self.patience:g} s")

    def read(self, register, length):
        data, counter = self.exchange(APRD, register, bytes(length))
        if counter != 1:
            raise Refused(f"reading {register:04x}h: working counter {counter}")
        return data

    def write(self, register, data):
        if self.exchange(APWR, register, data)[1] != 1:
            raise Refused(f"writing {register:04x}h: working counter is not 1")

    def read16(self, register):
        return struct.unpack("<H", self.read(register, 2))[0]

    # SII

    def _wait_for_sii(self, begin):
        """For the end of an access; `begin` is a time before it was ordered, so that none that the device gave up
        counts as refused because this program had to wait for a processor."""
        end = time.monotonic() + self.patience
        while (status := self.read16(SII_CONTROL)) & SII_BUSY:
            if time.monotonic() > end:
                raise Silent(f"the EEPROM is busy for more than {self.patience:g} s")
            time.sleep(0.0002)
        if status & SII_ERRORS:
            self.write(SII_CONTROL, bytes(2))  # which acknowledges the error
            given_up = time.monotonic() - begin > 0.9 * SII_PATIENCE
            raise (GivenUp if given_up else Refused)(f"0502h is {status:04x}h")

    def read_sii(self, word, count):
        """`count` words from `word` on."""
        words = []
        while len(words) < count:
            begin = time.monotonic()
            self.write(SII_CONTROL, struct.pack("<HI", SII_READ, word + len(words)))
            self._wait_for_sii(begin)
            words += struct.unpack("<HH", self.read(SII_DATA, 4))
        return words[:count]

    def write_sii(self, word, value):
        """Returns when the EEPROM is no longer busy, which is its answer."""
        begin = time.monotonic()
        self.write(SII_DATA, struct.pack("<H", value))
        self.write(SII_CONTROL, struct.pack("<HI", SII_WRITE, word))
        self._wait_for_sii(begin)

    # States and mailbox

    def go(self, state):
        self.write(AL_CONTROL, struct.pack("<H", state))
        end = time.monotonic() + self.patience
        while (status := self.read16(AL_STATUS)) & 0x1F != state:
            if status & 0x10:
                code = self.read16(AL_STATUS_CODE)
                self.write(AL_CONTROL, struct.pack("<H", status))
                raise Refused(f"AL status {status:04x}h, code {code:04x}h")
            if time.monotonic() > end:
                raise Silent(f"AL status stays {status:04x}h, {state} was requested")
            time.sleep(0.0005)

    def open_mailbox(self, state=PREOP):
        """From any state to Pre-operational, or to Bootstrap with the mailboxes of that state."""
        self.go(INIT)
        first, length, second, second_length = self.read_sii(0x14 if state == BOOT else 0x18, 4)
        self.mailboxes = (first, length, second, second_length)
        self.write(SYNC_MANAGER, struct.pack("<HHBBBB", first, length, 0x26, 0, 1, 0))
        self.write(SYNC_MANAGER + 8, struct.pack("<HHBBBB", second, second_length, 0x22, 0, 1, 0))
        self.go(state)

    def send_mail(self, kind, payload):
        self.counter = self.counter % 7 + 1
        first, length = self.mailboxes[:2]
        mail = struct.pack("<HHBB", len(payload), 0, 0, kind | self.counter << 4) + payload
        end = time.monotonic() + self.patience
        while self.exchange(APWR, first, mail.ljust(length, b"\0"))[1] != 1:
            if time.monotonic() > end:
                raise Silent("the mailbox stays full")
            time.sleep(0.0005)

    def receive_mail(self, kind):
        """The payload of the next mail of that kind; others are passed over."""
        second, length = self.mailboxes[2:]
        end = time.monotonic() + self.patience
        while True:
            if self.read(SYNC_MANAGER + 13, 1)[0] & 8:
                mail = self.read(second, length)
                if mail[5] & 15 == kind:
                    return mail[MAILBOX_HEADER : MAILBOX_HEADER + struct.unpack_from("<H", mail)[0]]
            elif time.monotonic() > end:
                raise Silent("no answer in the mailbox")
            else:
                time.sleep(0.0003)

    # CoE

    def _sdo(self, request, index, subindex, data=bytes(4)):
        self.send_mail(COE, struct.pack("<HBHB", 2 << 12, request, index, subindex) + data.ljust(4, b"\0"))
        while True:
            answer = self.receive_mail(COE)
            service = struct.unpack_from("<H", answer)[0] >> 12
            if service == 2:  # an abort comes as a request
                code = struct.unpack_from("<I", answer, 6)[0]
                raise Refused(f"{index:04x}h:{subindex:02x}: abort {code:08x}h")
            if service == 3:
                return answer[2], answer[6:]

    def upload(self, index, subindex):
        command, data = self._sdo(0x40, index, subindex)
        return int.from_bytes(data[: 4 - (command >> 2 & 3)], "little")

    def download(self, index, subindex, value, size):
        self._sdo(0x23 | (4 - size) << 2, index, subindex, value.to_bytes(size, "little"))

    # FoE

    def _foe(self, operation, number, data=b""):
        self.send_mail(FOE, struct.pack("<BBI", operation, 0, number) + data)
        answer = self.receive_mail(FOE)
        operation, _, number = struct.unpack_from("<BBI", answer)
        if operation == ERROR:
            raise Refused(f"FoE error {number:04x}h")
        return operation, number, answer[6:]

    def write_file(self, content, name=b"firmware"):
        room = self.mailboxes[1] - MAILBOX_HEADER - 6
        packets = [content[at : at + room] for at in range(0, len(content) + 1, room)]
        self._foe(WRITE, 0, name)
        for number, packet in enumerate(packets, 1):
            while self._foe(DATA, number, packet)[0] == BUSY:
                time.sleep(0.002)

    def read_file(self, name=b"firmware"):
        room = self.mailboxes[3] - MAILBOX_HEADER - 6
        content = b""
        _, number, data = self._foe(READ, 0, name)
        while True:
            content += data
            if len(data) < room:
                self.send_mail(FOE, struct.pack("<BBI", ACKNOWLEDGE, 0, number))
                return content
            _, number, data = self._foe(ACKNOWLEDGE, number)
