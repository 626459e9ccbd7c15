// A CANopen device as a file describes it: EDS or DCF (CiA 306-1).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "stator/base/expected.hpp"
#include "stator/dictionary/import_report.hpp"
#include "stator/dictionary/owned_declarations.hpp"

namespace stator::canopen {

/// What an electronic data sheet or a device configuration file says.
struct EdsFile {
  std::string vendor_name;                ///< [DeviceInfo] VendorName
  std::string product_name;               ///< the same, ProductName
  std::string order_code;                 ///< the same, OrderCode
  std::uint32_t vendor = 0;               ///< VendorNumber, or the default of 1018h:01
  std::uint32_t code = 0;                 ///< ProductNumber, or the default of 1018h:02
  std::uint32_t revision = 0;             ///< RevisionNumber, or the default of 1018h:03
  std::vector<std::uint32_t> bit_rates;   ///< bit/s that it knows; empty: none said
  bool lss = false;                       ///< it has an LSS slave
  bool dummy_mapping = false;             ///< RPDOs may map the data types 0001h.. as gaps
  bool block_transfer = true;             ///< unless the file says that SDOs have none
  std::optional<std::uint8_t> node_id;    ///< of a DCF
  std::optional<std::uint32_t> bit_rate;  ///< bit/s, of a DCF
  dictionary::OwnedDeclarations objects;  ///< all that the file has
};

/// Reads an EDS or a DCF. What can be repaired is, and `report` says so; what was assumed or left
/// out as well. An error names line and rule. Names are UTF-8 afterwards, values the file's bytes.
[[nodiscard]] base::Expected<EdsFile, dictionary::ImportError> read_eds(
    std::string_view text, dictionary::ImportReport& report);

}  // namespace stator::canopen
