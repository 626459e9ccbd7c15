// Products of files that people have: by the type "esi:FILE#DEVICE" in a rack file, or by a
// command.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "stator/base/expected.hpp"
#include "stator/dictionary/import_report.hpp"
#include "stator/product/catalogue/catalogue.hpp"
#include "stator/product/catalogue/product.hpp"

namespace stator::imports {

/// What a file turned out to be.
enum class FileKind : std::uint8_t {
  esi,  ///< EtherCAT slave information (ETG.2000)
  sii,  ///< image of an EtherCAT slave's EEPROM (ETG.2010)
  eds,  ///< electronic data sheet or device configuration of CANopen (CiA 306-1)
  xdd,  ///< the same in XML (CiA 311)
};

/// The word that stands before the colon of a type: "esi", "sii", "eds" or "xdd".
[[nodiscard]] std::string_view to_text(FileKind kind);

/// What a file is, by its content; nothing: it is none of them.
[[nodiscard]] std::optional<FileKind> kind_of(std::string_view content);

/// A product and what became of its file.
struct ImportedProduct {
  std::shared_ptr<const product::Product> product;
  dictionary::ImportReport report;
};

/// Makes the product that `type` names: a kind, a colon, the path of a file, and if it has several
/// devices # and which (formats::EsiChoice), with + before each module for a slot.
[[nodiscard]] base::Expected<ImportedProduct, dictionary::ImportError> import_product(
    std::string_view type);

/// Has `catalogue` make such products. A file is read once, until it changes.
void add_resolvers(product::Catalogue& catalogue);

}  // namespace stator::imports
