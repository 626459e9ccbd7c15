#include "values.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <nanobind/stl/string.h>

#include "stator/dictionary/content.hpp"

namespace nb = nanobind;

namespace stator::python {

namespace {

std::string name_of_type(nb::handle value) {
  return nb::cast<std::string>(value.type().attr("__name__"));
}

std::string text_of(nb::handle text) {
  return nb::cast<std::string>(text);
}

/// A whole number that fits 64 bits; `what` names it in messages. Also takes those of NumPy.
std::int64_t whole_of(nb::handle value, const std::string& what) {
  const nb::object index = nb::steal(PyNumber_Index(value.ptr()));
  if (!index.is_valid()) {
    throw nb::python_error();
  }
  int overflow = 0;
  const long long number = PyLong_AsLongLongAndOverflow(index.ptr(), &overflow);
  if (overflow != 0) {
    throw nb::value_error(fmt::format("{} does not fit 64 bits", what).c_str());
  }
  return number;
}

/// What a truth value, a text or a float is as one of the types of `Variant`; nothing if it is
/// none of these. First, as Python has truth values among whole numbers.
template <typename Variant>
std::optional<Variant> plain_value(nb::handle value) {
  if (nb::isinstance<nb::bool_>(value)) {
    return Variant(nb::cast<bool>(value));
  }
  if (nb::isinstance<nb::str>(value)) {
    return Variant(text_of(value));
  }
  if (nb::isinstance<nb::float_>(value)) {
    return Variant(nb::cast<double>(value));
  }
  return std::nullopt;
}

settings::Value to_value(nb::handle value, const std::string& key);

settings::Table table_of(nb::handle mapping, const std::string& key) {
  settings::Table table;
  const nb::object items = nb::module_::import_("builtins").attr("dict")(mapping);
  for (const auto& [name, value] : nb::cast<nb::dict>(items)) {
    if (!nb::isinstance<nb::str>(name)) {
      throw nb::type_error(fmt::format("{}: keys are texts, not {}", key.empty() ? "the rack" : key,
                                       name_of_type(name))
                               .c_str());
    }
    const std::string own = text_of(name);
    table.emplace(own, to_value(value, key.empty() ? own : key + "." + own));
  }
  return table;
}

settings::Value to_value(nb::handle value, const std::string& key) {
  if (auto plain = plain_value<settings::Value>(value)) {
    return std::move(*plain);
  }
  if (PyMapping_Check(value.ptr()) != 0 && nb::hasattr(value, "keys")) {
    return table_of(value, key);
  }
  if (PyIndex_Check(value.ptr()) != 0) {
    return whole_of(value, key);
  }
  if (nb::hasattr(value, "__fspath__")) {
    return text_of(value.attr("__fspath__")());
  }
  if (nb::isinstance<nb::sequence>(value) && !nb::isinstance<nb::bytes>(value)) {
    settings::List list;
    for (const nb::handle each : value) {
      list.push_back(to_value(each, fmt::format("{}[{}]", key, list.size())));
    }
    return list;
  }
  if (PyNumber_Check(value.ptr()) != 0 && nb::hasattr(value, "__float__")) {
    return nb::cast<double>(nb::float_(nb::borrow(value)));
  }
  throw nb::type_error(fmt::format("{} is of type {}, which no key takes; write a number, a text, "
                                   "true or false, a list or a dict",
                                   key, name_of_type(value))
                           .c_str());
}

std::optional<dictionary::Content> content_of(nb::handle value, const std::string& what) {
  if (auto plain = plain_value<dictionary::Content>(value)) {
    return plain;
  }
  if (PyIndex_Check(value.ptr()) == 0) {
    return std::nullopt;
  }
  const nb::object index = nb::steal(PyNumber_Index(value.ptr()));
  std::uint64_t large = 0;
  if (nb::try_cast(index, large)) {
    return large;
  }
  return whole_of(value, what);
}

}  // namespace

settings::Table to_table(nb::handle mapping) {
  return table_of(mapping, "");
}

nb::object to_python(dictionary::DataType type, std::span<const std::byte> value) {
  return std::visit(
      [](const auto& content) -> nb::object {
        if constexpr (std::is_same_v<decltype(content), const std::vector<std::byte>&>) {
          return to_python(std::span(content));
        } else {
          return nb::cast(content);
        }
      },
      dictionary::decode(type, value));
}

std::vector<std::byte> to_bytes(const dictionary::Entry& entry, nb::handle value) {
  return to_bytes(
      entry.type(), value,
      fmt::format("{:04X}h:{:02X} \"{}\"", entry.index(), entry.subindex(), entry.name()));
}

std::vector<std::byte> to_bytes(dictionary::DataType type, nb::handle value,
                                const std::string& what) {
  if (nb::isinstance<nb::bytes>(value)) {
    return to_vector(nb::cast<nb::bytes>(value));
  }
  const std::optional<dictionary::Content> content = content_of(value, what);
  auto bytes = content ? dictionary::encode(type, *content) : std::nullopt;
  if (!bytes) {
    throw nb::value_error(fmt::format("{} is no value of the type {} of {}",
                                      nb::cast<std::string>(nb::repr(value)),
                                      dictionary::to_text(type).view(), what)
                              .c_str());
  }
  return std::move(*bytes);
}

nb::bytes to_python(std::span<const std::byte> bytes) {
  return nb::bytes(bytes.data(), bytes.size());
}

std::vector<std::byte> to_vector(const nb::bytes& bytes) {
  const auto* first = static_cast<const std::byte*>(bytes.data());
  return {first, first + bytes.size()};
}

}  // namespace stator::python
