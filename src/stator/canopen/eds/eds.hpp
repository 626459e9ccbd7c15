#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "stator/dictionary/dictionary.hpp"

namespace stator::canopen {

/// What an electronic data sheet says of a product beside its objects (CiA 306-1 §4.3).
struct EdsDescription {
  std::string_view file_name{};  ///< "tmcc160.eds"
  std::string_view title{};      ///< what the file describes, in one line
  /// "08:00AM" and "08-29-2017": of the document the objects come from, so that the same product
  /// always gives the same file.
  std::string_view time = "12:00AM";
  std::string_view date{};
  std::string_view author = "Stator";

  std::string_view vendor_name{};
  std::string_view product_name{};
  std::string_view order_code{};
  /// The bit rates the device knows, kbit/s. CiA 306-1 has no key for others than 10, 20, 50, 125,
  /// 250, 500, 800 and 1000.
  std::span<const std::int64_t> bit_rates{};
  bool lss = false;            ///< it has an LSS slave
  bool dummy_mapping = false;  ///< RPDOs may map the data types 0001h to 0007h as gaps
  std::span<const std::string_view> comments{};  ///< lines for people
};

/// The electronic data sheet of a device with these objects: the text of its file, lines ended by
/// CR LF. Vendor, product and revision are those of 1018h. Names of objects are made unique by
/// adding the index, since many masters find objects by name.
[[nodiscard]] std::string eds_text(const dictionary::Dictionary& dictionary,
                                   const EdsDescription& description);

/// Adds 1021h and 1022h (CiA 301 §7.5.2.20 f.), by which a node hands out its EDS; call it before
/// Dictionary::finish(). The text comes from store_eds().
void add_eds_objects(dictionary::Dictionary& dictionary);
/// Sets 1021h. To be repeated after each Dictionary::reset_values(), which empties it.
void store_eds(dictionary::Dictionary& dictionary, std::string_view text);

}  // namespace stator::canopen
