#pragma once

#include "stator/product/catalogue/parts.hpp"
#include "stator/settings/key.hpp"

namespace stator::product {

/// What every drive with a CoE mailbox is told alike, whatever its product. "alias" is not among
/// them: it stands further up.
extern const settings::Section<CoeOptions> kCoeKeys;

}  // namespace stator::product
