// Axes that programs learn to control: stator._native.AxisEnvironments, on which stator.gymnasium
// is built.
#pragma once

#include <nanobind/nanobind.h>

namespace stator::python {

/// Binds AxisEnvironments.
void bind_environments(nanobind::module_& module);

}  // namespace stator::python
