"""Recorded signals and events as MCAP, which PlotJuggler and Foxglove open.

    rack.export_mcap("run.mcap", signals=["x.axis0.*"])
    python -m stator.mcap run.csv                             # of stator run --record, stator replay --csv

Each device or bus is a channel whose messages are JSON: the signal ``x.axis0.shaft_speed`` is ``axis0.shaft_speed`` in
messages of the topic ``x``, so its path in Foxglove is its name. The schema says the units. Simulated time is log time, in
nanoseconds since power-on. Events are messages of the topic ``events`` in the form of Foxglove's Log panel. Needs the package
``mcap`` (``pip install stator[mcap]``).
"""

from __future__ import annotations

import argparse
import csv
import json
import math
import sys
from collections.abc import Generator, Iterable, Iterator, Sequence
from contextlib import contextmanager
from fnmatch import fnmatchcase
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from ._errors import Error

if TYPE_CHECKING:
    from mcap.writer import Writer

    from ._rack import Rack

#: Levels of Foxglove's Log panel.
_LEVELS = {"information": 2, "refusal": 3, "warning": 3, "fault": 4}
_LOG_SCHEMA = {
    "type": "object",
    "title": "foxglove.Log",
    "properties": {
        "timestamp": {
            "type": "object",
            "title": "time",
            "properties": {"sec": {"type": "integer"}, "nsec": {"type": "integer"}},
        },
        "level": {"type": "integer", "description": "2: information, 3: refusal or warning, 4: fault"},
        "message": {"type": "string"},
        "name": {"type": "string", "description": "of the device or bus"},
        "file": {"type": "string"},
        "line": {"type": "integer"},
        "id": {"type": "string", "description": "of the kind of event"},
    },
}
_NANOSECONDS = 1_000_000_000


class _Event(Protocol):
    @property
    def time(self) -> float: ...
    @property
    def severity(self) -> str: ...
    @property
    def id(self) -> str: ...
    @property
    def device(self) -> str: ...
    @property
    def text(self) -> str: ...


@contextmanager
def _written(path: str | PathLike[str]) -> Generator[Writer, None, None]:
    """A file that is whole at its end."""
    try:
        from mcap.writer import CompressionType, Writer
    except ImportError as error:
        raise Error("the package mcap is missing; pip install stator[mcap] brings it") from error
    try:
        file = open(fspath(path), "wb")  # noqa: SIM115  it is closed below
    except OSError as error:
        raise Error(f"cannot write {fspath(path)}: {error.strerror}") from error
    with file:
        writer = Writer(file, compression=CompressionType.ZSTD)
        writer.start(profile="", library="stator")
        yield writer
        writer.finish()  # type: ignore[no-untyped-call]


def _number(value: float) -> float | None:
    """JSON has no infinity and no number that is none."""
    return value if math.isfinite(value) else None


class _Channel:
    """The signals of one device or bus."""

    def __init__(self, writer: Writer, topic: str, signals: Sequence[tuple[int, str, str]]) -> None:
        self._writer = writer
        self._places: list[tuple[int, list[str]]] = []
        schema: dict[str, Any] = {"type": "object", "properties": {}}
        for column, name, unit in signals:
            *groups, last = name.split(".")
            self._places.append((column, [*groups, last]))
            within = schema
            for group in groups:
                within = within["properties"].setdefault(group, {"type": "object", "properties": {}})
            within["properties"][last] = {"type": ["number", "null"], "description": f"unit: {unit or '1'}"}
        number = writer.register_schema(name=f"stator.{topic}", encoding="jsonschema", data=json.dumps(schema).encode())
        self._number = writer.register_channel(topic=topic, message_encoding="json", schema_id=number)

    def write(self, time: int, row: Sequence[float]) -> None:
        message: dict[str, Any] = {}
        for column, (*groups, last) in self._places:
            within = message
            for group in groups:
                within = within.setdefault(group, {})
            within[last] = _number(row[column])
        self._writer.add_message(
            channel_id=self._number, log_time=time, publish_time=time, data=json.dumps(message).encode()
        )


