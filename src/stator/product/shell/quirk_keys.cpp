#include "stator/product/shell/quirk_keys.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <set>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

namespace stator::product {

namespace {

using dictionary::QuirkDeclaration;
using dictionary::Quirks;

/// Whether devices on a network have a quirk.
using OnNetwork = bool QuirkDeclaration::*;

/// Of wrong-name: longer than a master's buffer may be.
constexpr std::size_t kUsualNameLength = 40;

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

void read_quirk_list(const settings::KeyWords& key, settings::Reader& reader, OnNetwork known,
                     Quirks& quirks) {
  std::set<std::string> names;
  for (const QuirkDeclaration& quirk : dictionary::quirks()) {
    if (quirk.*known) {
      names.emplace(quirk.name);
    }
  }
  for (const std::string& name : reader.choices(key, names).value_or(std::vector<std::string>{})) {
    switch_on(*std::ranges::find(dictionary::quirks(), name, &QuirkDeclaration::name), quirks);
  }
}

void read_quirk(settings::Reader& reader, const QuirkDeclaration& quirk, Quirks& quirks) {
  const settings::KeyWords key(quirk.name, quirk.summary);
  std::visit(
      [&](auto member) {
        using Value = std::remove_reference_t<decltype(quirks.*member)>;
        if constexpr (std::is_same_v<Value, bool>) {
          reader.boolean(key, quirks.*member);
        } else if constexpr (std::is_same_v<Value, std::string>) {
          reader.text(key, quirks.*member);
        } else if constexpr (std::is_same_v<Value, base::SimDuration>) {
          if (const auto value = reader.duration(key, base::SimDuration(quirk.minimum),
                                                 base::SimDuration(quirk.maximum))) {
            quirks.*member = *value;
          }
        } else if (const auto value = reader.integer(key, quirk.minimum, quirk.maximum)) {
          quirks.*member = static_cast<unsigned>(*value);
        }
      },
      quirk.member);
}

template <OnNetwork Known>
void read_quirks(const settings::KeyWords& key, settings::Reader& reader, Quirks& quirks) {
  const auto read_table = [&] {
    if (auto table = reader.section(key)) {
      for (const QuirkDeclaration& quirk : dictionary::quirks()) {
        if (quirk.*Known) {
          read_quirk(*table, quirk, quirks);
        }
      }
      table->finish();
    }
  };
  reader.either(
      reader.is_table(key.name), [&] { read_quirk_list(key, reader, Known, quirks); }, read_table);
}

template <OnNetwork Known>
constexpr std::array kQuirkRows{settings::custom<Quirks, read_quirks<Known>>(
    "quirks",
    "What the device does otherwise than it should: names, or a table of names with parameters")};

}  // namespace

constinit const settings::Section<Quirks> kCoeQuirkKeys{kQuirkRows<&QuirkDeclaration::coe>};
constinit const settings::Section<Quirks> kCanopenQuirkKeys{kQuirkRows<&QuirkDeclaration::canopen>};

}  // namespace stator::product
