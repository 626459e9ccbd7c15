#pragma once

#include "stator/ethercat/controller/controller_preset.hpp"

namespace stator::devices::tmc8461 {

/// The slave controller of the chip.
inline constexpr ethercat::ControllerPreset kController{
    "standard", "EtherCAT slave controller with multi-function I/O",
    ethercat::RegisterDocument::controller, [] {
      ethercat::SlaveControllerConfiguration chip;
      chip.product_id = 0x0000000001108461;
      chip.vendor_id = 0x0000000100000286;
      return chip;
    }()};

}  // namespace stator::devices::tmc8461
