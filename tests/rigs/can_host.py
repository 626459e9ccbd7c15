"""A CAN adapter in a few lines, at a port `slcan-tcp:` of a rack, and an SDO client on it."""

import socket
import struct
import time

from ethercat_host import Refused
from rack_process import PATIENCE, Gone, Silent


class CanHost:
    patience = PATIENCE

    def __init__(self, address, port):
        try:
            self.socket = socket.create_connection((address, port))
            self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self.socket.sendall(b"O\r")
        except OSError as error:
            raise Gone(str(error)) from None
        self.received = b""

    def close(self):
        self.socket.close()

    def send(self, identifier, data):
        try:
            self.socket.sendall(b"t%03X%d%s\r" % (identifier, len(data), data.hex().encode("ascii")))
        except OSError as error:
            raise Gone(str(error)) from None

    def receive(self, identifier, seconds=None):
        """The data of the next frame with that identifier."""
        seconds = self.patience if seconds is None else seconds
        end = time.monotonic() + seconds
        while True:
            line, ends, rest = self.received.partition(b"\r")
            if ends:
                self.received = rest
                if line[:4] == b"t%03X" % identifier:
                    return bytes.fromhex(line[5 : 5 + 2 * int(line[4:5])].decode("ascii"))
                continue
            self.socket.settimeout(max(end - time.monotonic(), 0.001))
            try:
                data = self.socket.recv(65536)
            except TimeoutError:
                raise Silent(f"no frame {identifier:03x}h within {seconds:g} s") from None
            except OSError as error:
                raise Gone(str(error)) from None
            if not data:
                raise Gone("the adapter has closed the connection")
            self.received += data


class SdoClient:
    """Expedited transfers with one node."""

    def __init__(self, host, node):
        self.host = host
        self.node = node

    def _ask(self, request, index, subindex, data=bytes(4), seconds=None):
        self.host.send(0x600 + self.node, struct.pack("<BHB", request, index, subindex) + data.ljust(4, b"\0"))
        while True:
            answer = self.host.receive(0x580 + self.node, seconds)
            if struct.unpack_from("<HB", answer, 1) != (index, subindex):
                continue  # to a request that was sent before the node was there
            if answer[0] == 0x80:
                raise Refused(f"{index:04x}h:{subindex:02x}: abort {struct.unpack_from('<I', answer, 4)[0]:08x}h")
            return answer

    def wait_for_node(self):
        """A node boots for half a second, in which it hears nothing."""
        end = time.monotonic() + self.host.patience
        while True:
            try:
                return self._ask(0x40, 0x1000, 0, seconds=0.05)
            except Silent:
                if time.monotonic() > end:
                    raise

    def upload(self, index, subindex):
        answer = self._ask(0x40, index, subindex)
        return int.from_bytes(answer[4 : 8 - (answer[0] >> 2 & 3)], "little")

    def download(self, index, subindex, value, size):
        self._ask(0x23 | (4 - size) << 2, index, subindex, value.to_bytes(size, "little"))
