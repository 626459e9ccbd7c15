#pragma once

#include "stator/product/catalogue/parts.hpp"
#include "stator/settings/key.hpp"

namespace stator::product {

/// What every drive with a CoE mailbox is told alike, whatever its product. "alias" is not among
/// them: it stands further up.
extern const settings::Section<CoeOptions> kCoeKeys;
/// The same of one that takes its firmware by FoE.
extern const settings::Section<CoeOptions> kFirmwareDownloadKeys;

}  // namespace stator::product
