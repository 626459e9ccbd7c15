#include "stator/canopen/eds/eds_section_role.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>

#include "stator/base/spelling.hpp"
#include "stator/canopen/eds/eds_values.hpp"

namespace stator::canopen {

namespace {

using base::same_word;

constexpr std::array<std::string_view, 3> kLists{"MandatoryObjects", "OptionalObjects",
                                                 "ManufacturerObjects"};
// The standard has the first spelling, which is why files have both.
constexpr std::array<std::string_view, 2> kCommissioning{"DeviceComissioning",
                                                         "DeviceCommissioning"};
constexpr std::array<std::string_view, 5> kGeneral{"FileInfo", "DeviceInfo", "DummyUsage",
                                                   "Comments", "DynamicChannels"};
constexpr std::array<std::string_view, 2> kModuleLists{"SupportedModules", "ConnectedModules"};

bool is_one_of(std::string_view word, std::span<const std::string_view> words) {
  return std::ranges::any_of(words, [word](std::string_view w) { return same_word(w, word); });
}

/// Of "1018", "1018sub1", "1018Name" and the like; nothing if it is about no object.
std::optional<SectionRole> role_by_index(std::string_view name) {
  constexpr std::size_t kDigits = 4;
  static_cast<void>(take_beginning(name, "0x"));
  const std::optional<std::uint32_t> index = parse_hexadecimal(name.substr(0, kDigits));
  if (!index || name.size() < kDigits || name.find_first_of(" \txX") < kDigits) {
    return std::nullopt;
  }
  SectionRole role{SectionKind::object, static_cast<std::uint16_t>(*index), 0};
  std::string_view behind = trimmed(name.substr(kDigits));
  if (behind.empty()) {
    return role;
  }
  if (take_beginning(behind, "sub")) {
    const std::optional<std::uint32_t> subindex = parse_hexadecimal(behind);
    if (!subindex || *subindex > std::numeric_limits<std::uint8_t>::max()) {
      return std::nullopt;
    }
    role.kind = SectionKind::entry;
    role.subindex = static_cast<std::uint8_t>(*subindex);
  } else if (same_word(behind, "Name")) {
    role.kind = SectionKind::compact_names;
  } else if (same_word(behind, "Value")) {
    role.kind = SectionKind::compact_values;
  } else if (same_word(behind, "Denotation") || same_word(behind, "ObjectLinks")) {
    role.kind = SectionKind::about_object;
  } else {
    return std::nullopt;
  }
  return role;
}

/// "M1ModuleInfo", "M12Fixed6000sub1" and the like.
bool is_of_module(std::string_view name) {
  return take_beginning(name, "M") && !name.empty() && name.front() >= '0' && name.front() <= '9';
}

}  // namespace

SectionRole role_of(std::string_view name) {
  if (const std::optional<SectionRole> role = role_by_index(name)) {
    return *role;
  }
  if (is_one_of(name, kLists)) {
    return {SectionKind::list};
  }
  if (is_one_of(name, kCommissioning)) {
    return {SectionKind::commissioning};
  }
  if (is_of_module(name) || is_one_of(name, kModuleLists)) {
    return {SectionKind::module};
  }
  // [Tools], [Tool1]: programs that a configurator offers.
  std::string_view tool = name;
  if (is_one_of(name, kGeneral) || take_beginning(tool, "Tool")) {
    return {SectionKind::general};
  }
  return {};
}

bool take_beginning(std::string_view& text, std::string_view beginning) {
  if (text.size() < beginning.size() || !same_word(text.substr(0, beginning.size()), beginning)) {
    return false;
  }
  text.remove_prefix(beginning.size());
  return true;
}

}  // namespace stator::canopen
