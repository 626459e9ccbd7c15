#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "stator/board/peripheral/kept_content.hpp"
#include "stator/ethercat/controller/slave_controller.hpp"
#include "stator/ethercat/eoe/eoe.hpp"
#include "stator/ethercat/sii/sii_image.hpp"
#include "stator/ethercat/stack/slave_stack.hpp"
#include "stator/ethercat/standard/device_description.hpp"
#include "stator/product/device/device.hpp"
#include "stator/product/device/host_port.hpp"

namespace stator::board {
class Board;
struct BoardConfiguration;
}  // namespace stator::board

namespace stator::mfc {
class Block;
}

namespace stator::product {

/// The pins of an I/O block, with what is wired to them.
struct TracedPins {
  std::string_view name;  ///< of the chip, in files
  board::Board& board;
  const board::BoardConfiguration& wiring;
  const mfc::Block& block;
};

/// A complete EtherCAT product. Frames go through its slave controller (ethercat::Segment does
/// that). What becomes of the controller when the supply is switched is said to its segment
/// (ethercat::Segment::set_power), before set_power() when switched on.
class EtherCatDevice : public Device {
 public:
  [[nodiscard]] virtual ethercat::SlaveController& controller() = 0;
  [[nodiscard]] virtual const ethercat::SlaveController& controller() const = 0;
  [[nodiscard]] virtual const ethercat::DeviceDescription& description() const = 0;
  /// What masters are told of its objects by SII image and ESI file. Without CoE these are only the
  /// names of its process data.
  [[nodiscard]] virtual const dictionary::Dictionary& dictionary() const = 0;
  [[nodiscard]] virtual dictionary::Dictionary& dictionary() = 0;
  [[nodiscard]] const dictionary::Dictionary* object_dictionary() const final {
    return description().coe ? &dictionary() : nullptr;
  }
  [[nodiscard]] dictionary::Dictionary* object_dictionary() final {
    return description().coe ? &dictionary() : nullptr;
  }
  /// RUN and ERR as ETG.1300 has them, and a link/activity LED for each port.
  [[nodiscard]] Indicators indicators() const override;
  [[nodiscard]] NetworkStatus network_status() const override;

  /// The EEPROM's content as the device leaves its box.
  [[nodiscard]] virtual std::vector<std::byte> sii_image() const {
    return ethercat::build_sii_image(description(), dictionary());
  }
  /// The slave stack of its firmware; null if it has no firmware of its own.
  [[nodiscard]] virtual ethercat::SlaveStack* slave_stack() { return nullptr; }
  /// What a controller beside a chip is wired to; null for a device that has its own firmware.
  [[nodiscard]] virtual HostPort* host_port() { return nullptr; }

  /// The input that sets the deviation of the oscillator.
  static constexpr const char* kClockDeviation = "clock_deviation";
  /// What `stator inject` and timetables set: the oscillator runs fast by `ppb` from now on.
  void set_clock_deviation(double ppb) {
    controller().set_clock_deviation(static_cast<std::int32_t>(ppb));
  }

  /// Pins that a logic analyser can be put to; nothing: it has none.
  [[nodiscard]] virtual std::optional<TracedPins> traced_pins() { return std::nullopt; }

  /// What keeps content without supply among the parts that are wired to its pins.
  [[nodiscard]] virtual std::vector<board::KeptPart> kept_parts() { return {}; }

  /// Ethernet over EtherCAT, or null if the device has none or it is switched off.
  [[nodiscard]] virtual ethercat::EoeServer* eoe() { return nullptr; }

 protected:
  /// kClockDeviation, ppb: ten times what crystals for EtherCAT may be off, and more.
  [[nodiscard]] Input clock_deviation_input() {
    return {kClockDeviation,
            "ppb",
            -1e6,
            1e6,
            base::Delegate<void(double)>::bind<&EtherCatDevice::set_clock_deviation>(*this),
            InputGroup::network};
  }
};

}  // namespace stator::product
