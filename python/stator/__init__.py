"""Virtual motion-control devices: racks of drives and modules with motors that obey physics, and masters on their networks.

Begin with :class:`Rack`. Times are in simulated seconds, everything of the world is in SI units; what a drive counts is in
its own units. Equal programs give equal results, to the last bit, as long as simulated time is the rack's own (lockstep).
"""

from __future__ import annotations

from ._devices import CanOpenDevice, EtherCatDevice, Object, OwnDevice, Value, record
from ._errors import Error, MasterError, ObjectRefused, RackFileError, TimeLimitReached
from ._native import (
    Drive,
    Emergency,
    EtherCatMaster,
    Event,
    Fault,
    InputInfo,
    MappedEntry,
    ScenarioCurve,
    ScenarioReport,
    ScenarioStep,
    Signal,
    Slave,
    TmclReply,
    version,
)
from ._rack import Axis, Bus, Device, Inputs, Line, Objects, Rack, Segment, Signals, run_scenario

__version__: str = version

__all__ = [
    "Axis",
    "Bus",
    "CanOpenDevice",
    "Device",
    "Drive",
    "Emergency",
    "Error",
    "EtherCatDevice",
    "EtherCatMaster",
    "Event",
    "Fault",
    "InputInfo",
    "Inputs",
    "Line",
    "MappedEntry",
    "MasterError",
    "Object",
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
    "Slave",
    "TimeLimitReached",
    "TmclReply",
    "Value",
    "record",
    "run_scenario",
]
