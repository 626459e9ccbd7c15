"""Signals and events as MCAP, read again with the package mcap."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import stator

pytest.importorskip("mcap")
from mcap.reader import make_reader  # noqa: E402

Messages = dict[str, list[tuple[int, dict[str, Any]]]]


def read(path: Path) -> tuple[Messages, dict[str, dict[str, Any]]]:
    """Messages with their times, and schemas, by topic."""
    messages: Messages = {}
    schemas = {}
    with path.open("rb") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            assert channel.message_encoding == "json"
            assert schema is not None and schema.encoding == "jsonschema"
            assert message.publish_time == message.log_time
            schemas[channel.topic] = json.loads(schema.data)
            messages.setdefault(channel.topic, []).append((message.log_time, json.loads(message.data)))
    return messages, schemas


def test_signals_have_their_values_times_and_units(stepper: stator.Rack, tmp_path: Path) -> None:
    stepper.go_operational()
    stepper.run(0.1)
    file = tmp_path / "run.mcap"
    stepper.export_mcap(file, signals=["*.axis0.shaft_*", "*.supply*"])
    messages, schemas = read(file)
    assert set(messages) <= {"tmcm-3315", "events"}
    speed = stepper["tmcm-3315"].axis[0]["shaft_speed"]
    rows = messages["tmcm-3315"]
    assert [time for time, _ in rows] == [round(time * 1e9) for time in speed.times()]
    assert [message["axis0"]["shaft_speed"] for _, message in rows] == list(speed.numpy())
    assert "rotor_position" not in rows[0][1]["axis0"]
    described = schemas["tmcm-3315"]["properties"]["axis0"]["properties"]["shaft_speed"]
    assert described["description"] == f"unit: {speed.unit}"


def test_events_are_lines_of_a_log(stepper: stator.Rack, tmp_path: Path) -> None:
    stepper.run(0.01)
    stepper.inject("motor-stall", device="tmcm-3315", axis=0, for_="5ms")
    stepper["tmcm-3315"].powered = False
    stepper.run(0.02)
    events = stepper.events()
    assert events
    file = tmp_path / "run.mcap"
    stepper.export_mcap(file)
    messages, schemas = read(file)
    assert schemas["events"]["title"] == "foxglove.Log"
    log = messages["events"]
    assert sorted(message["message"] for _, message in log) == sorted(event.text for event in events)
    for time, message in log:
        assert message["timestamp"]["sec"] * 1_000_000_000 + message["timestamp"]["nsec"] == time
        assert message["level"] in (2, 3, 4)


def test_what_is_not_there_is_refused(stepper: stator.Rack, tmp_path: Path) -> None:
    with pytest.raises(stator.Error, match="no-such"):
        stepper.export_mcap(tmp_path / "run.mcap", signals=["no-such.*"])
    with pytest.raises(stator.Error, match="cannot write"):
        stepper.export_mcap(tmp_path / "no-such-folder" / "run.mcap")
    with stator.Rack("tmcm-3315", signals=()) as rack, pytest.raises(stator.Error, match="records no signals"):
        rack.export_mcap(tmp_path / "run.mcap")


def convert(*tables: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "stator.mcap", *map(str, tables)], capture_output=True, text=True, check=False
    )


def test_a_table_of_signals_is_made_one(tmp_path: Path) -> None:
    table = tmp_path / "run.csv"
    table.write_text("time [s],x.axis0.shaft_speed [rad/s],can0.load [1]\n0.000000000,0,0.5\n0.001000000,1.5,inf\n")
    assert convert(table).returncode == 0
    messages, schemas = read(tmp_path / "run.mcap")
    assert messages == {
        "x": [(0, {"axis0": {"shaft_speed": 0.0}}), (1_000_000, {"axis0": {"shaft_speed": 1.5}})],
        "can0": [(0, {"load": 0.5}), (1_000_000, {"load": None})],
    }
    assert schemas["x"]["properties"]["axis0"]["properties"]["shaft_speed"]["description"] == "unit: rad/s"


def test_other_tables_are_refused(tmp_path: Path) -> None:
    table = tmp_path / "other.csv"
    table.write_text("time,value\n0,1\n")
    result = convert(table)
    assert result.returncode == 1
    assert "is no table of signals" in result.stderr
    table.write_text("time [s],x.load [1]\n0,1\n0.1\n")
    result = convert(table)
    assert result.returncode == 1
    assert "other.csv:3 is no row of 2 numbers" in result.stderr
    result = convert(tmp_path / "none.csv")
    assert result.returncode == 1
    assert "cannot read" in result.stderr
