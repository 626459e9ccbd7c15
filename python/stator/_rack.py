"""Racks, and what is in them, in Python's terms."""

from __future__ import annotations

import asyncio
import difflib
import io
import warnings
from collections.abc import Callable, Iterator, Mapping, MutableMapping, Sequence
from os import PathLike, fspath
from pathlib import Path
from types import TracebackType
from typing import Any

from . import _native
from ._devices import OwnDevice, Value
from ._errors import Error

#: Simulated seconds that pass in another thread before this one's tasks can end it.
_SLICE = 0.05
Source = str | PathLike[str] | Mapping[str, Any]


def _missing(what: str, name: object, known: Sequence[str]) -> KeyError:
    near = difflib.get_close_matches(str(name), known, n=3)
    hint = f"; did you mean {' or '.join(near)}?" if near else f"; there are: {', '.join(known)}"
    return KeyError(f"there is no {what} {name!r}{hint}")


def _resolved(name: str, known: Sequence[str], what: str) -> str:
    """The one of ``known`` that is ``name``, or whose part behind a dot is, if there is one alone."""
    if name in known:
        return name
    ends = [each for each in known if each.endswith("." + name)]
    if len(ends) == 1:
        return ends[0]
    if ends:
        raise KeyError(f"{name!r} is the end of several {what}s: {', '.join(ends)}")
    raise _missing(what, name, known)


class Signals(Mapping[str, _native.Signal]):
    """Signals by name. A name is looked for as it is, and as the part behind a dot if only one ends so."""

    def __init__(self, rack: Rack, prefix: str) -> None:
        self._rack = rack
        self._prefix = prefix
        self._names = [name[len(prefix) :] for name, _ in rack.native.signal_names() if name.startswith(prefix)]

    def __getitem__(self, name: str) -> _native.Signal:
        return self._rack.native.signal(self._prefix + _resolved(name, self._names, "signal"))

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


class Inputs(MutableMapping[str, float]):
    """What can be set around a device: ``inputs["load_torque"] = 0.4``. Units and ranges: :meth:`info`."""

    def __init__(self, device: _native.Device, prefix: str = "") -> None:
        self._device = device
        self._prefix = prefix
        self._info = {each.name[len(prefix) :]: each for each in device.inputs() if each.name.startswith(prefix)}

    def info(self, name: str) -> _native.InputInfo:
        """Unit, range and usual value of an input."""
        return self._info[_resolved(name, list(self._info), "input")]

    def __getitem__(self, name: str) -> float:
        return self._device.input(self.info(name).name)

    def __setitem__(self, name: str, value: float) -> None:
        self._device.set_input(self.info(name).name, value)

    def __delitem__(self, name: str) -> None:
        """Sets it back to its usual value."""
        info = self.info(name)
        self._device.set_input(info.name, info.normal)

    def __iter__(self) -> Iterator[str]:
        return iter(self._info)

    def __len__(self) -> int:
        return len(self._info)


class Objects(Mapping["tuple[int, int]", Value]):
    """The object dictionary, beside the device's network: ``objects[0x6064]``, ``objects[0x1018, 1]``.

    Reading and writing go through the checks that an SDO goes through; what is refused is an
    :class:`~stator.ObjectRefused`.
    """

    def __init__(self, device: _native.Device) -> None:
        self._device = device

    @staticmethod
    def _address(key: int | tuple[int, int]) -> tuple[int, int]:
        return key if isinstance(key, tuple) else (key, 0)

    def __getitem__(self, key: int | tuple[int, int]) -> Value:
        return self._device.read_object(*self._address(key))

    def __setitem__(self, key: int | tuple[int, int], value: Value) -> None:
        index, subindex = self._address(key)
        self._device.write_object(index, subindex, value)

    def describe(self, index: int, subindex: int = 0) -> dict[str, str]:
        """The declaration of an entry: name, type, access, range, unit and where its document has it."""
        return self._device.describe_object(index, subindex)

    def __iter__(self) -> Iterator[tuple[int, int]]:
        return iter(self._device.objects())

    def __len__(self) -> int:
        return len(self._device.objects())

    def __contains__(self, key: object) -> bool:
        if isinstance(key, int):
            key = (key, 0)
        return key in self._device.objects()


