// stator sdo: reads and writes an object of a slave on an EtherCAT segment.
#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "stator/base/byte_order.hpp"
#include "stator/cli/commands.hpp"
#include "stator/cli/master/master_session.hpp"
#include "stator/cli/master/object_address.hpp"
#include "stator/dictionary/data_type.hpp"

namespace stator::cli {

namespace {

using dictionary::DataType;

struct SdoOptions {
  BusOptions bus;
  std::size_t position = 0;
  std::string object;
  std::string value;
  std::string type;
};

constexpr std::array kTypes{DataType::boolean,    DataType::integer8,   DataType::integer16,
                            DataType::integer32,  DataType::integer64,  DataType::unsigned8,
                            DataType::unsigned16, DataType::unsigned32, DataType::unsigned64,
                            DataType::real32,     DataType::real64,     DataType::visible_string};

DataType type_by_name(std::string name) {
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::toupper(c); });
  std::string all;
  for (const DataType type : kTypes) {
    if (name == to_text(type)) {
      return type;
    }
    all += (all.empty() ? "" : ", ") + std::string(to_text(type));
  }
  throw Failure(fmt::format("data type \"{}\" is not known; the types are: {}", name, all));
}

/// The type the user named, or else the one the slave's dictionary tells.
std::optional<DataType> type_of(const SdoOptions& options, master::Master& master,
                                const master::ObjectAddress& object) {
  if (!options.type.empty()) {
    return type_by_name(options.type);
  }
  const auto entry = master.entry_description(options.position, object.index, object.subindex);
  if (!entry) {
    return std::nullopt;
  }
  return static_cast<DataType>(entry->data_type);
}

std::uint64_t little_endian(std::span<const std::byte> data) {
  std::array<std::byte, 8> bytes{};
  std::ranges::copy(data.first(std::min(data.size(), bytes.size())), bytes.begin());
  return base::load_le<std::uint64_t>(bytes);
}

std::string bytes_text(std::span<const std::byte> data) {
  std::string text;
  for (const std::byte b : data) {
    text += fmt::format("{}{:02X}", text.empty() ? "" : " ", std::to_integer<unsigned>(b));
  }
  return text;
}

std::string value_text(std::optional<DataType> type, std::span<const std::byte> data) {
  if (!type || (!is_string(*type) && byte_length(*type) != data.size())) {
    return bytes_text(data);
  }
  if (*type == DataType::visible_string) {
    return fmt::format("\"{}\"",
                       std::string_view(reinterpret_cast<const char*>(data.data()), data.size()));
  }
  if (is_string(*type)) {
    return bytes_text(data);
  }
  const std::uint64_t bits = little_endian(data);
  if (*type == DataType::real32) {
    return fmt::format("{}", base::load_le<float>(data));
  }
  if (*type == DataType::real64) {
    return fmt::format("{}", base::load_le<double>(data));
  }
  const std::size_t digits = 2 * data.size();
  if (is_signed(*type)) {
    const auto shift = static_cast<unsigned>(64 - bit_length(*type));
    const std::int64_t number = static_cast<std::int64_t>(bits << shift) >> shift;
    return fmt::format("{} ({:0{}X}h)", number, bits, digits);
  }
  return fmt::format("{} ({:0{}X}h)", bits, bits, digits);
}

template <typename T>
std::optional<T> parse_number(std::string_view text) {
  const bool negative = text.starts_with('-');
  std::string_view digits = negative ? text.substr(1) : text;
  const bool hexadecimal = digits.starts_with("0x") || digits.starts_with("0X");
  if (hexadecimal) {
    digits.remove_prefix(2);
  }
  std::uint64_t magnitude = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), magnitude,
                                            hexadecimal ? 16 : 10);
  if (digits.empty() || error != std::errc() || end != digits.data() + digits.size()) {
    return std::nullopt;
  }
  return static_cast<T>(negative ? 0 - magnitude : magnitude);
}

