#pragma once

#include "stator/ethercat/controller/controller_preset.hpp"

namespace stator::devices::tmcm_3315 {

/// The slave controller of the module. Its manual describes none; it has all that one can have.
inline constexpr ethercat::ControllerPreset kController{
    "standard", "the module's controller, with the registers of a TMC8461",
    ethercat::RegisterDocument::controller, ethercat::SlaveControllerConfiguration{}};

}  // namespace stator::devices::tmcm_3315
