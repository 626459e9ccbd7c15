#include "device_outline.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <nanobind/stl/string.h>

#include "session.hpp"
#include "stator/base/byte_order.hpp"
#include "stator/dictionary/content.hpp"
#include "stator/settings/key.hpp"
#include "values.hpp"
#include "words.hpp"

namespace nb = nanobind;

namespace stator::python {

namespace {

using Word = settings::Word;
template <typename T>
constexpr Word word(std::string_view name, T value) {
  return {name, static_cast<std::int64_t>(value)};
}

using dictionary::Access;
using dictionary::DataType;
using dictionary::PdoMapping;

constexpr std::array kTypes{word("boolean", DataType::boolean),
                            word("integer8", DataType::integer8),
                            word("integer16", DataType::integer16),
                            word("integer32", DataType::integer32),
                            word("integer64", DataType::integer64),
                            word("unsigned8", DataType::unsigned8),
                            word("unsigned16", DataType::unsigned16),
                            word("unsigned32", DataType::unsigned32),
                            word("unsigned64", DataType::unsigned64),
                            word("real32", DataType::real32),
                            word("real64", DataType::real64),
                            word("visible-string", DataType::visible_string),
                            word("octet-string", DataType::octet_string),
                            word("domain", DataType::domain)};
constexpr std::array kAccesses{word("rw", Access::read_write), word("ro", Access::read_only),
                               word("wo", Access::write_only), word("const", Access::constant)};
constexpr std::array kMappings{word("no", PdoMapping::no), word("receive", PdoMapping::receive),
                               word("transmit", PdoMapping::transmit),
                               word("both", PdoMapping::both)};

std::string text_attribute(nb::handle object, const char* name) {
  return nb::cast<std::string>(object.attr(name));
}

class OutlineReader {
 public:
  explicit OutlineReader(nb::handle factory) : factory_(factory) {}

  Outline read() {
    outline_.type = text_attribute(factory_, "type");
    outline_.name = text_attribute(factory_, "name");
    if (outline_.type.empty()) {
      throw std::runtime_error(
          "a class of devices has no type; give it one, e.g. type = \"probe\"");
    }
    if (outline_.name.empty()) {
      outline_.name = outline_.type;
    }
    outline_.network = text_attribute(factory_, "network") == "bus" ? product::NetworkKind::bus
                                                                    : product::NetworkKind::segment;
    outline_.vendor = nb::cast<std::uint32_t>(factory_.attr("vendor"));
    outline_.code = nb::cast<std::uint32_t>(factory_.attr("code"));
    outline_.revision = nb::cast<std::uint32_t>(factory_.attr("revision"));
    if (outline_.network == product::NetworkKind::bus) {
      outline_.bit_rate = nb::cast<std::uint32_t>(factory_.attr("bit_rate"));
    }
    outline_.period = duration_of(nb::cast<double>(factory_.attr("period")), "period");
    if (outline_.period <= base::SimDuration()) {
      throw std::runtime_error(
          fmt::format("{}: the period must be longer than 0 s", outline_.type));
    }
    outline_.starts = own("start");
    outline_.checks = own("check");
    outline_.writes = own("written");
    outline_.reads = own("read");
    for (const nb::handle each : factory_.attr("objects")) {
      outline_.objects.push_back(declaration_of(each));
    }
    return std::move(outline_);
  }

 private:
  /// The class has a function of that name which is not the one that all have.
  [[nodiscard]] bool own(const char* function) const {
    const nb::object base = nb::module_::import_("stator._devices").attr("OwnDevice");
    return !factory_.attr(function).is(base.attr(function));
  }
  std::string_view kept(std::string text) { return outline_.texts.emplace_back(std::move(text)); }

  dictionary::EntryDeclaration declaration_of(nb::handle object) {
    dictionary::EntryDeclaration declaration;
    declaration.index = nb::cast<std::uint16_t>(object.attr("index"));
    declaration.subindex = nb::cast<std::uint8_t>(object.attr("subindex"));
    declaration.name = kept(text_attribute(object, "name"));
    declaration.object_name = kept(text_attribute(object, "object_name"));
    if (!declaration.object_name.empty() || declaration.subindex != 0) {
      declaration.object_code = dictionary::ObjectCode::record;
    }
    declaration.unit = kept(text_attribute(object, "unit"));
    declaration.type =
        static_cast<DataType>(number_of(kTypes, text_attribute(object, "type"), "type"));
    declaration.access =
        static_cast<Access>(number_of(kAccesses, text_attribute(object, "access"), "access"));
    declaration.mapping =
        static_cast<PdoMapping>(number_of(kMappings, text_attribute(object, "pdo"), "mapping"));
    read_values(object, declaration);
    return declaration;
  }

  /// Default and limits.
  void read_values(nb::handle object, dictionary::EntryDeclaration& declaration) {
    const nb::object initial = object.attr("default");
    if (dictionary::is_string(declaration.type)) {
      const std::vector<std::byte> bytes = bytes_of_default(initial, declaration);
      declaration.default_value.text =
          kept({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
      return;
    }
    declaration.default_value.number = number_of_default(initial, declaration);
    const nb::object minimum = object.attr("minimum");
    const nb::object maximum = object.attr("maximum");
    if (minimum.is_none() != maximum.is_none()) {
      throw std::runtime_error(
          fmt::format("{:04X}h:{:02X} \"{}\": a minimum goes with a maximum; give both or none",
                      declaration.index, declaration.subindex, declaration.name));
    }
    if (!minimum.is_none()) {
      declaration.range = dictionary::Range{number_of_default(minimum, declaration),
                                            number_of_default(maximum, declaration)};
    }
  }

  static std::vector<std::byte> bytes_of_default(nb::handle value,
                                                 const dictionary::EntryDeclaration& declaration) {
    return to_bytes(declaration.type, value,
                    fmt::format("{:04X}h:{:02X} \"{}\"", declaration.index, declaration.subindex,
                                declaration.name));
  }
  static dictionary::Number number_of_default(nb::handle value,
                                              const dictionary::EntryDeclaration& declaration) {
    return bits_of(declaration.type, bytes_of_default(value, declaration));
  }

  nb::handle factory_;
  Outline outline_;
};

}  // namespace

Outline read_outline(nb::handle factory) {
  return OutlineReader(factory).read();
}

std::uint64_t bits_of(DataType type, std::span<const std::byte> bytes) {
  const dictionary::Content content = dictionary::decode(type, bytes);
  if (const auto* number = std::get_if<std::int64_t>(&content)) {
    return static_cast<std::uint64_t>(*number);
  }
  std::array<std::byte, sizeof(std::uint64_t)> all{};
  std::ranges::copy(bytes.first(std::min(bytes.size(), all.size())), all.begin());
  return base::load_le<std::uint64_t>(all.data());
}

std::vector<std::byte> bytes_of(DataType type, std::uint64_t bits) {
  std::array<std::byte, sizeof(std::uint64_t)> all{};
  base::store_le(all.data(), bits);
  return {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(dictionary::byte_length(type))};
}

}  // namespace stator::python
