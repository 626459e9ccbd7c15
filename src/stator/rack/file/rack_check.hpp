#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "stator/product/catalogue/catalogue.hpp"
#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/file/changes.hpp"
#include "stator/settings/problem.hpp"

namespace stator::rack {

/// What a look at a rack file has shown.
struct RackCheck {
  /// In the order of the file, those of other files behind. Some tables end at an error, hence
  /// further ones may show when these are gone.
  std::vector<settings::Problem> errors;
  std::optional<RackConfiguration> configuration;  ///< if there is no error
  /// What a run would warn of, sentences; of use if there is no error.
  std::vector<std::string> warnings;
};

/// Reads the rack file at `path`, of devices of `catalogue`, and everything it names - programs,
/// EEPROM images, configurations, the files of its state directory -, builds its devices, and tells
/// all that a run would refuse. Opens no interface, writes nothing and creates nothing. Files to be
/// written are checked for their directories only; whether interfaces and ports exist and are free
/// shows in a run.
/// `changes` are made to it before it is read.
[[nodiscard]] RackCheck check_rack_file(const std::string& path,
                                        const product::Catalogue& catalogue, Changes changes = {});

/// The same for a text that stands in no file yet: what it names is looked for as if it stood at
/// `path`.
[[nodiscard]] RackCheck check_rack_text(std::string_view text, const std::string& path,
                                        const product::Catalogue& catalogue, Changes changes = {});

}  // namespace stator::rack
