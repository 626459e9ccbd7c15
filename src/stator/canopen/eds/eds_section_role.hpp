// What a section of an electronic data sheet is about, which its name says (CiA 306-1 §4).
#pragma once

#include <cstdint>
#include <string_view>

namespace stator::canopen {

enum class SectionKind : std::uint8_t {
  object,          ///< [1018]
  entry,           ///< [1018sub1]
  compact_names,   ///< [1018Name]
  compact_values,  ///< [1018Value]
  about_object,    ///< links and denotations of one, which a device does not show
  list,            ///< of objects
  commissioning,   ///< node-ID and bit rate of one device
  module,          ///< of a modular device
  general,         ///< others of the device or the file
  unknown,
};

/// What a section is about, and of which object or entry.
struct SectionRole {
  SectionKind kind = SectionKind::unknown;
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;

  [[nodiscard]] bool about_an_object() const { return kind <= SectionKind::about_object; }
};

/// The role of the section with this name. Letters' case does not count.
[[nodiscard]] SectionRole role_of(std::string_view name);

/// Takes `beginning` off, whatever the letters' case; false if the text does not begin with it.
[[nodiscard]] bool take_beginning(std::string_view& text, std::string_view beginning);

}  // namespace stator::canopen
