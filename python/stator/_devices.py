"""Devices of one's own: their objects are declared and their behaviour is written in Python."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

from . import _native
from ._errors import Error

Value = bool | int | float | str | bytes
Address = int | tuple[int, int]


@dataclass(frozen=True)
class Object:
    """An entry of an object dictionary (CiA 301, 7.4; ETG.1000.6, 5.6.7).

    Attributes:
        index: 0x0000 to 0xFFFF; those from 0x1000 on that say who the device is come by themselves.
        name: what people read; of one that is mapped it is the signal's name, too.
        type: "boolean", "integer8" to "integer64", "unsigned8" to "unsigned64", "real32", "real64",
            "visible-string", "octet-string" or "domain".
        access: by SDO: "rw", "ro", "wo" or "const".
        pdo: in which process data it may stand, seen from the device: "no", "receive" (the master's outputs),
            "transmit" (its inputs) or "both".
        default: the value after power-on.
        minimum: the least value that a write may have, with ``maximum``; else it is refused as CiA 301 says.
        maximum: the greatest.
        unit: for people.
        subindex: see :func:`record`, which numbers them.
        object_name: of the record that subindex 0 begins.
    """

    index: int
    name: str
    type: str = "unsigned32"
    access: str = "rw"
    pdo: str = "no"
    default: Value = 0
    minimum: int | None = None
    maximum: int | None = None
    unit: str = ""
    subindex: int = 0
    object_name: str = ""


def record(index: int, name: str, members: Iterable[Object]) -> list[Object]:
    """The entries of a record: its subindex 0, and ``members`` as subindices 1, 2, ... whatever index they were given."""
    numbered = [replace(each, index=index, subindex=number) for number, each in enumerate(members, start=1)]
    highest = Object(
        index,
        "Highest subindex",
        type="unsigned8",
        access="const",
        default=len(numbered),
        object_name=name,
    )
    return [highest, *numbered]


class OwnDevice:
    """A device of one's own; derive from :class:`EtherCatDevice` or :class:`CanOpenDevice`.

    A class is a product: ``Rack(..., products=[Probe])`` makes ``type = "probe"`` a type of devices like any other, and
    an instance of the class for each of them (``rack["probe"].own``). State machine, mailbox with its services, process
    data, EEPROM or PDO parameters, emergencies and the objects that say who it is come by themselves.

    Functions are called with simulated time standing still, by whichever thread lets it pass, one at a time. In them
    ``self[index]`` and ``self[index, subindex]`` are the values of objects, without the checks of a write. What one of
    them raises comes out where time was let pass, e.g. of :meth:`stator.Rack.run`; no function of that device is called
    afterwards. A network is cyclic and Python is not fast: a step each millisecond costs some percent of a core.

    Attributes:
        type: the word for it in rack files.
        name: what masters read (1008h, SII); the type if it is empty.
        vendor, code, revision: its identity (1018h).
        period: simulated seconds between two calls of :meth:`step`.
        objects: what it has beside those that come by themselves.
    """

    type: ClassVar[str] = ""
    name: ClassVar[str] = ""
    network: ClassVar[str] = ""
    vendor: ClassVar[int] = 0
    code: ClassVar[int] = 0
    revision: ClassVar[int] = 1
    period: ClassVar[float] = 0.001
    objects: ClassVar[Sequence[Object]] = ()

    _device: _native.DeviceLink | None = None

    def start(self) -> None:
        """The firmware starts: objects have their defaults, all else is to be as at power-on."""

    def step(self, now: float) -> None:
        """A period begins, at ``now`` simulated seconds."""

    def check(self, index: int, subindex: int, value: Value) -> None:
        """A number is about to be written; raise :class:`stator.ObjectRefused` to refuse it, with an abort code."""

    def written(self, index: int, subindex: int, value: Value) -> None:
        """A value was written, by SDO or, where it changed, by process data."""

    def read(self, index: int, subindex: int) -> Value | None:
        """A value is about to be read by SDO; returns the present one, or None to leave it as it is."""
        return None

    @property
    def _link(self) -> _native.DeviceLink:
        if self._device is None:
            raise Error(
                f"{self!r} has no device; a rack makes instances itself: Rack(..., products=[{type(self).__name__}])"
            )
        return self._device

    def __getitem__(self, address: Address) -> Value:
        index, subindex = address if isinstance(address, tuple) else (address, 0)
        return self._link.value(index, subindex)

    def __setitem__(self, address: Address, value: Value) -> None:
        index, subindex = address if isinstance(address, tuple) else (address, 0)
        self._link.set_value(index, subindex, value)

    @property
    def state(self) -> str:
        """Of the network, in its standard's words, e.g. "Operational"."""
        return self._link.state

    def emergency(self, code: int, error_register: int = 1, data: bytes = b"") -> None:
        """Sends an emergency: error code, bits of 1001h, and up to five bytes of one's own; code 0: errors are gone."""
        self._link.emergency(code, error_register, data)


class EtherCatDevice(OwnDevice):
    """A device on an EtherCAT segment, with a CoE mailbox; outputs, if there are some, have two bytes at least."""

    network = "segment"


class CanOpenDevice(OwnDevice):
    """A node on a CANopen bus; ``node_id`` stands in the rack file, ``bit_rate`` (bit/s) is the class's."""

    network = "bus"
    bit_rate: ClassVar[int] = 1_000_000


__all__ = ["CanOpenDevice", "EtherCatDevice", "Object", "OwnDevice", "record"]
