"""The plug-in for pytest: the fixture ``stator_rack`` gives each test a fresh rack.

Which rack: the marker ``@pytest.mark.stator_rack("gantry.toml", limit=10)``, whose arguments are those of
:class:`stator.Rack`; else the option ``--stator-rack FILE``; else ``stator_rack = FILE`` in the ini file, relative to it.
``@pytest.mark.stator_fault("motor-stall", device="x", at="200ms")`` arms a fault before the test begins.

A rack with ``links=True`` gets UDP and TCP ports that are free and names of its own for pseudo-terminals and other
sockets, so that tests run beside each other (``pytest -n 8``); ``stator_links`` tells where they are.

When a test fails its report has the last events and the faults; the recorded signals go to files whose names stand in the
report: a table (CSV), and a plot if matplotlib is there. Everything that was done to the rack is in a recording, which the
report names with the command that does it again; ``stator_recording = false`` in the ini file or ``--no-stator-recording``
leaves it away. Every test with a rack has its simulated seconds, rack and counts
of events as properties in JUnit reports.
"""

from __future__ import annotations

import csv
import shlex
import socket
import tomllib
from collections import Counter
from collections.abc import Generator, Iterator
from pathlib import Path
from typing import Any, cast

import pytest
from pluggy import Result

from . import Error, Rack

#: Events and rows of signals that a report of a failed test shows.
_EVENTS = 30
_ROWS = 20_000
#: How often ports are chosen that turn out to be taken.
_ATTEMPTS = 5
_rack_key = pytest.StashKey[Rack]()
_links_key = pytest.StashKey["dict[str, str]"]()
#: The recording of a test's rack, or why there is none.
_recording_key = pytest.StashKey["Path | str"]()
_failed_key = pytest.StashKey[bool]()


def pytest_addoption(parser: pytest.Parser) -> None:
    """Declares where the rack is named that tests get which name none."""
    parser.getgroup("stator").addoption(
        "--stator-rack", metavar="FILE", help="rack file, or type of a product, for tests that name none"
    )
    parser.getgroup("stator").addoption(
        "--no-stator-recording",
        action="store_true",
        help="keep no recording of the racks of tests, of which a failed test reports the file",
    )
    parser.addini("stator_recording", "record the racks of tests, for those that fail", type="bool", default=True)
    parser.addini("stator_rack", "rack file for tests that name none; relative to the ini file", default="")


def pytest_configure(config: pytest.Config) -> None:
    """Declares the markers."""
    config.addinivalue_line(
        "markers", "stator_rack(source, **options): the rack of the fixture stator_rack, as for stator.Rack"
    )
    config.addinivalue_line(
        "markers", "stator_fault(kind, **keys): a fault that is armed in the fixture stator_rack before the test begins"
    )


def _source(request: pytest.FixtureRequest) -> tuple[Any, dict[str, Any]]:
    """The rack of a test and its options. A file that a marker names is relative to the test's file."""
    marker = request.node.get_closest_marker("stator_rack")
    if marker is not None:
        options = dict(marker.kwargs)
        source = marker.args[0] if marker.args else options.pop("source", None)
        if source is not None:
            beside = request.path.parent / source if isinstance(source, str) else None
            return (beside if beside is not None and beside.is_file() else source), options
    else:
        options = {}
    given = request.config.getoption("--stator-rack")
    if given:
        return given, options
    named = str(request.config.getini("stator_rack"))
    if named:
        file = request.config.rootpath / named
        if request.config.inipath is not None:
            file = request.config.inipath.parent / named
        return (file if file.is_file() else named), options
    raise pytest.UsageError(
        f"{request.node.nodeid} names no rack: use @pytest.mark.stator_rack(FILE), --stator-rack FILE, "
        "or stator_rack = FILE in the ini file"
    )


def _free_port(kind: socket.SocketKind) -> int:
    """A port of loopback that nobody uses at present."""
    with socket.socket(socket.AF_INET, kind) as probe:
        probe.bind(("127.0.0.1", 0))
        return cast(int, probe.getsockname()[1])


