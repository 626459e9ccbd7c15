#pragma once

#include "stator/master/cia402/drive_port.hpp"
#include "stator/master/master.hpp"

namespace stator::master {

/// A drive on EtherCAT. An object that it maps into its process data is reached there while process
/// data run, every other one by SDO.
class SlaveDrivePort final : public DrivePort {
 public:
  /// `master` must outlive the port.
  SlaveDrivePort(Master& master, std::size_t position) : master_(master), position_(position) {}

  Result<std::uint64_t> read(ObjectAddress object, std::size_t size) override;
  Result<void> write(ObjectAddress object, std::size_t size, std::uint64_t bits) override;
  [[nodiscard]] bool cyclic(ObjectAddress object) const override;
  Result<void> run_cycle() override { return master_.run_cycle(); }
  [[nodiscard]] base::SimTime now() override { return master_.port().now(); }
  [[nodiscard]] std::string name() const override;

 private:
  Master& master_;
  std::size_t position_;
};

}  // namespace stator::master
