#include "recording.hpp"

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/replay/recorded_files.hpp"
#include "stator/version.hpp"

namespace stator::python {

namespace {

/// A rack file with this text has the same tree.
nlohmann::json to_json(const settings::Value& value);

nlohmann::json to_json(const settings::Table& table) {
  auto object = nlohmann::json::object();
  for (const auto& [name, each] : table) {
    object[name] = to_json(each);
  }
  return object;
}

nlohmann::json to_json(const settings::Value& value) {
  if (const auto* const truth = value.find<bool>()) {
    return *truth;
  }
  if (const auto* const whole = value.find<std::int64_t>()) {
    return *whole;
  }
  if (const auto* const number = value.find<double>()) {
    return *number;
  }
  if (const auto* const words = value.find<std::string>()) {
    return *words;
  }
  if (const auto* const list = value.find<settings::List>()) {
    auto array = nlohmann::json::array();
    for (const settings::Value& each : *list) {
      array.push_back(to_json(each));
    }
    return array;
  }
  if (const auto* const table = value.find<settings::Table>()) {
    return to_json(*table);
  }
  return nullptr;
}

/// What stands in a recording for a table of the program, from whose working directory it names
/// files.
constexpr const char* kTableFile = "rack.json";

}  // namespace

replay::RecordingHeader header_of(const Source& source,
                                  const rack::RackConfiguration& configuration, bool links) {
  if (source.own_devices) {
    throw std::runtime_error(
        "a rack with products of one's own cannot be recorded, since a recording does not have "
        "their classes; leave recording and rewindable out, or products");
  }
  replay::RecordingHeader header;
  constexpr Version kNow = kVersion;
  header.program = fmt::format("{}.{}.{}", kNow.major_number, kNow.minor_number, kNow.patch_number);
  header.options.emplace_back(replay::kBuilderOption, replay::kProgram);
  header.options.emplace_back("clock", links ? "real" : "lockstep");
  for (const std::string& change : source.changes) {
    header.options.emplace_back("set", change);
  }
  if (!source.path.empty()) {
    replay::keep_rack(source.path, configuration.named_files, header);
  } else if (source.product.empty()) {
    replay::keep_rack(kTableFile, to_json(source.table).dump(), configuration.named_files, header);
  } else {
    header.options.emplace_back("device", source.product);
    header.options.emplace_back("count", "1");
    if (!configuration.named_files.empty()) {
      throw std::runtime_error(fmt::format(
          "a recording keeps the files that a rack file names, and \"{}\" stands in a change of a "
          "device without one; write a rack file with the device to record it",
          configuration.named_files.front()));
    }
  }
  if (links && !configuration.state.empty()) {
    replay::keep_state(configuration.state, header);
  } else {
    header.options.emplace_back(replay::kStateOption, replay::kStateNone);
  }
  return header;
}

}  // namespace stator::python
