#pragma once

#include <string>
#include <utility>

#include "stator/cli/failure.hpp"
#include "stator/cli/master/bus.hpp"
#include "stator/master/master.hpp"

namespace stator::cli {

/// The value of a master's answer; its error becomes the command's Failure.
template <typename T>
T require(master::Result<T> result) {
  if (!result) {
    throw Failure(result.error().text);
  }
  if constexpr (!std::is_void_v<T>) {
    return std::move(*result);
  }
}

/// A bus and a master that has scanned it: what every master command starts with.
class MasterSession {
 public:
  /// Opens the bus and scans it. Throws Failure.
  explicit MasterSession(const BusOptions& options)
      : bus_(options), master_(bus_.port(), master_options_of(options)) {
    require(master_.scan());
  }

  [[nodiscard]] Bus& bus() { return bus_; }
  [[nodiscard]] master::Master& master() { return master_; }
  /// Closes what was written meanwhile. Throws Failure with what is missing.
  void end() { bus_.end_files(); }

 private:
  Bus bus_;
  master::Master master_;
};

}  // namespace stator::cli
