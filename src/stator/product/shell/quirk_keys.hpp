#pragma once

#include "stator/dictionary/quirks.hpp"
#include "stator/settings/key.hpp"

namespace stator::product {

/// The key "quirks" of a device, a list of names or a table of names with parameters
/// (docs/how-to/quirks.md), for the quirks of its network. A product has it on its own level:
/// settings::keys<kCoeQuirkKeys, &Configuration::quirks>().
extern const settings::Section<dictionary::Quirks> kCoeQuirkKeys;
extern const settings::Section<dictionary::Quirks> kCanopenQuirkKeys;

}  // namespace stator::product
