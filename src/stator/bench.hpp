#pragma once

/// @file
/// A rack in this process with a master on each of its networks, in simulated time: what scenarios
/// (`stator test`) are run by. Begin with stator::bench::load and stator::bench::Bench; drives of
/// CiA 402 are moved by stator::master::Cia402Client.

#include <string>

#include "stator/base/sim_time.hpp"
#include "stator/bench/bench.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/master/cia402/cia402_client.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/file/rack_file_error.hpp"
#include "stator/settings/value.hpp"

namespace stator::bench {

/// The rack that a file describes, of the products that are there (devices::products()). Throws
/// rack::RackFileError, a std::runtime_error with file, line, reason and remedy.
[[nodiscard]] inline rack::RackConfiguration load(const std::string& path) {
  return load(path, devices::products());
}

/// The same of a table with the keys of such a file.
[[nodiscard]] inline rack::RackConfiguration load(const settings::Table& table) {
  return load(table, devices::products());
}

}  // namespace stator::bench
