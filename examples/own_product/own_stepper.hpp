// A stepper drive of a program's own on EtherCAT: its identity, configuration and firmware.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/drive/axis/error_report.hpp"
#include "stator/drive/stepper/stepper_axis.hpp"
#include "stator/plant/axes/stepper_axis.hpp"
#include "stator/plant/axes/stepper_axis_instruments.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/product/shell/ethercat_firmware.hpp"

namespace own_product {

inline constexpr std::string_view kType = "own-stepper";  ///< what a rack file's `type` names
inline constexpr std::uint32_t kVendorId = 0x0C0FFEE0;    ///< made up; the ETG assigns real ones
inline constexpr std::uint32_t kProductCode = 1, kRevision = 0x00010000;

/// What one drive is ordered with and what is connected to it.
struct OwnStepperConfiguration {
  double run_current = 3.0;                     ///< A, peak of a coil while the motor turns
  double standby_current = 1.5;                 ///< A, at rest
  stator::plant::StepperAxisParameters axis{};  ///< motor, load, supply, switches
  stator::product::CoeOptions coe{};
  stator::dictionary::Quirks quirks{};
};

/// A drive for one stepper motor on EtherCAT, with CoE and CiA 402: profile position, profile
/// velocity, homing, cyclic synchronous position and velocity. Positions are microsteps, 256 for
/// each full step; velocities microsteps per second. All of its work is done by parts of the rooms;
/// this class wires them.
class OwnStepper final : public stator::product::EtherCatFirmware {
 public:
  static constexpr stator::base::SimDuration kPlantStep{50'000};

  explicit OwnStepper(const OwnStepperConfiguration& configuration,
                      stator::base::EventReporter reporter = {});

  [[nodiscard]] std::vector<stator::product::Signal> signals() const override;
  [[nodiscard]] std::vector<stator::product::Input> inputs() override;

 private:
  using SimTime = stator::base::SimTime;

  void restart(SimTime now) override;
  void tick(SimTime now) override;
  void step_world(SimTime until) override;
  void apply(SimTime now) override;
  void network_operational(bool operational, SimTime now) override;
  void report_errors(SimTime now);

  [[nodiscard]] double position_actual() const {
    return static_cast<double>(axis_->actual_position());
  }

  OwnStepperConfiguration configuration_;
  stator::drive::ErrorReport error_report_;
  stator::plant::StepperAxis plant_;
  stator::plant::StepperAxisInstruments instruments_;
  std::optional<stator::drive::StepperAxis> axis_;  ///< made anew when the firmware starts
  SimTime now_;                                     ///< up to which the plant has come
};

/// To be added to a catalogue.
[[nodiscard]] std::shared_ptr<const stator::product::Product> own_stepper_product();

}  // namespace own_product
