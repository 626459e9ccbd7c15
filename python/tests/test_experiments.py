"""Experiments on a test bench and tuning: what the commands of the program measure, as objects."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import numpy
import pytest

import stator

ROOT = Path(__file__).parents[2]
SERVO = ROOT / "racks" / "ethercat-servo.toml"


def program(*arguments: object) -> str:
    """What the program prints."""
    command = [os.environ["STATOR_PROGRAM"], *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def significant(value: float, digits: int = 5) -> str:
    """As the program prints it."""
    return f"{value:.{digits}g}"


def test_all_experiments_are_described() -> None:
    all_of_them = stator.experiments()
    assert {"pull-out", "move", "resonance", "velocity-step"} <= all_of_them.keys()
    for name, experiment in all_of_them.items():
        assert experiment.name == name and experiment.summary
        assert experiment.motor in ("stepper", "three-phase")
        for option in experiment.options:
            assert option.name.replace("_", "").isalnum() and option.help
            assert option.minimum < option.maximum
            assert option.unit not in ("rpm", "rev", "rev/s", "ms", "us")
            assert option.preset is None or option.minimum <= option.preset <= option.maximum
    (speed,) = (option for option in all_of_them["coast-down"].options if option.name == "initial_speed")
    assert speed.unit == "rad/s"


@pytest.mark.parametrize("name", sorted(stator.experiments()))
def test_an_experiment_measures_what_the_program_does(name: str) -> None:
    simulation = stator.simulate(name)
    printed = program("simulate", name)
    assert printed.startswith(simulation.title + "\n")
    for remark in simulation.remarks:
        assert remark in printed
    rows = {" ".join(line.split()) for line in printed.splitlines()}
    assert simulation.comparisons
    for row in simulation.comparisons:
        mark = "" if row.judged else "*"
        text = (
            f"{row.quantity} {significant(row.measured)} {significant(row.equation)} "
            f"{100 * row.deviation:+.2f}%{mark} {row.unit}"
        )
        assert " ".join(text.split()) in rows
    worst = max(abs(row.deviation) for row in simulation.comparisons if row.judged)
    assert simulation.worst_deviation == worst
    assert simulation.panels
    for panel in simulation.panels:
        assert panel.curves and panel.name and panel.x_name
        for curve in panel.curves:
            assert len(curve.values) == len(panel.x) > 0
            assert curve.style in ("line", "points", "equation")


def test_what_is_around_the_axis_is_in_si_units() -> None:
    simulation = stator.simulate("coast-down", inertia=5e-5, viscous_friction=2e-4, initial_speed=10 * 2 * numpy.pi)
    printed = program(
        "simulate", "coast-down", "--inertia", "5e-5", "--viscous-friction", "2e-4", "--initial-speed", "10rev/s"
    )
    for row in simulation.comparisons:
        assert significant(row.measured) in printed
    other = stator.simulate("coast-down", inertia=5e-5, viscous_friction=2e-4, initial_speed=5 * 2 * numpy.pi)
    assert other.comparisons[-1].measured < simulation.comparisons[-1].measured


def test_a_load_counts_against_forward_motion() -> None:
    def coasting_time(load: float) -> float:
        simulation = stator.simulate("coast-down", load_torque=load, coulomb_friction=0.02, inertia=1e-4)
        (row,) = (row for row in simulation.comparisons if row.unit == "s")
        return row.measured

    assert coasting_time(0.01) < coasting_time(0.0) < coasting_time(-0.01)


def test_an_axis_comes_from_a_rack() -> None:
    rack = {
        "segment": [
            {"device": [{"type": "tmcm-3315", "name": "x", "axis": [{}, {"motor": "QSH5718-79-30-163"}]}]},
        ]
    }
    simulation = stator.simulate("resonance", rack, axis=1)
    other = stator.simulate("resonance", rack, axis=0)
    assert other.comparisons[0].measured != simulation.comparisons[0].measured
    named = stator.simulate("resonance", rack, device="x", motor="QSH5718-79-30-163")
    assert [row.measured for row in named.comparisons] == [row.measured for row in simulation.comparisons]
    changed = stator.simulate("resonance", rack, axis=1, changes=["x.axis[1].load.inertia=1e-3"])
    assert changed.comparisons[0].measured < simulation.comparisons[0].measured


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"experiment": "pull-off"}, "there is no experiment pull-off; there are: free-acceleration"),
        ({"experiment": "coast-down", "initial_sped": 1.0}, 'did you mean "initial_speed"'),
        ({"experiment": "coast-down", "initial_speed": 1e9}, "initial_speed is 1e\\+09 rad/s; it must lie in"),
        ({"experiment": "coast-down", "initial_speed": float("nan")}, "initial_speed is nan"),
        ({"experiment": "coast-down", "supply": 1000.0}, "supply is 1000 V; it must lie in 0.1 .. 100"),
        ({"experiment": "coast-down", "motor": "QSH5718-79-30-164"}, 'did you mean "QSH5718-79-30-163"'),
        ({"experiment": "coast-down", "rack": "tmcm-3315", "device": "y"}, 'tmcm-3315 has no device "y"'),
        ({"experiment": "coast-down", "rack": "tmcm-3315", "axis": 7}, "tmcm-3315 has no axis 7 with a stepper motor"),
        ({"experiment": "back-emf", "rack": "tmcm-3315"}, "has no axis 0 with a three-phase motor"),
    ],
)
def test_what_cannot_be_measured_is_told_in_pythons_terms(arguments: dict, text: str) -> None:
    with pytest.raises(stator.Error, match=text):
        stator.simulate(**arguments)


def test_a_tolerance_is_required_with_a_sentence_for_what_breaks_it() -> None:
    simulation = stator.simulate("resonance")
    simulation.require(simulation.worst_deviation)
    with pytest.raises(AssertionError, match="measured .* equation .* deviation") as raised:
        simulation.require(0.0)
    judged = [row for row in simulation.comparisons if row.judged and row.deviation != 0]
    assert len(str(raised.value).splitlines()) == 1 + len(judged)


@pytest.fixture(scope="module")
def tuned() -> stator.TuningReport:
    """The servo of the rack file, tuned once for all tests."""
    return stator.tune(SERVO)


def test_tuning_finds_what_the_program_finds(tuned: stator.TuningReport, tmp_path: Path) -> None:
    output = tmp_path / "tuned.toml"
    printed = program("tune", SERVO, "--output", output)
    for name, measured, factor in [
        ("phase resistance", tuned.resistance, 1e3),
        ("inductance Ld", tuned.direct_inductance, 1e6),
        ("inductance Lq", tuned.quadrature_inductance, 1e6),
        ("flux linkage", tuned.flux_linkage, 1e3),
        ("inertia", tuned.inertia, 1e7),
        ("dry friction", tuned.dry_friction, 1e3),
        ("viscous friction", tuned.viscous_friction, 1e6),
    ]:
        (line,) = (line for line in printed.splitlines() if line.startswith(name + " "))
        assert significant(factor * measured.value) in line.split()
        assert float(measured) == measured.value
        assert 0 <= measured.deviation < abs(measured.value)
    # The objects are those of the rack file that the program writes.
    written = output.read_text()
    assert len(tuned.objects) > 10
    for tuned_object in tuned.objects:
        key = f"{tuned_object.index:04X}"
        assert (
            f'"{key}:{tuned_object.subindex:02X}" = {tuned_object.value}' in written
            or f'"{key}" = {tuned_object.value}' in written
        )
        assert tuned_object.meaning


def test_the_loops_are_proved(tuned: stator.TuningReport) -> None:
    assert tuned.steps.keys() == {"current", "velocity", "position"}
    assert {name: step.unit for name, step in tuned.steps.items()} == {
        "current": "A",
        "velocity": "rad/s",
        "position": "rad",
    }
    for step in tuned.steps.values():
        assert len(step.time) == len(step.actual) == len(step.model) >= 100
        assert step.actual[-1] == pytest.approx(step.height, rel=0.2)
        assert 0 < step.rise_time < step.time[-1]
        reached = step.actual.max() / step.height - 1
        assert reached == pytest.approx(max(step.overshoot, reached), abs=0.05)
    for response in tuned.responses.values():
        assert response.frequency.dtype == numpy.float64 and response.measured.dtype == numpy.complex128
        assert numpy.all(numpy.diff(response.frequency) > 0)
        assert len(response.measured) == len(response.model) == len(response.frequency)
        assert response.bandwidth == pytest.approx(response.wanted, rel=0.3)
        assert response.phase_margin > 30
        # At the bandwidth the gain has fallen by 3 dB.
        gain = numpy.interp(response.bandwidth, response.frequency, abs(response.measured))
        assert gain == pytest.approx(1 / numpy.sqrt(2), abs=0.1)
    assert {"P torque", "I torque"} <= {gain.name for gain in tuned.gains}


def test_what_was_found_sets_a_rack(tuned: stator.TuningReport) -> None:
    with stator.Rack(SERVO, changes=tuned.changes()) as rack:
        objects = rack[tuned.device].objects
        for tuned_object in tuned.objects:
            assert objects[tuned_object.index, tuned_object.subindex] == tuned_object.value
        rack.go_operational()
        drive = rack[tuned.device].axis[0].drive()
        drive.enable()
        drive.set_mode("profile-position")
        drive.start_move(65_536)
        drive.wait_for_target(5)
        assert drive.position == pytest.approx(65_536, abs=200)


def test_what_is_done_is_told() -> None:
    told: list[str] = []
    with pytest.raises(stator.Error, match="pole pairs"):
        stator.tune("tmc8670", pole_pairs=7, report=told.append)
    assert told[0].startswith("Current offsets")
    assert any(line.startswith("Encoder") for line in told)


def test_what_is_told_may_end_it() -> None:
    def stop(_: str) -> None:
        raise KeyError("enough")

    with pytest.raises(KeyError, match="enough"):
        stator.tune("tmc8670", report=stop)


def test_another_motor_is_part_of_the_changes() -> None:
    report = stator.tune("tmc8670", motor="EC45-flat-70W", velocity_bandwidth=30)
    assert report.responses["velocity"].wanted == 30
    changes = report.changes()
    assert changes[0] == '"tmc8670".axis.motor="EC45-flat-70W"'
    with stator.Rack("tmc8670", changes=changes) as rack:
        assert rack["tmc8670"].objects[report.objects[0].index, report.objects[0].subindex] == report.objects[0].value


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"rack": "tmcm-3315"}, "tmcm-3315 has no tmc8670, the one product that can be tuned"),
        ({"rack": SERVO, "device": "x"}, 'has no tmc8670 called "x"; it has: servo'),
        ({"rack": "tmc8670", "motor": "M"}, 'motor "M" is not known'),
        ({"rack": "tmc8670", "current": -1}, "current is -1 A; it must lie in 0.01 .. 1000"),
        ({"rack": "tmc8670", "encoder_direction": "left"}, "it must be one of: down, up"),
        ({"rack": "tmc8670", "current_bandwidth": 1e5}, "current_bandwidth is 100000 Hz"),
    ],
)
def test_what_cannot_be_tuned_is_told(arguments: dict, text: str) -> None:
    with pytest.raises(stator.Error, match=text):
        stator.tune(**arguments)