def _write_signals(
    writer: Writer, names: Sequence[tuple[str, str]], rows: Iterable[tuple[int, Sequence[float]]]
) -> None:
    """Signals by name and unit; rows with their times in nanoseconds."""
    devices: dict[str, list[tuple[int, str, str]]] = {}
    for column, (name, unit) in enumerate(names):
        device, _, rest = name.partition(".")
        devices.setdefault(device, []).append((column, rest or device, unit))
    channels = [_Channel(writer, device, signals) for device, signals in devices.items()]
    for time, row in rows:
        for channel in channels:
            channel.write(time, row)


def _write_events(writer: Writer, events: Iterable[_Event]) -> None:
    schema = writer.register_schema(name="foxglove.Log", encoding="jsonschema", data=json.dumps(_LOG_SCHEMA).encode())
    channel = writer.register_channel(topic="events", message_encoding="json", schema_id=schema)
    for event in events:
        time = round(event.time * _NANOSECONDS)
        message = {
            "timestamp": {"sec": time // _NANOSECONDS, "nsec": time % _NANOSECONDS},
            "level": _LEVELS.get(event.severity, 0),
            "message": event.text,
            "name": event.device,
            "file": "",
            "line": 0,
            "id": event.id,
        }
        writer.add_message(channel_id=channel, log_time=time, publish_time=time, data=json.dumps(message).encode())


def export(rack: Rack, path: str | PathLike[str], signals: Sequence[str] = ("*",)) -> None:
    """See :meth:`stator.Rack.export_mcap`."""
    if not rack.native.recorded_signals():
        raise Error('the rack records no signals; make it with signals=["*"], or the names you want')
    recorded = [rack.native.signal(name) for name in rack.native.recorded_signals()]
    for pattern in signals:
        if not any(fnmatchcase(signal.name, pattern) for signal in recorded):
            raise Error(f'no recorded signal is named "{pattern}"')
    chosen = [signal for signal in recorded if any(fnmatchcase(signal.name, pattern) for pattern in signals)]
    columns = [signal.numpy() for signal in chosen]
    times = chosen[0].times()
    # Time may go on meanwhile in another thread: what all have counts.
    count = min(len(times), *(len(column) for column in columns))
    rows = ((round(times[row] * _NANOSECONDS), [float(column[row]) for column in columns]) for row in range(count))
    with _written(path) as writer:
        _write_signals(writer, [(signal.name, signal.unit) for signal in chosen], rows)
        _write_events(writer, rack.events())


def convert(table: str | PathLike[str], path: str | PathLike[str]) -> None:
    """Makes an MCAP file of a table of signals (CSV), as ``stator run --record`` and ``stator replay --csv`` write them.

    Raises:
        Error: the table cannot be read or is none of these, or the file cannot be written.
    """
    source = fspath(table)
    try:
        file = open(source, newline="")  # noqa: SIM115  it is closed below
    except OSError as error:
        raise Error(f"cannot read {source}: {error.strerror}") from error
    with file:
        reader = csv.reader(file)
        header = next(reader, list[str]())
        if len(header) < 2 or header[0] != "time [s]":
            raise Error(f'{source} is no table of signals: its first row does not begin with "time [s]"')
        names: list[tuple[str, str]] = []
        for column in header[1:]:
            name, _, unit = column.partition(" [")
            names.append((name, unit.removesuffix("]")))

        def rows() -> Iterator[tuple[int, Sequence[float]]]:
            for number, row in enumerate(reader, start=2):
                try:
                    time, *values = map(float, row)
                except ValueError:
                    time, values = 0.0, []
                if len(values) != len(names):
                    raise Error(f"{source}:{number} is no row of {len(names) + 1} numbers")
                yield round(time * _NANOSECONDS), values

        with _written(path) as writer:
            _write_signals(writer, names, rows())


def main(arguments: Sequence[str] | None = None) -> int:
    """Converts tables of signals; returns the exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m stator.mcap",
        description="Make MCAP files, for PlotJuggler and Foxglove, of tables of signals: RUN.csv becomes RUN.mcap.",
    )
    parser.add_argument("tables", nargs="+", metavar="RUN.csv", help="of stator run --record or stator replay --csv")
    for table in parser.parse_args(arguments).tables:
        try:
            convert(table, Path(table).with_suffix(".mcap"))
        except Error as error:
            print(f"stator.mcap: {error}", file=sys.stderr)
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