def _own_link(link: str, folder: Path) -> str:
    """The same kind of link at a place that no other rack has."""
    kind, _, rest = link.partition(":")
    if kind == "udp":
        return f"udp:127.0.0.1:{_free_port(socket.SOCK_DGRAM)}"
    if kind in ("tcp", "socketcand", "slcan-tcp"):
        return f"{kind}:127.0.0.1:{_free_port(socket.SOCK_STREAM)}"
    if kind in ("pty", "slcan", "can-exec", "unix"):
        return f"{kind}:{folder / Path(rest).name}"
    return link


def _own_links(source: Any, folder: Path) -> dict[str, str]:
    """For each place of a rack file with a link, the link that a test of its own gets: "segment[0].link"."""
    if isinstance(source, (str, Path)):
        path = Path(source)
        if not path.is_file():
            return {}
        table = tomllib.loads(path.read_text())
    else:
        table = dict(source)
    links: dict[str, str] = {}
    own: dict[str, str] = {}

    def place(where: str, link: str) -> None:
        links[where] = own.setdefault(link, _own_link(link, folder))

    for number, segment in enumerate(table.get("segment", [])):
        for key in ("link", "redundant_link"):
            if key in segment:
                place(f"segment[{number}].{key}", segment[key])
    for number, bus in enumerate(table.get("bus", [])):
        for port, link in enumerate(bus.get("ports", [])):
            place(f"bus[{number}].ports[{port}]", link)
    for kind in ("segment", "bus"):
        for number, network in enumerate(table.get(kind, [])):
            for at, device in enumerate(network.get("device", [])):
                for key, value in device.items():
                    if isinstance(value, str) and value.partition(":")[0] in ("pty", "tcp"):
                        place(f"{kind}[{number}].device[{at}].{key}", value)
    return links


def _opened(source: Any, options: dict[str, Any], folder: Path) -> tuple[Rack, dict[str, str]]:
    """The rack, and its links if it opens some. A port that another process took meanwhile is given up for another."""
    if not options.get("links"):
        return Rack(source, **options), {}
    for attempt in range(_ATTEMPTS):
        links = _own_links(source, folder)
        changes = [*options.get("changes", ()), *(f"{key}={value}" for key, value in links.items())]
        own: dict[str, Any] = {**options, "changes": changes}
        try:
            return Rack(source, **own), links
        except Error as error:
            if attempt == _ATTEMPTS - 1 or "in use" not in str(error):
                raise
    raise AssertionError("unreachable")


def _recorded(
    request: pytest.FixtureRequest, source: Any, options: dict[str, Any], folder: Path
) -> tuple[Rack, dict[str, str], Path | str | None]:
    """The rack, its links, and its recording, or why there is none; None: nobody wants one."""
    config = request.config
    if options.get("recording") is not None:
        return *_opened(source, options, folder), Path(options["recording"])
    if config.getoption("--no-stator-recording") or not config.getini("stator_recording"):
        return *_opened(source, options, folder), None
    file = folder / "run.stator"
    try:
        return *_opened(source, {**options, "recording": file}, folder), file
    except Error as error:
        # A rack that no recording can hold, e.g. since it names files by absolute paths, can be tested all the same;
        # what else is wrong with it is wrong without a recording, too.
        return *_opened(source, options, folder), str(error)


@pytest.fixture
def stator_rack(request: pytest.FixtureRequest, tmp_path: Path, record_property: Any) -> Iterator[Rack]:
    """A fresh :class:`stator.Rack` for this test; see the plug-in's documentation for which."""
    source, options = _source(request)
    rack, links, recording = _recorded(request, source, options, tmp_path)
    with rack:
        request.node.stash[_rack_key] = rack
        if recording is not None:
            request.node.stash[_recording_key] = recording
        request.node.stash[_links_key] = links
        for marker in reversed(list(request.node.iter_markers("stator_fault"))):
            rack.inject(*marker.args, **marker.kwargs)
        yield rack
        record_property("stator_rack", str(source) if isinstance(source, (str, Path)) else "table")
        if not rack.closed:
            record_property("stator_seconds", f"{rack.now:.9f}")
            for severity, count in sorted(Counter(event.severity for event in rack.events()).items()):
                record_property(f"stator_events_{severity}", count)
    if (
        options.get("recording") is None
        and isinstance(recording, Path)
        and not request.node.stash.get(_failed_key, False)
    ):
        recording.unlink(missing_ok=True)


@pytest.fixture
def stator_links(request: pytest.FixtureRequest, stator_rack: Rack) -> dict[str, str]:
    """Where the links of ``stator_rack`` are in this test: "segment[0].link" -> "udp:127.0.0.1:41234"."""
    return cast("dict[str, str]", request.node.stash[_links_key])


