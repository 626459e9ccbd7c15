"""Virtual motion-control devices: racks of drives and modules with motors that obey physics, and masters on their networks.

Begin with :class:`Rack`. Times are in simulated seconds, everything of the world is in SI units; what a drive counts is in
its own units. Equal programs give equal results, to the last bit, as long as simulated time is the rack's own (lockstep).
"""

from __future__ import annotations

from ._devices import CanOpenDevice, EtherCatDevice, Object, OwnDevice, Value, record
from ._errors import Error, MasterError, ObjectRefused, RackFileError, TimeLimitReached
from ._experiments import experiments, simulate, tune
from ._native import (
    Comparison,
    Drive,
    Emergency,
    EtherCatMaster,
    Event,
    Experiment,
    ExperimentCurve,
    ExperimentOption,
    ExperimentPanel,
    Fault,
    FrequencyResponse,
    Gain,
    InputInfo,
    MappedEntry,
    Measured,
    Moment,
    ScenarioCurve,
    ScenarioReport,
    ScenarioStep,
    Signal,
    Simulation,
    Slave,
    StepResponse,
    TmclReply,
    TunedObject,
    TuningReport,
    version,
)
from ._rack import Axis, Bus, Device, Inputs, Line, Objects, Rack, Segment, Signals, run_scenario

__version__: str = version

__all__ = [
    "Axis",
    "Bus",
    "CanOpenDevice",
    "Comparison",
    "Device",
    "Drive",
    "Emergency",
    "Error",
    "EtherCatDevice",
    "EtherCatMaster",
    "Event",
    "Experiment",
    "ExperimentCurve",
    "ExperimentOption",
    "ExperimentPanel",
    "Fault",
    "FrequencyResponse",
    "Gain",
    "InputInfo",
    "Inputs",
    "Line",
    "MappedEntry",
    "MasterError",
    "Object",
    "Measured",
    "Moment",
    "ObjectRefused",
    "Objects",
    "OwnDevice",
    "Rack",
    "RackFileError",
    "ScenarioCurve",
    "ScenarioReport",
    "ScenarioStep",
    "Segment",
    "Signal",
    "Signals",
    "Simulation",
    "Slave",
    "StepResponse",
    "TimeLimitReached",
    "TmclReply",
    "Value",
    "record",
    "TunedObject",
    "TuningReport",
    "experiments",
    "run_scenario",
    "simulate",
    "tune",
]
