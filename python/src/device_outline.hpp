// What a class of Python says of the devices that are made of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <vector>

#include <nanobind/nanobind.h>

#include "stator/base/sim_time.hpp"
#include "stator/dictionary/declaration.hpp"
#include "stator/product/catalogue/product.hpp"

namespace stator::python {

/// What a class of Python says of its devices. Constant: devices refer to it.
struct Outline {
  std::string type;
  std::string name;
  product::NetworkKind network = product::NetworkKind::segment;
  std::uint32_t vendor = 0;
  std::uint32_t code = 0;
  std::uint32_t revision = 1;
  std::uint32_t bit_rate = 1'000'000;
  base::SimDuration period{1'000'000};
  std::deque<std::string> texts;  ///< that declarations refer to
  std::vector<dictionary::EntryDeclaration> objects;
  // Which of its functions the class has made its own; others need not be called.
  bool starts = false;
  bool checks = false;
  bool writes = false;
  bool reads = false;
};

/// What `factory`, a class derived from stator.OwnDevice or a function with its attributes, says.
/// Throws std::runtime_error for one that lacks or contradicts something.
[[nodiscard]] Outline read_outline(nanobind::handle factory);

/// The bits that an entry of that type keeps for what an SDO carries.
[[nodiscard]] std::uint64_t bits_of(dictionary::DataType type, std::span<const std::byte> bytes);

/// The reverse: numbers as an SDO carries them.
[[nodiscard]] std::vector<std::byte> bytes_of(dictionary::DataType type, std::uint64_t bits);

}  // namespace stator::python
