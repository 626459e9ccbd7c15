"""A host of a TMCL module, over a serial line that is a TCP port, or over CAN."""

import socket
import struct
import time

from ethercat_host import Refused
from rack_process import PATIENCE, Gone, Silent

SAP, GAP, STAP, RSAP, SGP, GGP, STGP, RSGP, SCO, GCO = 5, 6, 7, 8, 9, 10, 11, 12, 30, 31
START_DOWNLOAD, QUIT_DOWNLOAD, READ_MEMORY = 132, 133, 134
SUCCESS, LOADED = 100, 101
MODULE, HOST = 1, 2


class SerialHost:
    patience = PATIENCE

    def __init__(self, address, port):
        try:
            self.socket = socket.create_connection((address, port))
        except OSError as error:
            raise Gone(str(error)) from None
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def close(self):
        self.socket.close()

    def exchange(self, core):
        """The seven bytes from the module's address on... of the reply to the seven of a command."""
        telegram = bytes([MODULE]) + core
        try:
            self.socket.sendall(telegram + bytes([sum(telegram) & 0xFF]))
            end = time.monotonic() + self.patience
            reply = b""
            while len(reply) < 9:
                self.socket.settimeout(max(end - time.monotonic(), 0.001))
                data = self.socket.recv(9 - len(reply))
                if not data:
                    raise Gone("the line was closed")
                reply += data
        except TimeoutError:
            raise Silent(f"no reply to {core.hex(' ')}") from None
        except OSError as error:
            raise Gone(str(error)) from None
        if sum(reply[:8]) & 0xFF != reply[8]:
            raise Silent(f"a damaged reply to {core.hex(' ')}: {reply.hex(' ')}")
        return reply[1:8]


class CanModule:
    """The same over a bus."""

    def __init__(self, host):
        self.host = host

    def close(self):
        self.host.close()

    def exchange(self, core):
        self.host.send(MODULE, core)
        return self.host.receive(HOST)


class Module:
    """Commands, and what came of them."""

    def __init__(self, host):
        self.host = host

    def close(self):
        self.host.close()

    def ask(self, command, kind=0, bank=0, value=0, expected=SUCCESS):
        """The reply's value."""
        reply = self.host.exchange(struct.pack(">BBBi", command, kind, bank, value))
        _, status, echoed, result = struct.unpack(">BBBi", reply[:7])
        if echoed != command:
            raise Silent(f"command {command} is answered as {echoed}")
        if status != expected:
            raise Refused(f"command {command}, {kind}, {bank}, {value}: status {status}")
        return result

    def instruction(self, address):
        """What the program memory holds there: command, type, motor, value. The reply to 134 has its own form."""
        reply = self.host.exchange(struct.pack(">BBBi", READ_MEMORY, 0, 0, address))
        return struct.unpack(">BBBi", reply[:7])
