"""Scenarios: with a rack of their own, as `stator test` runs them, and on a rack that is there."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest

import stator

ROOT = Path(__file__).parents[2]
SCENARIOS = sorted((ROOT / "scenarios").glob("*.toml"))
#: A step as `stator test --verbose` prints it.
PRINTED = re.compile(r"^  (?P<status>passed|failed|not run) +(?P<begin>[\d.]+) s  (?P<rest>.*)$", re.MULTILINE)

MOVE = {
    "name": "A move",
    "summary": "One revolution",
    "product": "tmcm-3315",
    "plot": ["*.axis0.shaft_position"],
    "step": [
        {"do": "state", "state": "operational"},
        {"do": "move", "target": 51_200, "velocity": 102_400, "acceleration": 1_024_000, "note": "There"},
        {"do": "expect-object", "object": "6064:00", "equals": 51_200, "tolerance": 1},
    ],
}


def test_there_are_scenarios() -> None:
    assert len(SCENARIOS) >= 10


@pytest.mark.parametrize("file", SCENARIOS, ids=lambda file: file.stem)
def test_a_scenario_comes_to_what_the_program_says(file: Path) -> None:
    report = stator.run_scenario(file)
    program = subprocess.run(
        [os.environ["STATOR_PROGRAM"], "test", "--verbose", str(file)], capture_output=True, text=True, check=False
    )
    assert report.passed is (program.returncode == 0)
    assert program.stdout.startswith(f"{report.verdict:7} {report.name} ({report.end:.3f} s simulated")
    printed = [(match["status"], match["begin"], match["rest"].rstrip()) for match in PRINTED.finditer(program.stdout)]
    assert printed == [
        (
            step.status,
            f"{step.begin:.6f}",
            f"{step.kind}:{step.line}: {step.title}{'; ' if step.text else ''}{step.text}".rstrip(),
        )
        for step in report.steps
    ]


def test_a_table_is_a_scenario() -> None:
    report = stator.run_scenario(MOVE)
    report.require()
    assert report.passed and report.verdict == "passed"
    assert (report.name, report.summary, report.file) == ("A move", "One revolution", "")
    assert [step.kind for step in report.steps] == [step["do"] for step in MOVE["step"]]
    assert report.steps[1].title == "There"
    assert report.failed_step is None and report.failure == ""
    assert report.begin == 0.0
    assert report.end == report.steps[-1].end > 0.5
    assert any("Operational" in event.text for event in report.events)
    (curve,) = report.curves
    assert (curve.name, curve.unit) == ("tmcm-3315.axis0.shaft_position", "rev")
    assert len(curve.times) == len(curve.values) > 100
    assert curve.values[-1] == pytest.approx(1, abs=0.01)


def test_a_failure_reads_as_a_sentence() -> None:
    report = stator.run_scenario(MOVE, changes=["step[2].equals=7"])
    assert report.verdict == "failed" and not report.passed
    assert [step.status for step in report.steps] == ["passed"] * 2 + ["failed"]
    assert report.failed_step is not None
    assert "7" in report.failed_step.text and "51" in report.failed_step.text
    with pytest.raises(AssertionError) as raised:
        report.require()
    text = str(raised.value)
    assert text == report.failure
    assert text.startswith("A move: expect-object: ")
    assert report.failed_step.text in text
    assert report.events[-1].text in text


def test_steps_behind_a_failure_are_not_run() -> None:
    report = stator.run_scenario(MOVE, changes=["limit=100ms"])
    assert [step.status for step in report.steps].count("failed") == 1
    assert report.steps[-1].status == "not run"
    assert "limit of 100 ms" in report.failure


def test_a_scenario_runs_on_a_rack_that_is_there() -> None:
    with stator.Rack("tmcm-3315") as rack:
        rack.run(0.25)
        report = rack.run_scenario(MOVE)
        report.require()
        assert report.begin == pytest.approx(0.25)
        assert rack.now == report.end
        position = rack["tmcm-3315"].axis[0]["shaft_position"]
        assert position.value == pytest.approx(1, abs=0.01)
        assert len(position.times()) == pytest.approx(1000 * report.end, abs=2)
        again = rack.run_scenario(MOVE, changes=["limit=1ms"])
        assert "the scenario's limit of 1 ms" in again.failure
        with pytest.raises(stator.RackFileError, match="the rack is there already"):
            rack.run_scenario(MOVE, changes=["tmcm-3315.axis[0].supply_voltage=24"])


def test_what_a_scenario_says_of_a_rack_does_not_matter_to_one_that_is_there() -> None:
    file = ROOT / "scenarios" / "three-axes-move.toml"
    with stator.Rack(ROOT / "racks" / "gantry.toml") as rack:
        report = rack.run_scenario(file)
        assert [step.text for step in report.steps] == [step.text for step in stator.run_scenario(file).steps]
    with stator.Rack("tmcc160") as rack, pytest.raises(stator.RackFileError, match="no EtherCAT segment"):
        rack.run_scenario(file)


def test_the_limit_of_the_rack_ends_a_scenario_on_it() -> None:
    with stator.Rack("tmcm-3315", limit=0.3) as rack:
        assert "the rack's limit of 300 ms" in rack.run_scenario(MOVE).failure


def test_mistakes_name_file_line_and_remedy(tmp_path: Path) -> None:
    file = tmp_path / "wrong.toml"
    file.write_text('product = "tmcm-3315"\n[[step]]\ndo = "enabel"\n[[step]]\ndo = "state"\nstat = "init"\n')
    with pytest.raises(stator.RackFileError, match="enabel") as raised:
        stator.run_scenario(file)
    assert (raised.value.file, raised.value.line) == (str(file), 3)
    assert len(str(raised.value).splitlines()) >= 2
    with pytest.raises(stator.RackFileError, match="at least one"):
        stator.run_scenario({"product": "tmcm-3315"})
    with pytest.raises(stator.RackFileError, match="needs a rack file"):
        stator.run_scenario({"step": [{"do": "enable"}]})
    with pytest.raises(stator.RackFileError, match="missing.toml"):
        stator.run_scenario(tmp_path / "missing.toml")


def test_a_closed_rack_runs_no_scenario() -> None:
    rack = stator.Rack("tmcm-3315")
    rack.close()
    with pytest.raises(stator.Error, match="closed"):
        rack.run_scenario(MOVE)


def during_a_long_scenario(rack: stator.Rack, act: Callable[[], object]) -> None:
    """Runs a scenario that takes 500 simulated seconds, and does something in another thread when it is under way."""

    over = threading.Event()

    def wait_and_act() -> None:
        while not over.is_set() and rack.now < 0.5:
            time.sleep(0.001)
        act()

    thread = threading.Thread(target=wait_and_act)
    thread.start()
    try:
        rack.run_scenario({"limit": "3600s", "plot": ["*"], "step": [{"do": "wait", "time": "100ms"}] * 5000})
    finally:
        over.set()
        thread.join()


def test_a_rack_that_is_closed_meanwhile_ends_a_scenario() -> None:
    rack = stator.Rack("tmcm-3315", signals=())
    with pytest.raises(stator.Error, match="closed"):
        during_a_long_scenario(rack, rack.close)


def test_an_interruption_ends_a_scenario_and_the_rack_goes_on() -> None:
    with stator.Rack("tmcm-3315", signals=()) as rack:
        with pytest.raises(KeyboardInterrupt):
            during_a_long_scenario(rack, lambda: signal.raise_signal(signal.SIGINT))
        before = rack.now
        rack.run(0.1)
        assert rack.now == pytest.approx(before + 0.1)


def test_reports_for_people_and_for_ci() -> None:
    report = stator.run_scenario(MOVE)
    assert "<svg" in report.html() and "A move" in report.html()
    assert 'tests="3"' in report.junit() and 'failures="0"' in report.junit()
