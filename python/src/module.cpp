// The extension module stator._native, on which the package is built.
#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include "bindings.hpp"
#include "errors.hpp"
#include "stator/version.hpp"

NB_MODULE(_native, module) {
  // What threads of the user still hold when Python ends is no leak.
  nanobind::set_leak_warnings(false);
  module.doc() = "What the package stator is made of; use the package.";
  constexpr stator::Version kVersion = stator::kVersion;
  module.attr("version") =
      fmt::format("{}.{}.{}", kVersion.major_number, kVersion.minor_number, kVersion.patch_number);
  stator::python::bind_errors();
  stator::python::bind_signals(module);
  stator::python::bind_devices(module);
  stator::python::bind_racks(module);
  stator::python::bind_ethercat(module);
  stator::python::bind_drive(module);
  stator::python::bind_can(module);
  stator::python::bind_networks(module);
  stator::python::bind_own_devices(module);
  stator::python::bind_scenarios(module);
  stator::python::bind_experiments(module);
  stator::python::bind_tuning(module);
  stator::python::bind_environments(module);
}
