// Products that a file describes.
#pragma once

#include <memory>
#include <string>

#include "stator/canopen/eds/eds_file.hpp"
#include "stator/dictionary/import_report.hpp"
#include "stator/ethercat/standard/imported_slave.hpp"
#include "stator/product/catalogue/product.hpp"

namespace stator::devices {

/// A product of type `type` as an ESI file or an SII image describes it: with a mailbox a
/// generic::Slave, without one a generic::Terminal. Completes `file`; `report` is told what is
/// known, assumed, repaired and left out. Throws std::runtime_error, with the reason, where no
/// device can be made of it.
[[nodiscard]] std::shared_ptr<const product::Product> imported_product(
    std::string type, ethercat::ImportedSlave file, dictionary::ImportReport& report);

/// The same of an EDS or a DCF: a generic::Node.
[[nodiscard]] std::shared_ptr<const product::Product> imported_product(
    std::string type, canopen::EdsFile file, dictionary::ImportReport& report);

}  // namespace stator::devices
