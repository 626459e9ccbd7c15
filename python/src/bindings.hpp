// What the extension module is made of, each part in a source of its own.
#pragma once

#include <nanobind/nanobind.h>

namespace stator::python {

/// Racks, their events and faults.
void bind_racks(nanobind::module_& module);
/// Devices, their objects and inputs.
void bind_devices(nanobind::module_& module);
/// Signals over time.
void bind_signals(nanobind::module_& module);
/// The small EtherCAT master of a segment.
void bind_ethercat(nanobind::module_& module);
/// Axes of CiA 402 drives as a master sees them.
void bind_drive(nanobind::module_& module);
/// Places of programs on CAN buses.
void bind_can(nanobind::module_& module);
/// What a device's network carries, whichever it is.
void bind_networks(nanobind::module_& module);
/// How devices in Python reach what is theirs.
void bind_own_devices(nanobind::module_& module);
/// Scenarios and what they come to.
void bind_scenarios(nanobind::module_& module);
/// Experiments on a test bench.
void bind_experiments(nanobind::module_& module);
/// Finding gains of controllers by measurement.
void bind_tuning(nanobind::module_& module);
/// Axes that programs learn to control, on which stator.gymnasium is built.
void bind_environments(nanobind::module_& module);

}  // namespace stator::python
