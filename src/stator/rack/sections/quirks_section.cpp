#include "stator/rack/sections/quirks_section.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "stator/rack/world/text.hpp"

namespace stator::rack {

namespace {

using dictionary::QuirkDeclaration;
using dictionary::Quirks;

/// Of wrong-name: longer than a master's buffer may be.
constexpr std::size_t kUsualNameLength = 40;

bool belongs_to(const QuirkDeclaration& quirk, QuirkKind kind) {
  return kind == QuirkKind::coe ? quirk.coe : quirk.canopen;
}

/// Named without a parameter.
void switch_on(const QuirkDeclaration& quirk, Quirks& quirks) {
  std::visit(
      [&](auto member) {
        using Value = std::remove_reference_t<decltype(quirks.*member)>;
        if constexpr (std::is_same_v<Value, bool>) {
          quirks.*member = true;
        } else if constexpr (std::is_same_v<Value, std::string>) {
          quirks.*member = std::string(kUsualNameLength, 'X');
        } else if constexpr (std::is_same_v<Value, base::SimDuration>) {
          quirks.*member = base::SimDuration(quirk.usual);
        } else {
          quirks.*member = static_cast<unsigned>(quirk.usual);
        }
      },
      quirk.member);
}

void read_list(TomlSection& section, QuirkKind kind, Quirks& quirks) {
  std::set<std::string> names;
  for (const QuirkDeclaration& quirk : dictionary::quirks()) {
    if (belongs_to(quirk, kind)) {
      names.emplace(quirk.name);
    }
  }
  const TomlKey key(
      "quirks",
      "What the device does otherwise than it should: names, or a table of names with "
      "parameters",
      "");
  for (const std::string& name : section.choices(key, names).value_or(std::vector<std::string>{})) {
    const auto quirk = std::ranges::find(dictionary::quirks(), name, &QuirkDeclaration::name);
    switch_on(*quirk, quirks);
  }
}

void read_quirk(TomlSection& section, const QuirkDeclaration& quirk, Quirks& quirks) {
  const TomlKey key(std::string(quirk.name), std::string(quirk.summary), "");
  std::visit(
      [&](auto member) {
        using Value = std::remove_reference_t<decltype(quirks.*member)>;
        if constexpr (std::is_same_v<Value, bool>) {
          section.boolean(key, quirks.*member);
        } else if constexpr (std::is_same_v<Value, std::string>) {
          section.text(key, quirks.*member);
        } else if constexpr (std::is_same_v<Value, base::SimDuration>) {
          if (const auto value = section.duration(key, base::SimDuration(quirk.minimum),
                                                  base::SimDuration(quirk.maximum))) {
            quirks.*member = *value;
          }
        } else if (const auto value = section.integer(key, quirk.minimum, quirk.maximum)) {
          quirks.*member = static_cast<unsigned>(*value);
        }
      },
      quirk.member);
}

}  // namespace

void read_quirks(TomlSection& section, QuirkKind kind, dictionary::Quirks& quirks) {
  if (section.is_table("quirks")) {
    if (auto table = section.section("quirks")) {
      for (const QuirkDeclaration& quirk : dictionary::quirks()) {
        if (belongs_to(quirk, kind)) {
          read_quirk(*table, quirk, quirks);
        }
      }
      table->finish();
    }
  } else {
    read_list(section, kind, quirks);
  }
}

}  // namespace stator::rack
