// Parameters of an XML device description (CiA 311 §7.3.3), which say of an entry what its object
// leaves out: type, access, default, value, limits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <unordered_map>

#include <pugixml.hpp>

#include "stator/canopen/eds/eds_objects.hpp"

namespace stator::formats {

/// All elements of a file that have a uniqueID. The tree must outlive it.
class XddParameters {
 public:
  explicit XddParameters(pugi::xml_node root);

  /// Adds what the parameter with this uniqueID says and the entry does not; false if there is
  /// none. Its texts get the entry's line.
  [[nodiscard]] bool complete(canopen::WrittenEntry& entry, std::string_view unique_id) const;

 private:
  [[nodiscard]] pugi::xml_node find(std::string_view unique_id) const;
  void add(canopen::WrittenEntry& entry, pugi::xml_node parameter) const;
  [[nodiscard]] std::optional<std::uint32_t> type_of(pugi::xml_node element) const;

  std::unordered_map<std::string_view, pugi::xml_node> elements_;
};

}  // namespace stator::formats
