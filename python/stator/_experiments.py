"""Experiments on a test bench, and tuning by measurement."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal

from . import _native
from ._rack import Source


def simulate(
    experiment: str,
    rack: Source | None = None,
    *,
    device: str = "",
    axis: int = 0,
    motor: str = "",
    supply: float | None = None,
    inertia: float | None = None,
    viscous_friction: float | None = None,
    coulomb_friction: float | None = None,
    load_torque: float | None = None,
    changes: Sequence[str] = (),
    **options: float,
) -> _native.Simulation:
    """Measures a motor with its load on a test bench and compares it with equations, as ``stator simulate`` does.

    Args:
        experiment: which one, e.g. "pull-out"; :func:`experiments` has them all.
        rack: whose axis is put on the bench: path of a rack file, type of a product, or a mapping with the keys of a rack
            file. None: a motor with nothing around it.
        device: of the rack; else the first on the network that devices with such a motor are on.
        axis: of the device, from 0.
        motor: that takes the place of the axis' one, e.g. "QSH5718-55-30-098".
        supply: of the power stage, 0.1 .. 100 V.
        inertia: of the load, at the motor shaft, 0 .. 10 kg m2.
        viscous_friction: of the load, 0 .. 10 N m s/rad.
        coulomb_friction: dry friction of the load, 0 .. 1000 N m.
        load_torque: constant torque against forward motion, -1000 .. 1000 N m.
        changes: "PATH=VALUE" each, of the rack.
        options: of the experiment, in SI units, with ``_`` for ``-``; ``from`` is a word of Python's, write ``from_``.
            Times are in s, angles in rad, speeds in rad/s; ``experiments()`` has units, ranges and what they do.

    Returns:
        Comparisons with equations, and curves in the units that they name.

    Raises:
        Error: something is not known or out of range, or this cannot be measured on the axis; the text says which.
        RackFileError: the rack has a mistake.
    """
    quantities = {
        "supply": supply,
        "inertia": inertia,
        "viscous_friction": viscous_friction,
        "coulomb_friction": coulomb_friction,
        "load_torque": load_torque,
    }
    return _native.simulate(
        experiment,
        rack,
        device,
        axis,
        motor,
        {name: value for name, value in quantities.items() if value is not None},
        {name.rstrip("_"): value for name, value in options.items()},
        list(changes),
    )


def experiments() -> dict[str, _native.Experiment]:
    """All experiments of :func:`simulate` by name, with their options."""
    return {experiment.name: experiment for experiment in _native.experiments()}


def tune(
    rack: Source,
    *,
    device: str = "",
    motor: str = "",
    current: float | None = None,
    current_bandwidth: float | None = None,
    velocity_bandwidth: float | None = None,
    position_bandwidth: float | None = None,
    highest_speed: float | None = None,
    pole_pairs: int | None = None,
    encoder_resolution: int | None = None,
    encoder_direction: Literal["up", "down"] | None = None,
    changes: Sequence[str] = (),
    report: Callable[[str], object] | None = None,
) -> _native.TuningReport:
    """Measures the motor behind a TMC8670 and sets its controllers for wanted bandwidths, as ``stator tune`` does.

    What it knows of the motor is what the registers of the chip tell, as a tool at the hardware does: offsets, resistance,
    inductances, encoder, back-EMF, inertia, friction; then gains, then steps and sines that prove them.

    Args:
        rack: path of a rack file, "tmc8670" for one as delivered, or a mapping with the keys of a rack file.
        device: of the rack; else its first that can be tuned.
        motor: that takes the place of the axis' one, e.g. "EC45-flat-70W".
        current: amplitude of the tests and limit of the drive, 0.01 .. 1000 A; else the motor's rated one.
        current_bandwidth: wanted -3 dB of the current loop, 0.1 .. 50,000 Hz; else a 25th of the PWM frequency.
        velocity_bandwidth: of the velocity loop, Hz; else a 20th of the current loop's.
        position_bandwidth: of the position loop, Hz; else a 5th of the velocity loop's.
        highest_speed: the tests keep below it, 1 .. 10,000 rad/s.
        pole_pairs: of the motor, if they are known, 1 .. 64; it is an error if they are others.
        encoder_resolution: counts of the encoder per revolution, four per line, if they are known.
        encoder_direction: how the encoder counts while the field turns forward, if it is known.
        changes: "PATH=VALUE" each, of the rack.
        report: is told what is done, a line each.

    Returns:
        What was measured, gains, objects to set, steps and frequency responses. ``changes()`` of it are those of a rack:
        ``stator.Rack(file, changes=stator.tune(file).changes())``.

    Raises:
        Error: something is not known or out of range, or cannot be measured or reached; the text says what to do.
        RackFileError: the rack has a mistake.
    """
    wishes = _native.TuningWishes(
        current,
        current_bandwidth,
        velocity_bandwidth,
        position_bandwidth,
        highest_speed,
        pole_pairs,
        encoder_resolution,
        encoder_direction,
    )
    return _native.tune(rack, device, motor, wishes, list(changes), report)
