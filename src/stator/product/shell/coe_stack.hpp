#pragma once

#include <cstddef>
#include <vector>

#include "stator/dictionary/dictionary.hpp"
#include "stator/dictionary/quirks.hpp"
#include "stator/ethercat/stack/slave_stack.hpp"
#include "stator/ethercat/standard/device_description.hpp"
#include "stator/product/catalogue/parts.hpp"

namespace stator::product {

/// What the keys of a device say to its slave stack. What the product itself decides is left as it
/// is: process memory, distributed clocks, files.
[[nodiscard]] ethercat::SlaveStackOptions coe_stack_options(const CoeOptions& coe,
                                                            const dictionary::Quirks& quirks);

/// What a controller's EEPROM holds when such a device leaves its box.
[[nodiscard]] std::vector<std::byte> coe_sii_image(const ethercat::DeviceDescription& description,
                                                   const dictionary::Dictionary& dictionary,
                                                   const CoeOptions& coe,
                                                   const dictionary::Quirks& quirks);

}  // namespace stator::product
