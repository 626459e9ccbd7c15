"""A connection of PyTrinamic to a serial line of a rack in this process.

    with stator.pytrinamic.Connection(rack.line()) as connection:
        module = TMCM142(connection)

Sending a telegram moves simulated time in lockstep, and waiting for its reply does; while the rack follows the machine's
clock, seconds are the machine's.
"""

from __future__ import annotations

from pytrinamic.connections.tmcl_interface import TmclInterface
from pytrinamic.tmcl import TMCLReplyChecksumError

from ._rack import Line, Rack


class Connection(TmclInterface):  # type: ignore[misc]
    """A host on a serial line.

    Args:
        line: of a rack, or a rack with one line.
        host_id: address of the host.
        module_id: address of the module that commands without one go to.
        timeout_s: simulated seconds to wait for a reply.
    """

    def __init__(self, line: Line | Rack, host_id: int = 2, module_id: int = 1, timeout_s: float = 5.0) -> None:
        super().__init__(host_id, module_id)
        self._line = line.line() if isinstance(line, Rack) else line
        self._timeout = timeout_s
        self._received = b""

    def _send(self, host_id: int, module_id: int, data: bytearray) -> None:
        self._received = b""
        self._line.read()
        self._line.write(bytes(data))

    def _recv(self, host_id: int, module_id: int) -> bytes:
        return self._recv_bulk(9, host_id, module_id)

    def _recv_bulk(self, incoming_bytes: int, host_id: int, module_id: int) -> bytes:
        def arrived() -> bool:
            self._received += self._line.read()
            return len(self._received) >= incoming_bytes

        if not self._line.rack.wait_until(arrived, self._timeout):
            raise RuntimeError(
                f"no reply came over {self._line.name} within {self._timeout:g} s, but {len(self._received)} bytes"
            )
        taken, self._received = self._received[:incoming_bytes], self._received[incoming_bytes:]
        return taken

    def _reply_check(self, reply: object) -> None:
        if not reply.is_checksum_correct():  # type: ignore[attr-defined]
            raise TMCLReplyChecksumError(reply)

    def set_timeout(self, timeout: float) -> None:
        """Simulated seconds to wait for a reply."""
        self._timeout = timeout

    def get_timeout(self) -> float:
        """Simulated seconds that a reply is waited for."""
        return self._timeout

    def __str__(self) -> str:
        return f"Connection: type={type(self).__name__} line={self._line.name}"


__all__ = ["Connection"]
