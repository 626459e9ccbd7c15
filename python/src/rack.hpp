// A rack of the package and what is in it: stator._native.Rack, and those it hands out.
#pragma once

#include <nanobind/nanobind.h>

namespace stator::python {

/// Racks, their devices, objects, inputs, signals, events and faults.
void bind_racks(nanobind::module_& module);
/// Masters on a rack's networks: EtherCAT, CiA 402, CAN, TMCL.
void bind_masters(nanobind::module_& module);

}  // namespace stator::python