def _write_table(rack: Rack, path: Path) -> None:
    """The last samples of all recorded signals as CSV: seconds first, then "name [unit]"."""
    recorded = list(rack.signals.values())
    times = recorded[0].times()[-_ROWS:]
    columns = [signal.numpy()[-len(times) :] for signal in recorded]
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["time [s]", *(f"{signal.name} [{signal.unit}]" for signal in recorded)])
        writer.writerows(zip(times, *columns, strict=True))


def _plot(rack: Rack, path: Path) -> bool:
    """Draws signals that have changed, those of one unit in one panel. False: matplotlib is missing."""
    try:
        from matplotlib.backends.backend_svg import FigureCanvasSVG
        from matplotlib.figure import Figure
    except ImportError:
        return False
    by_unit: dict[str, list[Any]] = {}
    for signal in rack.signals.values():
        values = signal.numpy()[-_ROWS:]
        if len(values) > 1 and values.min() != values.max():
            by_unit.setdefault(signal.unit, []).append(signal)
    if not by_unit:
        return True
    figure = Figure(figsize=(11, 2.2 * len(by_unit)), layout="constrained")
    FigureCanvasSVG(figure)
    panels = figure.subplots(len(by_unit), 1, sharex=True, squeeze=False)
    for (unit, signals), (panel,) in zip(by_unit.items(), panels, strict=True):
        for signal in signals[:12]:
            panel.plot(signal.times()[-_ROWS:], signal.numpy()[-_ROWS:], linewidth=1, label=signal.name)
        panel.set_ylabel(unit or "1")
        panel.legend(loc="center left", bbox_to_anchor=(1, 0.5), fontsize=7, frameon=False)
        panel.grid(alpha=0.3)
    panels[-1][0].set_xlabel("simulated time, s")
    cast(Any, figure).savefig(path)
    return True


def _keep_signals(rack: Rack, folder: Path) -> list[str]:
    """Writes what was recorded below ``folder``; returns lines for the report."""
    if not any(len(signal.times()) for signal in list(rack.signals.values())[:1]):
        return ["no signals were recorded"]
    table = folder / "signals.csv"
    _write_table(rack, table)
    lines = [f"signals: {table}"]
    plot = folder / "signals.svg"
    if not _plot(rack, plot):
        lines.append("no plot: matplotlib is missing; pip install stator[pytest] brings it")
    elif plot.exists():
        lines.append(f"plot:    {plot}")
    return lines


def _keep_recording(item: pytest.Item, rack: Rack) -> list[str]:
    """Ends the recording of a failed test's rack; returns lines for the report."""
    recording = item.stash.get(_recording_key, None)
    if recording is None:
        return []
    if not isinstance(recording, Path):
        return [f"no recording: {recording}"]
    lines: list[str] = []
    if not rack.closed:
        recording = rack.recording or recording
        try:
            rack.end_recording()
        except Error as error:
            lines.append(str(error))
    return [*lines, f"recording, to do it again: stator replay {shlex.quote(str(recording))}"]


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, Result[pytest.TestReport], None]:
    """Adds events and files of a failed test's rack to its report."""
    outcome = yield
    report = outcome.get_result()
    rack = item.stash.get(_rack_key, None)
    if call.when != "call" or not report.failed or rack is None:
        return
    item.stash[_failed_key] = True
    if rack.closed:
        lines = _keep_recording(item, rack)
        if lines:
            report.sections.append(("rack", "\n".join(lines)))
        return
    lines = [f"{rack.now:.6f} s of simulated time"]
    events = rack.events()[-_EVENTS:]
    lines += [f"{event.time:12.6f} s  {event.device}: {event.text}" for event in events] or ["no events"]
    lines += [f"fault {fault.id}: {fault.kind} at {fault.target}, {fault.state}" for fault in rack.faults()]
    folder = cast(Any, item).funcargs.get("tmp_path")
    if folder is not None:
        try:
            lines += _keep_signals(rack, folder)
        except Exception as error:  # noqa: BLE001  the test's own failure is what counts
            lines.append(f"signals were not kept: {error}")
    lines += _keep_recording(item, rack)
    report.sections.append(("rack", "\n".join(lines)))