class Axis:
    """One axis of a device: its signals, ``axis["shaft_speed"]``, and what can be set around it, ``axis.inputs``."""

    def __init__(self, device: Device, number: int) -> None:
        self._device = device
        self.number = number
        prefix = f"axis{number}."
        self.signals = Signals(device.rack, f"{device.name}.{prefix}")
        self.inputs = Inputs(device.native, prefix)

    def __getitem__(self, name: str) -> _native.Signal:
        return self.signals[name]

    def drive(self) -> _native.Drive:
        """The axis as a CiA 402 master sees it, over the device's network. Lockstep only."""
        return _native.Drive(self._device.native, self.number)

    def __repr__(self) -> str:
        return f"<Axis {self.number} of {self._device.name}>"


class DataSheet(io.StringIO):
    """A file in memory with a name, of whose ending readers take the kind of file."""

    def __init__(self, text: str, name: str) -> None:
        super().__init__(text)
        self.name = name


class Device:
    """A device of a rack. ``device["axis0.shaft_speed"]`` is a signal of it."""

    def __init__(self, rack: Rack, native: _native.Device) -> None:
        self.rack = rack
        self.native = native
        self.name = native.name
        self.signals = Signals(rack, native.name + ".")
        self.inputs = Inputs(native)
        self.objects = Objects(native)
        numbers = {
            int(head[4:])
            for head in (name.partition(".")[0] for name in self.signals)
            if head.startswith("axis") and head[4:].isdigit()
        }
        self.axis = tuple(Axis(self, number) for number in sorted(numbers))

    @property
    def network(self) -> str:
        """ "segment": it is on EtherCAT; "bus": on CAN."""
        return self.native.network

    @property
    def powered(self) -> bool:
        """Whether it has supply; setting it switches the supply."""
        return self.native.powered

    @powered.setter
    def powered(self, on: bool) -> None:
        self.rack.native.set_power(self.name, on)

    @property
    def node_id(self) -> int | None:
        """Of a CANopen device; None: it is none."""
        return _native.node_id(self.native)

    @property
    def own(self) -> Any:
        """The instance of a class of devices of one's own; None: it is a product of Stator's."""
        return self.native.own

    def eds(self) -> DataSheet:
        """The electronic data sheet of a CANopen device, as python-canopen takes one: ``network.add_node(1, device.eds())``."""
        return DataSheet(_native.eds(self.native), f"{self.name}.eds")

    def __getitem__(self, name: str) -> _native.Signal:
        return self.signals[name]

    def upload(self, index: int, subindex: int = 0) -> bytes:
        """Reads an object over the device's network, by SDO: its bytes, the lowest first. Lockstep only."""
        return _native.sdo_upload(self.native, index, subindex)

    def download(self, index: int, subindex: int, data: bytes) -> None:
        """Writes an object over the device's network, by SDO. Lockstep only."""
        _native.sdo_download(self.native, index, subindex, data)

    def tmcl(self, command: int, type: int = 0, motor: int = 0, value: int = 0) -> _native.TmclReply:
        """Sends a direct command to a TMCL module, over its serial line if it has one, else over CAN. Lockstep only."""
        return _native.tmcl(self.native, command, type, motor, value)

    def emergencies(self) -> list[_native.Emergency]:
        """Emergency messages that nobody has fetched, the oldest first. Lockstep only."""
        return _native.emergencies(self.native)

    def wait_for_boot_up(self) -> None:
        """Lets time pass until a CANopen node hears its master. Lockstep only."""
        _native.wait_for_boot_up(self.native)

    def __repr__(self) -> str:
        return f"<Device {self.name}>"


class Segment:
    """An EtherCAT segment of a rack."""

    def __init__(self, rack: Rack, number: int) -> None:
        self.rack = rack
        self.number = number

    def master(self) -> _native.EtherCatMaster:
        """The small master of this segment: scan, SDO, process data, states. Lockstep only."""
        return _native.EtherCatMaster(self.rack.native, self.number)

    def __repr__(self) -> str:
        return f"<Segment {self.number}>"


class Bus:
    """A CAN bus of a rack, e.g. for ``can.Bus(interface="stator", channel=bus)``."""

    def __init__(self, rack: Rack, name: str) -> None:
        self.rack = rack
        self.name = name
        self.signals = Signals(rack, name + ".")

    def __getitem__(self, name: str) -> _native.Signal:
        return self.signals[name]

    def port(self) -> _native.CanPort:
        """A place on the bus, for frames as they are; python-can's ``stator`` interface is more comfortable."""
        return _native.CanPort(self.rack.native, self.name)

    def __repr__(self) -> str:
        return f"<Bus {self.name}>"