/// Whether a value written as `text` fits into `type`; two's complement patterns are allowed.
bool fits(DataType type, std::string_view text, std::uint64_t bits) {
  const std::size_t length = bit_length(type);
  if (length >= 64) {
    return true;
  }
  if (text.starts_with('-')) {
    return is_signed(type) && static_cast<std::int64_t>(bits) >= -(std::int64_t{1} << (length - 1));
  }
  return bits < (std::uint64_t{1} << length);
}

std::vector<std::byte> encode(DataType type, const std::string& text) {
  std::vector<std::byte> data;
  if (is_string(type)) {
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
  }
  if (type == DataType::real32 || type == DataType::real64) {
    double number = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size()) {
      throw Failure(fmt::format("value \"{}\" is no number", text));
    }
    data.resize(byte_length(type));
    if (type == DataType::real32) {
      base::store_le(data.data(), static_cast<float>(number));
    } else {
      base::store_le(data.data(), number);
    }
    return data;
  }
  const auto bits = parse_number<std::uint64_t>(text);
  if (!bits || !fits(type, text, *bits)) {
    throw Failure(
        fmt::format("value \"{}\" is no {}; write a decimal number or 0x...", text, to_text(type)));
  }
  std::array<std::byte, 8> bytes{};
  base::store_le(bytes, 0, *bits);
  data.assign(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(byte_length(type)));
  return data;
}

std::string object_text(const master::ObjectAddress& object) {
  return fmt::format("{:04X}h:{:02X}", object.index, object.subindex);
}

void read(const SdoOptions& options) {
  const master::ObjectAddress object = parse_object_address(options.object);
  MasterSession session(options.bus);
  master::Master& master = session.master();
  require(master.start_mailbox(options.position));
  const auto data = require(master.upload(options.position, object));
  fmt::print("{} = {}\n", object_text(object), value_text(type_of(options, master, object), data));
  session.end();
}

void write(const SdoOptions& options) {
  const master::ObjectAddress object = parse_object_address(options.object);
  MasterSession session(options.bus);
  master::Master& master = session.master();
  require(master.start_mailbox(options.position));
  const auto type = type_of(options, master, object);
  if (!type) {
    // Let the slave say what is wrong with the object rather than guess its type.
    require(master.upload(options.position, object));
    throw Failure(fmt::format("the slave does not tell the data type of {}; name it with --type",
                              object_text(object)));
  }
  require(master.download(options.position, object, encode(*type, options.value)));
  fmt::print("{} <- {}\n", object_text(object), options.value);
  session.end();
}

void add_common_options(CLI::App& command, SdoOptions& options) {
  add_bus_options(command, options.bus);
  command.add_option("-p,--position", options.position, "Slave on the segment, 0 = first")
      ->capture_default_str();
  command.add_option("--type", options.type,
                     "Data type, e.g. INTEGER32; asked from the slave if left out");
}

}  // namespace

void add_sdo_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("sdo", "Read or write one object of a slave");
  command->require_subcommand(1);

  auto read_options = std::make_shared<SdoOptions>();
  CLI::App* reading = command->add_subcommand("read", "Read an object");
  reading->add_option("object", read_options->object, "index:subindex, e.g. 6041h:00")->required();
  add_common_options(*reading, *read_options);
  reading->footer("Example: stator sdo read 1008h --link ethercat:eth1");
  reading->callback([read_options] { read(*read_options); });

  auto write_options = std::make_shared<SdoOptions>();
  CLI::App* writing = command->add_subcommand("write", "Write an object");
  writing->add_option("object", write_options->object, "index:subindex, e.g. 6081h:00")->required();
  writing->add_option("value", write_options->value, "Decimal number, 0x... or text")->required();
  add_common_options(*writing, *write_options);
  writing->footer("Example: stator sdo write 6081h 256000 --link ethercat:eth1");
  writing->callback([write_options] { write(*write_options); });
}

}  // namespace stator::cli
