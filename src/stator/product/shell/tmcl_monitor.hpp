#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/tmcl/sessions/module_interface.hpp"

namespace stator::product {

/// An axis parameter of TMCL and the object whose value it shows; index of axis 0.
struct ReadableParameter {
  std::uint8_t number;
  std::string_view name;
  std::uint16_t index;
  std::uint8_t subindex = 0;
  std::uint8_t first_bit = 0;
  std::uint8_t bits = 32;
};

/// A serial interface of an EtherCAT device: binary TMCL that reads values and moves nothing. It
/// knows GAP, GGP, GIO and the firmware version; what would move or change something is answered
/// with "command not available". The command that starts the boot loader is obeyed: through it
/// firmware is loaded, with drives and EtherCAT firmware at rest.
class TmclMonitor : public tmcl::ModuleInterface {
 protected:
  /// Where the objects of an axis lie: added to indices below 6000h, and to those above.
  struct IndexOffsets {
    std::uint16_t manufacturer = 0;
    std::uint16_t profile = 0;
  };

  /// `identity.line` names the interface in events. `parameters` and `dictionary` outlive the
  /// monitor. Throws std::logic_error if an object does not exist.
  TmclMonitor(const dictionary::Dictionary& dictionary,
              std::span<const ReadableParameter> parameters, std::span<const IndexOffsets> axes,
              const tmcl::ModuleIdentity& identity, const tmcl::BootMemory& memory,
              base::EventReporter reporter);

  /// GIO: the pins of the module.
  [[nodiscard]] virtual Answer get_input(const tmcl::Request& request) const = 0;

 private:
  [[nodiscard]] Answer execute(const tmcl::Request& request, base::SimTime now) final;
  [[nodiscard]] Answer get_axis_parameter(const tmcl::Request& request) const;
  [[nodiscard]] static Answer get_global_parameter(const tmcl::Request& request, base::SimTime now);

  base::StaticText line_;
  std::span<const ReadableParameter> parameters_;
  const dictionary::Dictionary& dictionary_;
  /// In the order of the parameters, for each axis.
  std::vector<std::vector<const dictionary::Entry*>> sources_;
};

}  // namespace stator::product
