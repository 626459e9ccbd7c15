#pragma once

#include <filesystem>
#include <memory>

#include "stator/manual/manual_control.hpp"
#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/run/runner.hpp"

namespace stator::cli {

/// Writes the rack that `stator demo --http` runs, and the files it names, below `directory`.
/// Returns the path of the rack file. Throws Failure if that cannot be done.
[[nodiscard]] std::filesystem::path write_show_rack(const std::filesystem::path& directory);

/// Has the devices of that rack do something worth seeing, by manual control, until it ends: two
/// axes draw a star while a third moves up and down, a servo turns against steps of its load, a
/// drive on CAN turns to and fro, an I/O board drives a fan and a lamp. It leaves alone for good
/// what another master or a person has taken.
class Show {
 public:
  /// All must outlive it. `rack_file` is where write_show_rack() has put the rack.
  Show(manual::ManualControl& control, rack::Runner& runner,
       const rack::RackConfiguration& configuration, const std::filesystem::path& rack_file);
  ~Show();
  Show(const Show&) = delete;
  Show& operator=(const Show&) = delete;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace stator::cli
