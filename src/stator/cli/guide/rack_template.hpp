#pragma once

#include <string>
#include <vector>

#include "stator/product/catalogue/catalogue.hpp"

namespace stator::cli {

/// A device of a rack file that is to be written.
struct NewDevice {
  std::string type;
  std::string name{};   ///< empty: its type, with a number if there are several
  std::string motor{};  ///< of all its axes; empty: the one a rack file has without the key
};

/// What is known of a rack before there is a file.
struct NewRack {
  std::vector<NewDevice> devices;
  std::string link{};                 ///< of the segment; empty: it is given with the run
  std::vector<std::string> ports{};   ///< of the bus
  std::vector<std::string> serial{};  ///< [INTERFACE=]LINE, of the first device with it
};

/// The rack file in TOML: what is known as keys, everything else as comments with defaults and
/// meaning, from the declarations of the keys. Throws std::runtime_error for a product or motor
/// that does not exist, naming the nearest.
[[nodiscard]] std::string rack_file_text(const NewRack& rack, const product::Catalogue& catalogue);

/// The motors that a product's axes can have; empty if it has no axes of its own.
[[nodiscard]] std::vector<std::string> motors_of(const std::string& type,
                                                 const product::Catalogue& catalogue);

}  // namespace stator::cli
