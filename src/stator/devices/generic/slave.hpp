// An EtherCAT device as a file describes it, with a mailbox: objects, process data, drives.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/devices/generic/drive.hpp"
#include "stator/devices/generic/object_inputs.hpp"
#include "stator/dictionary/quirks.hpp"
#include "stator/ethercat/standard/imported_slave.hpp"
#include "stator/plant/axes/pwm_axis.hpp"
#include "stator/product/catalogue/parts.hpp"
#include "stator/product/shell/ethercat_firmware.hpp"

namespace stator::devices::generic {

/// Axes that CiA 402-1 has room for.
inline constexpr unsigned kMostAxes = 8;

/// What a rack file says of such a device.
struct SlaveConfiguration {
  DriveUnits units;                            ///< of all its drives
  std::vector<plant::PwmAxisParameters> axes;  ///< of each drive it has
  product::CoeOptions coe;
  dictionary::Quirks quirks;
  std::uint32_t serial_number = 0;  ///< 1018h:04 and SII
};

/// A device with CoE of which only a file is known. Objects are stored, with range and access as
/// the file has them; those of CiA 402 move a motor (see Drive); those that are in its transmit
/// PDOs and are no drive's can be set as inputs, those in its receive PDOs are signals.
class Slave final : public product::EtherCatFirmware {
 public:
  /// `file` is complete (see complete()) and outlives the device. `report`, if not null, is told
  /// what is assumed. Throws std::logic_error for a file that no dictionary can be made of.
  Slave(const ethercat::ImportedSlave& file, const SlaveConfiguration& configuration,
        base::EventReporter reporter, dictionary::ImportReport* report = nullptr);

  [[nodiscard]] std::vector<product::Signal> signals() const override;
  [[nodiscard]] std::vector<product::Input> inputs() override;
  /// It has as many.
  [[nodiscard]] const std::deque<Drive>& drives() const { return drives_; }

 private:
  void before_inputs(base::SimTime now) override;
  void restart(base::SimTime now) override;
  void tick(base::SimTime now) override;
  void step_world(base::SimTime until) override;
  void apply(base::SimTime now) override;
  void at_sync0(base::SimTime now) override { run_drives(now); }
  void network_operational(bool operational, base::SimTime now) override;

  void run_drives(base::SimTime now);
  void report_errors(base::SimTime now);

  std::deque<Drive> drives_;
  ObjectInputs inputs_;
};

/// Of a file: axes 0 to n - 1 that are drives.
[[nodiscard]] unsigned count_drives(const ethercat::ImportedSlave& file);

}  // namespace stator::devices::generic
