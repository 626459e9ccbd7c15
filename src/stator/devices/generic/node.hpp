// A CANopen device as a file describes it: objects, PDOs, drives.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/canopen/eds/eds_file.hpp"
#include "stator/devices/generic/drive.hpp"
#include "stator/devices/generic/object_inputs.hpp"
#include "stator/dictionary/import_report.hpp"
#include "stator/dictionary/quirks.hpp"
#include "stator/plant/axes/pwm_axis.hpp"
#include "stator/product/shell/canopen_firmware.hpp"

namespace stator::devices::generic {

/// What a rack file says of such a device.
struct NodeConfiguration {
  std::uint8_t node_id = 1;
  std::uint32_t bit_rate = 1'000'000;          ///< bit/s
  DriveUnits units;                            ///< of all its drives
  std::vector<plant::PwmAxisParameters> axes;  ///< of each drive it has
  dictionary::Quirks quirks;
  std::uint32_t serial_number = 0;  ///< 1018h:04
};

/// Adds what a node here cannot be without (CiA 301 §7.5.2): 1000h, 1001h, 1005h, 1014h, 1017h,
/// 1018h. `report` says each.
void complete(canopen::EdsFile& file, dictionary::ImportReport& report);

/// A device of which only its data sheet is known. See Slave for what is behind its objects.
class Node final : public product::CanOpenFirmware {
 public:
  /// `file` is complete and outlives the device. `report`, if not null, is told what is assumed.
  /// Throws std::logic_error for a file that no dictionary can be made of.
  Node(const canopen::EdsFile& file, const NodeConfiguration& configuration,
       base::EventReporter reporter, dictionary::ImportReport* report = nullptr);

  [[nodiscard]] std::string_view eds() const override { return eds_; }
  [[nodiscard]] std::vector<product::Signal> signals() const override;
  [[nodiscard]] std::vector<product::Input> inputs() override;
  /// It has as many.
  [[nodiscard]] const std::deque<Drive>& drives() const { return drives_; }

 private:
  void restart(base::SimTime now) override;
  void tick(base::SimTime now) override;
  void step_world(base::SimTime until) override;
  void apply(base::SimTime now) override;
  void state_changed(canopen::NmtState state, base::SimTime now) override;

  void report_errors(base::SimTime now);

  std::string eds_;
  std::deque<Drive> drives_;
  ObjectInputs inputs_;
};

}  // namespace stator::devices::generic