class Line:
    """A serial line of a rack, e.g. for :class:`stator.pytrinamic.Connection`."""

    def __init__(self, rack: Rack, number: int, name: str) -> None:
        self.rack = rack
        self.number = number
        self.name = name

    def write(self, data: bytes) -> None:
        """Sends bytes to the devices of the line, and lets what they answer at once pass. Lockstep only."""
        _native.write_line(self.rack.native, self.number, data)

    def read(self) -> bytes:
        """What they have sent since the last call. Lockstep only."""
        return _native.read_line(self.rack.native, self.number)

    def __repr__(self) -> str:
        return f"<Line {self.name}>"


class Rack(Mapping[str, Device]):
    """Everything one rack file describes: devices by name, their networks, and simulated time.

    Args:
        source: path of a rack file, the type of a product ("tmcm-3315": one such device), or a mapping with the keys of
            a rack file.
        links: open the links, ports and lines that the file names, and let time follow the machine's clock, as ``stator
            run`` does. Without it the rack is in lockstep: time passes with what masters send and wait for and with
            :meth:`run`, or follows the machine's clock between :meth:`start` and :meth:`stop`.
        limit: simulated seconds after which the rack takes no more time; a test that hangs then ends with
            :class:`~stator.TimeLimitReached`.
        signals: names of signals that are recorded from the beginning, with ``*`` as wild card; () records none.
        period: simulated seconds between two samples of them.
        changes: "PATH=VALUE" each, as ``--set`` of commands has them, e.g. "x.axis[0].load.inertia=2e-4".
        products: classes of devices of one's own (:class:`stator.EtherCatDevice`, :class:`stator.CanOpenDevice`), whose
            types the source may name beside those of Stator.
        recording: file, e.g. "run.stator", in which everything that is done to the rack is recorded from power-on on; see
            :meth:`record`.
        rewindable: keep a recording, in a temporary folder, for :meth:`snapshot` and :meth:`rewind`; not with ``links``.
            A rack with ``recording`` can be brought back anyway.

    Raises:
        RackFileError: the source has a mistake; the text says where and what to do.
        Error: it cannot be built, or a link cannot be opened.

    A rack is a context manager; at its end all threads have ended and all links are closed. Any thread may use it; one
    at a time gets it, and no thread holds the interpreter's lock while it does.
    """

    def __init__(
        self,
        source: Source,
        *,
        links: bool = False,
        limit: float | None = None,
        signals: Sequence[str] = ("*",),
        period: float = 0.001,
        changes: Sequence[str] = (),
        products: Sequence[type[OwnDevice]] = (),
        recording: str | PathLike[str] | None = None,
        rewindable: bool = False,
    ) -> None:
        file = "" if recording is None else fspath(recording)
        self.native = _native.Rack(
            source, links, limit, list(signals), period, list(changes), tuple(products), file, rewindable
        )
        self._names = self.native.device_names()
        self._devices: dict[str, Device] = {}
        self._listeners: list[Callable[[], None]] = []

    # Devices and networks.

    def __getitem__(self, name: str) -> Device:
        if name not in self._names:
            raise _missing("device", name, self._names)
        if name not in self._devices:
            self._devices[name] = Device(self, self.native.device(name))
        return self._devices[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    @property
    def signals(self) -> Signals:
        """All signals, with the device or bus in front: ``rack.signals["x.axis0.shaft_speed"]``."""
        return Signals(self, "")

    @property
    def segments(self) -> tuple[Segment, ...]:
        """EtherCAT segments, in the order of the file."""
        return tuple(Segment(self, number) for number in range(self.native.segment_count))

    def segment(self, number: int = 0) -> Segment:
        """An EtherCAT segment."""
        if not 0 <= number < self.native.segment_count:
            raise IndexError(f"there is no segment {number}; the rack has {self.native.segment_count}")
        return Segment(self, number)

    @property
    def buses(self) -> tuple[Bus, ...]:
        """CAN buses, in the order of the file."""
        return tuple(Bus(self, name) for name in self.native.bus_names() if name)

    def bus(self, name: str | int = 0) -> Bus:
        """A CAN bus by its name or number."""
        buses = self.buses
        if isinstance(name, int):
            if not 0 <= name < len(buses):
                raise IndexError(f"there is no CAN bus {name}; the rack has {len(buses)}")
            return buses[name]
        for bus in buses:
            if bus.name == name:
                return bus
        raise _missing("CAN bus", name, [bus.name for bus in buses])

    @property
    def lines(self) -> tuple[Line, ...]:
        """Serial lines, in the order in which devices name them."""
        return tuple(Line(self, number, name) for number, name in enumerate(self.native.line_names()))

    def line(self, number: int = 0) -> Line:
        """A serial line."""
        lines = self.lines
        if not 0 <= number < len(lines):
            raise IndexError(f"there is no serial line {number}; the rack has {len(lines)}")
        return lines[number]

    # Time.

    @property
    def now(self) -> float:
        """Simulated seconds since power-on."""
        return self.native.now

    def run(self, seconds: float) -> None:
        """Lets simulated time pass, in whole bus cycles: at once in lockstep, else as fast as it passes."""
        self.native.run(seconds)
        if self._listeners:
            self.settle()

    def wait_until(self, condition: Callable[[], object], limit: float) -> bool:
        """Runs, cycle by cycle, until ``condition()`` is true, at most for ``limit`` simulated seconds.

        Returns whether it was. In lockstep it is asked after each bus cycle.
        """
        end = self.native.now + limit
        while not condition():
            if self.native.now >= end:
                return False
            self.run(1e-9)
        return True

    async def run_async(self, seconds: float) -> None:
        """As :meth:`run`, in another thread, while the tasks of this one's event loop go on; it can be cancelled."""
        end = self.now + seconds
        while (left := end - self.now) > 0:
            await asyncio.to_thread(self.run, min(left, _SLICE))

    async def wait_until_async(self, condition: Callable[[], object], limit: float) -> bool:
        """As :meth:`wait_until`, while other tasks go on: ``condition()`` is asked in this thread, after each cycle."""
        end = self.now + limit
        while not condition():
            if self.now >= end:
                return False
            await asyncio.to_thread(self.run, 1e-9)
        return True

    def start(self, speed: float = 1.0) -> None:
        """Lets simulated time follow the machine's clock, ``speed`` times as fast, in a thread of its own."""
        self.native.start(speed)

    def stop(self) -> None:
        """Ends that; time stands until somebody lets it pass."""
        self.native.stop()

    def settle(self) -> None:
        """Waits until programs on buses of this rack have seen all frames that have passed (:mod:`stator.can`)."""
        for listener in list(self._listeners):
            listener()

    # What goes on and what goes wrong.

    def events(self, after: int = 0) -> list[_native.Event]:
        """What devices and networks had to say, the oldest first: the newest thousand, with a number above ``after``."""
        return self.native.events(after)

    def inject(self, kind: str, **keys: object) -> int:
        """Arms a fault, e.g. ``inject("motor-stall", device="x", axis=1)``, with the keys of a fault in a rack file.

        ``for`` is a word of Python's: write ``for_``. Returns the fault's number, for :meth:`clear_faults`.
        """
        return self.native.inject({"kind": kind, **{key.rstrip("_"): value for key, value in keys.items()}})

    def faults(self) -> list[_native.Fault]:
        """Faults that wait or are active, and the last ones that are over."""
        return self.native.faults()

    def clear_faults(self, number: int | None = None) -> int:
        """Ends the fault of that number, or all; returns how many ended."""
        return self.native.clear_faults(number)

    def run_scenario(self, source: Source, *, changes: Sequence[str] = ()) -> _native.ScenarioReport:
        """Runs the steps of a scenario on this rack, from the present moment; what the scenario says of a rack is not read.

        Args:
            source: path of a scenario file, or a mapping with the keys of one.
            changes: "PATH=VALUE" each, of keys of the scenario, e.g. "step[3].target=0".

        Lockstep only; :func:`stator.run_scenario` builds a rack for it. What is wrong with the scenario is a
        :class:`~stator.RackFileError`; a step that fails is one in the report.
        """
        return _native.run_scenario_on(self.native, source, list(changes))

    def forget_signals(self) -> None:
        """Drops all recorded samples so far; arrays that were taken stay."""
        self.native.forget_signals()

    def go_operational(self) -> None:
        """Takes all slaves to Operational, with their process data, and starts all CANopen nodes. Lockstep only."""
        _native.go_operational(self.native)

    # Recordings.

    def record(self, path: str | PathLike[str]) -> None:
        """Records everything that is done to the rack from now on, and what comes out of it, into the file ``path``.

        ``stator replay FILE`` does it again, anywhere, and compares every answer to the last bit; ``stator run --restore``
        goes on from it. The rack file and what it names are in the recording, so it needs nothing else. A recording begins
        at power-on: call this before anything else is done to the rack, or make the rack with ``recording=``, which is the
        only way with ``links=True``.

        Raises:
            Error: something was done to the rack already, the file cannot be written, or the rack names files that no
                recording can hold.
        """
        self.native.record(fspath(path))

    def mark(self, name: str) -> None:
        """Gives the present moment of the recording a name, by which ``stator run --restore FILE@NAME`` goes back to it.

        Raises:
            Error: the rack is not recorded, or there is such a name already.
        """
        self.native.mark(name)

    def snapshot(self, name: str = "") -> _native.Moment:
        """The present moment, to which :meth:`rewind` brings the rack back. It is a mark of the recording, too.

        The rack is in lockstep and recorded: ``rewindable=True``, ``recording=`` or :meth:`record`.

        Args:
            name: of the mark; one is made if it is empty.

        Raises:
            Error: the rack is not recorded or on links, or there is such a name already.
        """
        return self.native.snapshot(name)

    def rewind(self, moment: _native.Moment) -> None:
        """Brings the rack back to a moment of its own, as often as one likes; from there it can go another way.

        The rack is made anew and its recording is played up to there, so this takes as long as the devices compute. Devices,
        their state and surroundings, faults, events, recorded signals and time are what they were, and so are the masters
        of this package: the scan and process data of the EtherCAT master, drives, frames that wait. Everything that was got
        from the rack goes on being good, but for ports of CAN buses that were opened after the moment: they are closed.
        What a program of others knows, e.g. a node of python-canopen, is that program's: it is as it was before the call.

        The way not taken stays in its recording, and moments of it stay good. The new way is recorded, from power-on, in
        ``run-2.stator`` beside it. What :meth:`forget_signals` dropped comes back.

        Raises:
            Error: the moment is another rack's, time follows the machine's clock, or the recording is gone.
        """
        self.native.rewind(moment)
        if self._listeners:
            self.settle()

    def end_recording(self) -> None:
        """Ends the recording, whose file is complete afterwards; the rack goes on. The end of the rack ends it as well.

        Raises:
            Error: the rack is not recorded, or the disk was too slow or full, so that the recording ends before.
        """
        self.native.end_recording()

    @property
    def recording(self) -> Path | None:
        """The file of the recording, even when it has ended; None: there is none."""
        file = self.native.recording
        return Path(file) if file else None

    def export_mcap(self, path: str | PathLike[str], signals: Sequence[str] = ("*",)) -> None:
        """Writes recorded signals and events into an MCAP file, which PlotJuggler and Foxglove open.

        Each device or bus is a channel with messages in JSON, its signals at the paths that are their names; log time is
        simulated time in nanoseconds. The newest thousand events are messages of the topic ``events``. Needs the package
        ``mcap``: ``pip install stator[mcap]``.

        Args:
            path: of the file, e.g. "run.mcap".
            signals: names of recorded signals, with ``*`` as wild card.

        Raises:
            Error: no signal is recorded, none has such a name, the file cannot be written, or ``mcap`` is missing.
        """
        from .mcap import export

        export(self, path, signals)

    # Its end.

    def close(self) -> None:
        """Ends the rack: threads, links, places on buses, the recording. Calling it again does nothing."""
        incomplete = self.native.close()
        if incomplete:
            warnings.warn(incomplete, RuntimeWarning, stacklevel=2)

    @property
    def closed(self) -> bool:
        """Whether it was closed."""
        return self.native.closed

    def __enter__(self) -> Rack:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        if self.closed:
            return "<Rack, closed>"
        return f"<Rack {', '.join(self._names)} at {self.now:.6f} s>"

    def __hash__(self) -> int:
        return id(self)

    def __eq__(self, other: object) -> bool:
        return self is other


def run_scenario(source: Source, *, changes: Sequence[str] = ()) -> _native.ScenarioReport:
    """Runs a scenario on a rack of its own, as ``stator test`` does, with the same result.

    Args:
        source: path of a scenario file, or a mapping with the keys of one. The rack it names is beside the file.
        changes: "PATH=VALUE" each, as ``--set`` of ``stator test`` has them: "step[3].target=0" is of the scenario, others
            are of its rack.

    Returns:
        What it came to: the steps with what they saw, events, and curves of the signals it names. A step that fails is no
        exception; ``run_scenario(file).require()`` makes a test of it.

    Raises:
        RackFileError: the scenario has mistakes; the text has a sentence for each.
        Error: its rack cannot be built.
    """
    return _native.run_scenario(source, list(changes))


__all__ = ["Axis", "Bus", "Device", "Error", "Inputs", "Line", "Objects", "Rack", "Segment", "Signals", "run_scenario"]
