"""The interface ``stator`` of python-can: a CAN bus of a rack in this process.

    bus = can.Bus(interface="stator", channel=rack.bus())
    network.connect(interface="stator", channel=rack.bus())      # python-canopen

In lockstep sending a frame moves simulated time by the rack's step, a SYNC by its cycle; ``recv(timeout)`` in the thread
that opened the bus lets time pass until a frame comes, at most for ``timeout`` simulated seconds. In another thread, e.g.
that of a :class:`can.Notifier`, it waits for what others let pass: :meth:`stator.Rack.run` returns when such threads have
handled all frames. While the rack follows the machine's clock (``start()``, or links) seconds are the machine's.
"""

from __future__ import annotations

import threading
from typing import Any

import can
from can import CanOperationError, Message

from . import _rack
from ._errors import Error

#: Simulated seconds that no rack comes to.
_FOR_EVER = 9e9
#: How long settle() waits for a thread that does not come back, e.g. since a listener waits for this one.
_PATIENCE = 30.0


class Bus(can.BusABC):
    """A program's place on a CAN bus of a rack.

    Args:
        channel: a :class:`stator.Bus`, or a :class:`stator.Rack` with one bus.
        can_filters: as python-can has them.

    Raises:
        can.CanInitializationError: the channel is no bus, or its rack is closed.
    """

    def __init__(self, channel: Any = None, can_filters: Any = None, **kwargs: Any) -> None:
        if isinstance(channel, _rack.Rack):
            channel = channel.bus()
        if not isinstance(channel, _rack.Bus):
            raise can.CanInitializationError(
                f"channel is {channel!r}; it must be a bus of a rack, e.g. channel=rack.bus()"
            )
        self._rack = channel.rack
        try:
            self._port = channel.port()
        except Error as error:
            raise can.CanInitializationError(str(error)) from error
        self.channel_info = f"CAN bus {channel.name} of {self._rack!r}"
        self._can_protocol = can.CanProtocol.CAN_20
        self._owner = threading.get_ident()
        self._open = True
        self._rack._listeners.append(self._settle)
        super().__init__(channel=channel.name, can_filters=can_filters, **kwargs)

    def send(self, msg: Message, timeout: float | None = None) -> None:
        """Puts a frame on the bus. Error and FD frames are refused with ValueError."""
        if msg.is_error_frame or msg.is_fd:
            raise ValueError("the bus carries classical data and remote frames only")
        try:
            self._port.send(msg.arbitration_id, bytes(msg.data), msg.is_extended_id, msg.is_remote_frame, msg.dlc)
        except Error as error:
            raise CanOperationError(str(error)) from error

    @staticmethod
    def _message(taken: tuple[float, int, bytes, bool, bool, int, bool]) -> Message:
        moment, identifier, data, extended, remote, length, destroyed = taken
        return Message(
            timestamp=moment,
            arbitration_id=identifier,
            is_extended_id=extended,
            is_remote_frame=remote,
            is_error_frame=destroyed,
            dlc=length,
            data=None if remote else data,
            check=False,
        )

    def _recv_internal(self, timeout: float | None) -> tuple[Message | None, bool]:
        owns = threading.get_ident() == self._owner
        try:
            if not owns or timeout == 0 or self._rack.native.running:
                taken = self._port.wait(timeout, not owns)
            else:
                taken = self._port.receive_within(_FOR_EVER if timeout is None else timeout)
        except Error as error:
            raise CanOperationError(str(error)) from error
        return None if taken is None else self._message(taken), False

    def _settle(self) -> None:
        """Waits until the thread that takes frames, if there is one, has handled all that have come."""
        if self._port.open:
            self._port.settle(_PATIENCE)
        else:  # the rack was brought back to a moment at which the port was not open yet
            self._leave()

    def shutdown(self) -> None:
        """Leaves the bus."""
        self._leave()
        super().shutdown()

    def _leave(self) -> None:
        if self._open:
            self._open = False
            if self._settle in self._rack._listeners:
                self._rack._listeners.remove(self._settle)
            self._port.close()


__all__ = ["Bus"]
