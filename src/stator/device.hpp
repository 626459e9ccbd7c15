#pragma once

/// @file
/// EtherCAT devices of one's own: a class derived from stator::product::EtherCatFirmware, objects
/// declared as stator::dictionary::EntryDeclaration, keys of a rack file (stator/settings.hpp), and
/// stator::product::make(), whose product a stator::product::Catalogue takes.

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/dictionary/declaration.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/product/catalogue/catalogue.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/product/shell/coe_keys.hpp"
#include "stator/product/shell/ethercat_firmware.hpp"
#include "stator/product/shell/quirk_keys.hpp"
#include "stator/settings.hpp"
