// Values of Python as those of the library, and back.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <nanobind/nanobind.h>

#include "stator/dictionary/dictionary.hpp"
#include "stator/settings/value.hpp"

namespace stator::python {

/// A table of dictionaries, lists, texts, numbers and truth values, as a rack file has them. Paths
/// count as texts. Throws nanobind::type_error naming the key of a value that is something else.
[[nodiscard]] settings::Table to_table(nanobind::handle mapping);

/// The value of an object, as an SDO carries it: int, float, bool, str or bytes.
[[nodiscard]] nanobind::object to_python(dictionary::DataType type,
                                         std::span<const std::byte> value);
/// The reverse, for an entry; bytes go as they are. Throws nanobind::type_error or value_error for
/// what is no value of the entry's type.
[[nodiscard]] std::vector<std::byte> to_bytes(const dictionary::Entry& entry,
                                              nanobind::handle value);

/// The same for a type; `what` names the value in messages.
[[nodiscard]] std::vector<std::byte> to_bytes(dictionary::DataType type, nanobind::handle value,
                                              const std::string& what);

[[nodiscard]] nanobind::bytes to_python(std::span<const std::byte> bytes);
[[nodiscard]] std::vector<std::byte> to_vector(const nanobind::bytes& bytes);

}  // namespace stator::python
