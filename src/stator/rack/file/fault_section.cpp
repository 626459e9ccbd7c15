#include "stator/rack/file/fault_section.hpp"

#include <algorithm>
#include <charconv>
#include <map>
#include <ranges>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "stator/ethercat/standard/frame.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/faults/fault_commands.hpp"
#include "stator/rack/faults/surroundings_faults.hpp"
#include "stator/rack/file/rack_file_steps.hpp"
#include "stator/rack/world/input_names.hpp"
#include "stator/settings/value_text.hpp"
#include "stator/settings/words.hpp"

namespace stator::rack {

namespace {

constexpr double kNanosecondsPerSecond = 1e9;

base::SimDuration seconds(double value) {
  return base::SimDuration(static_cast<std::int64_t>(value * kNanosecondsPerSecond));
}

std::set<std::string> words(std::string_view text) {
  std::istringstream stream{std::string(text)};
  std::set<std::string> all;
  for (std::string word; stream >> word;) {
    all.insert(word);
  }
  return all;
}

/// As it stands in a rack file.
std::string written_default(const FaultParameter& parameter) {
  std::string text(parameter.default_value);
  switch (parameter.type) {
    case FaultValueType::whole:
      return std::to_string(std::stoll(text, nullptr, 0));
    case FaultValueType::number:
      return text;
    default:
      return '"' + text + '"';
  }
}

std::optional<FaultValue> given_value(TableReader& section, const FaultParameter& parameter) {
  const settings::KeyWords key(std::string(parameter.name), std::string(parameter.summary),
                               std::string(parameter.unit));
  if (!parameter.default_value.empty()) {
    section.note_default(key, written_default(parameter));
  }
  const auto wrap = [](const auto& value) -> std::optional<FaultValue> {
    return value ? std::optional<FaultValue>(FaultValue(*value)) : std::nullopt;
  };
  switch (parameter.type) {
    case FaultValueType::whole:
      return wrap(section.integer(key, static_cast<std::int64_t>(parameter.minimum),
                                  static_cast<std::int64_t>(parameter.maximum)));
    case FaultValueType::number:
      return wrap(section.number(key, parameter.minimum, parameter.maximum));
    case FaultValueType::duration:
      return wrap(section.duration(key, seconds(parameter.minimum), seconds(parameter.maximum)));
    case FaultValueType::text:
      return wrap(section.text(key));
    case FaultValueType::choice:
      return wrap(section.choice(key, words(parameter.choices)));
  }
  return std::nullopt;
}

/// The default of a parameter, unchecked since it comes from the table of kinds; nothing: it has
/// none.
std::optional<FaultValue> default_value(const FaultParameter& parameter) {
  const std::string text(parameter.default_value);
  if (text.empty()) {
    return std::nullopt;
  }
  switch (parameter.type) {
    case FaultValueType::whole:
      return std::int64_t{std::stoll(text, nullptr, 0)};
    case FaultValueType::number:
      return std::stod(text);
    case FaultValueType::duration:
      return settings::parse_duration(text).value_or(base::SimDuration());
    default:
      return text;
  }
}

std::string missing(const FaultParameter& parameter) {
  return fmt::format("\"{}\" is missing; it says: {}", parameter.name, parameter.summary);
}

/// The value given for a parameter, else its default.
std::optional<FaultValue> value_of(TableReader& section, const FaultParameter& parameter) {
  auto value = given_value(section, parameter);
  if (parameter.needed) {
    section.note_required(std::string(parameter.name));
  }
  if (!value && parameter.needed) {
    section.refuse(std::string(parameter.name), missing(parameter));
  }
  return value ? value : default_value(parameter);
}

const FaultParameter& common(std::string_view name) {
  return *std::ranges::find(common_fault_keys(), name, &FaultParameter::name);
}

template <typename T>
std::optional<T> read_common(TableReader& section, std::string_view name) {
  const auto value = given_value(section, common(name));
  return value ? std::optional<T>(std::get<T>(*value)) : std::nullopt;
}

/// The value of `digits`; negative if they are no hexadecimal number up to `maximum`.
long hexadecimal(std::string_view digits, long maximum) {
  long value = -1;
  const char* end = digits.data() + digits.size();
  const auto result = std::from_chars(digits.data(), end, value, 16);
  return result.ec == std::errc() && result.ptr == end && value <= maximum ? value : -1;
}

std::set<std::string> kind_names() {
  std::set<std::string> names;
  for (const FaultKind& kind : fault_kinds()) {
    names.insert(std::string(kind.name));
  }
  return names;
}

}  // namespace

std::optional<FaultObject> parse_fault_object(std::string_view text) {
  constexpr long kMostIndex = 0xFFFF;
  constexpr long kMostSubindex = 0xFF;
  const std::size_t colon = std::min(text.find(':'), text.size());
  const long index = hexadecimal(text.substr(0, colon), kMostIndex);
  if (index < 0) {
    return std::nullopt;
  }
  if (colon == text.size()) {
    return FaultObject{static_cast<std::uint16_t>(index), std::nullopt};
  }
  const long subindex = hexadecimal(text.substr(colon + 1), kMostSubindex);
  if (subindex < 0) {
    return std::nullopt;
  }
  return FaultObject{static_cast<std::uint16_t>(index), static_cast<std::uint8_t>(subindex)};
}

FaultConfiguration FaultReader::read(TableReader& section) {
  FaultConfiguration fault;
  fault.name = read_common<std::string>(section, "name").value_or("");
  const std::set<std::string> names = kind_names();
  const bool read =
      section.select({"kind", "What goes wrong, see stator faults"}, names,
                     "it must be one of: " + settings::joined(names), [&](const std::string& kind) {
                       fault.kind = find_fault_kind(kind);
                       read_target(section, fault);
                       for (const FaultParameter& parameter : fault.kind->parameters) {
                         if (auto value = value_of(section, parameter)) {
                           fault.values.set(parameter.name, std::move(*value));
                         }
                       }
                       if (!section.describes()) {
                         check_reach(section, fault);
                         check_values(section, fault);
                       }
                       read_end(section, fault);
                       read_begin(section, fault);
                       section.finish();
                     });
  if (!read) {
    TableReader::abandon();
  }
  return fault;
}

void FaultReader::read_target(TableReader& section, FaultConfiguration& fault) {
  FaultTarget& target = fault.target;
  if (fault.kind->scope == FaultScope::bus) {
    read_bus_target(section, fault);
    return;
  }
  if (fault.kind->scope == FaultScope::line) {
    read_line_target(section, fault);
    return;
  }
  target.device = targets_.read_target(section);
  section.note_required("device");
  target.text = name_of(section, *target.device);
  const bool has_ports = section.describes() ? fault.kind->reach != FaultReach::can
                                             : target.device->kind == NetworkKind::segment;
  if (fault.kind->scope == FaultScope::port && has_ports) {
    target.port = targets_.read_port(section, *target.device);
    target.text += fmt::format(" port {}", target.port);
  }
  if (fault.kind->scope == FaultScope::axis) {
    const auto axis = value_of(section, target_keys(FaultScope::axis)[1]);
    target.axis = static_cast<unsigned>(std::get<std::int64_t>(*axis));
    target.text += fmt::format(" axis {}", target.axis);
  }
}

std::string FaultReader::name_of(const TableReader& section, DeviceAddress device) const {
  return section.describes() ? "" : targets_.device_at(device).name;
}

void FaultReader::read_bus_target(TableReader& section, FaultConfiguration& fault) {
  FaultTarget& target = fault.target;
  if (const auto bus = section.text({"bus", "Instead of device: all frames of this bus"})) {
    target.bus = targets_.read_bus(section, *bus);
    target.text = *bus;
    return;
  }
  target.device = targets_.read_can_target(section);
  target.bus = target.device->network;
  target.text = name_of(section, *target.device);
}

void FaultReader::read_line_target(TableReader& section, FaultConfiguration& fault) {
  std::map<std::string, DeviceAddress> lines;  // with the first device of each
  const auto note = [&](DeviceAddress address) {
    for (const SerialConnection& connection : targets_.device_at(address).serial) {
      lines.try_emplace(connection.line, address);
    }
  };
  const auto names = [&lines] {
    std::vector<std::string> texts;
    texts.reserve(lines.size());
    for (const auto& [name, address] : lines) {
      texts.push_back(name);
    }
    return texts.empty() ? "none" : fmt::format("{}", fmt::join(texts, ", "));
  };
  FaultTarget& target = fault.target;
  const auto line = section.text({"line", "The serial line, as devices name it"});
  if (section.describes()) {
    target.device = targets_.read_target(section);
    return;
  }
  if (line) {
    for (std::size_t network = 0; network < rack_.segments.size(); ++network) {
      for (std::size_t i = 0; i < rack_.segments[network].devices.size(); ++i) {
        note({network, i, NetworkKind::segment});
      }
    }
    for (std::size_t network = 0; network < rack_.buses.size(); ++network) {
      for (std::size_t i = 0; i < rack_.buses[network].devices.size(); ++i) {
        note({network, i, NetworkKind::bus});
      }
    }
    if (!lines.contains(*line)) {
      section.fail(
          "line", fmt::format("there is no serial line \"{}\"; the lines are: {}", *line, names()));
    }
    target.line = *line;
  } else {
    const DeviceAddress address = targets_.read_target(section);
    note(address);
    if (lines.size() != 1) {
      section.fail(
          "device",
          lines.empty()
              ? fmt::format("\"{}\" is on no serial line", targets_.device_at(address).name)
              : fmt::format(R"("{}" is on several serial lines; name one with "line": {})",
                            targets_.device_at(address).name, names()));
    }
    target.line = lines.begin()->first;
  }
  target.device = lines.at(target.line);
  target.text = target.line;
}

void FaultReader::check_reach(TableReader& section, const FaultConfiguration& fault) const {
  if (!fault.target.device) {
    return;
  }
  const DeviceAddress address = *fault.target.device;
  const DeviceConfiguration& device = targets_.device_at(address);
  const bool ethercat = address.kind == NetworkKind::segment;
  const FaultReach reach = fault.kind->reach;
  if ((reach == FaultReach::ethercat || reach == FaultReach::ethercat_firmware) && !ethercat) {
    section.fail("device", fmt::format(R"("{}" is not on EtherCAT, so "{}" cannot happen to it)",
                                       device.name, fault.kind->name));
  }
  if (reach == FaultReach::ethercat_firmware && !device.setup.product().identity().own_firmware) {
    section.fail("device", fmt::format("\"{}\" has no firmware of its own, so \"{}\" cannot happen "
                                       "to it; a program beside a chip can do that",
                                       device.name, fault.kind->name));
  }
  if (reach == FaultReach::can) {
    targets_.require_can(section, address);
  }
  if (fault.kind->scope == FaultScope::port && reach == FaultReach::any && !ethercat) {
    targets_.require_can(section, address);
  }
}

void FaultReader::check_values(TableReader& section, const FaultConfiguration& fault) {
  const FaultValues& values = fault.values;
  if (const auto object = values.find<std::string>("object");
      object && !parse_fault_object(*object)) {
    section.refuse("object", fmt::format("\"object\" is \"{}\"; write index or index:subindex in "
                                         "hexadecimal, e.g. \"6060:00\"",
                                         *object));
  }
  if (const auto commands = values.find<std::string>("commands")) {
    if (const std::string problem = command_problem(*commands); !problem.empty()) {
      section.refuse("commands", problem);
    }
  }
  if (fault.kind->problems == nullptr || !section.problems().list.empty()) {
    return;  // a device with errors may not be there to be asked
  }
  for (const FaultProblem& problem :
       fault.kind->problems(fault, targets_.inputs_of(*fault.target.device))) {
    section.refuse(problem.key, problem.text);
  }
}

void FaultReader::read_begin(TableReader& section, FaultConfiguration& fault) {
  fault.at = read_common<base::SimDuration>(section, "at");
  fault.after = read_common<std::string>(section, "after").value_or("");
  fault.wait = read_common<base::SimDuration>(section, "wait").value_or(base::SimDuration());
  if (auto when = section.section({"when", "What is reached when the fault begins"})) {
    fault.when = read_milestone(*when, fault.target);
  }
  const int ways = (fault.at ? 1 : 0) + (fault.after.empty() ? 0 : 1) + (fault.when ? 1 : 0);
  if (ways > 1) {
    section.refuse("at",
                   "a fault begins \"at\" a time, \"after\" another fault or \"when\" "
                   "something is reached: give one of them");
  }
  if (!fault.name.empty() && fault.name == fault.after) {
    section.refuse("after", "a fault cannot come after itself");
  }
}

void FaultReader::read_end(TableReader& section, FaultConfiguration& fault) const {
  const FaultKind& kind = *fault.kind;
  fault.duration = read_common<base::SimDuration>(section, "for");
  if (fault.duration && kind.momentary) {
    section.refuse("for", fmt::format("\"{}\" is over as soon as it has begun", kind.name));
  }
  const auto count = read_common<std::int64_t>(section, "count");
  const auto probability = read_common<double>(section, "probability");
  for (const auto& [key, given] :
       {std::pair("count", count.has_value()), std::pair("probability", probability.has_value())}) {
    if (given && kind.counted.empty()) {
      section.refuse(
          key, fmt::format(R"("{}" has nothing to count, so it takes no "{}")", kind.name, key));
    }
  }
  const auto mode = fault.values.find<std::string>("mode");
  if (mode == "full" && (count || probability.value_or(1.0) < 1.0)) {
    section.refuse(count ? "count" : "probability",
                   "requests that nobody takes cannot be counted; end it with \"for\"");
  }
  fault.count = static_cast<std::uint64_t>(count.value_or(0));
  fault.probability = probability.value_or(1.0);
  fault.seed = static_cast<std::uint64_t>(read_common<std::int64_t>(section, "seed").value_or(1));
}

Milestone FaultReader::read_milestone(TableReader& section, const FaultTarget& target) const {
  Milestone milestone;
  FaultValues values;
  for (const FaultParameter& key : milestone_keys()) {
    if (auto value = given_value(section, key)) {
      values.set(key.name, std::move(*value));
    }
  }
  section.finish();
  if (section.describes()) {
    return milestone;
  }
  if (values.has("device")) {
    milestone.device = targets_.read_target(section);
  } else if (target.device) {
    milestone.device = *target.device;
  } else {
    section.fail("device", "\"device\" is missing; it names the device that is watched");
  }
  using enum Milestone::Kind;
  const bool on_bus = milestone.device.kind == NetworkKind::bus;
  const std::string axis = fmt::format("axis{}.", values.find<std::int64_t>("axis").value_or(0));
  const auto count = [&values](const char* key) {
    return static_cast<std::uint64_t>(values.find<std::int64_t>(key).value_or(1));
  };
  const auto need = [&](const char* key, bool bus) {
    if (on_bus != bus) {
      section.fail(key, fmt::format("\"{}\" can be reached {} only", key,
                                    bus ? "on a CAN bus" : "on EtherCAT"));
    }
  };
  if (const auto object = values.find<std::string>("sdo")) {
    milestone.object = parse_fault_object(*object);
    if (!milestone.object) {
      section.fail("sdo", fmt::format("\"sdo\" is \"{}\"; write index or index:subindex in "
                                      "hexadecimal, e.g. \"6060:00\"",
                                      *object));
    }
  }
  if (values.has("cycles")) {
    milestone.kind = cycles;
    milestone.count = count("cycles");
  } else if (values.has("message")) {
    need("message", false);
    milestone.kind = message;
    milestone.count = count("message");
  } else if (values.has("segment")) {
    need("segment", false);
    milestone.kind = segment;
    milestone.count = count("segment");
  } else if (values.has("sdo")) {
    need("sdo", false);
    milestone.kind = sdo;
    milestone.count = count("count");
  } else if (values.has("frame")) {
    need("frame", true);
    milestone.kind = frame;
    milestone.identifier = static_cast<std::uint32_t>(values.whole("frame"));
    milestone.count = count("count");
  } else if (values.has("network_state")) {
    milestone.kind = network_state;
    milestone.state = values.get<std::string>("network_state");
  } else if (values.has("power_state")) {
    milestone.kind = power_state;
    milestone.state = values.get<std::string>("power_state");
    milestone.signal = axis + "statusword";
  } else if (values.has("position")) {
    milestone.kind = signal;
    milestone.signal = axis + "position_actual";
    milestone.value = values.get<double>("position");
  } else if (values.has("signal") && values.has("value")) {
    milestone.kind = signal;
    milestone.signal = values.get<std::string>("signal");
    milestone.value = values.get<double>("value");
  } else {
    section.fail("when",
                 "a milestone is one of: cycles, message, sdo, segment, frame, "
                 "network_state, power_state, position, signal with value");
  }
  return milestone;
}

void read_faults(TableReader& root, RackConfiguration& rack) {
  FaultReader reader(rack);
  std::set<std::string> names;
  std::vector<std::pair<TableReader, std::string>> followers;
  for (TableReader& section : root.sections({"fault", "What goes wrong, from when to when"})) {
    section.attempt([&] {
      FaultConfiguration fault = reader.read(section);
      if (!fault.name.empty() && !names.insert(fault.name).second) {
        section.refuse("name", fmt::format("there is a fault \"{}\" already", fault.name));
      }
      if (!fault.after.empty()) {
        followers.emplace_back(section, fault.after);
      }
      rack.faults.push_back(std::move(fault));
    });
  }
  for (auto& [section, after] : followers) {
    if (!names.contains(after)) {
      const std::string guess = settings::closest_match(after, names);
      section.refuse(
          "after", fmt::format("there is no fault \"{}\"{}", after,
                               guess.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", guess)));
    }
  }
}

FaultConfiguration parse_fault(std::string_view text, const RackConfiguration& rack) {
  FaultConfiguration fault = read_fault(parse_rack_tree(text, ""), rack);
  fault.text = text;
  return fault;
}

FaultConfiguration read_fault(const settings::Value& table, const RackConfiguration& rack) {
  FaultConfiguration fault;
  read_tree(table, "", "the fault",
            [&](TableReader& section) { fault = FaultReader(rack).read(section); });
  if (const auto* keys = table.find<settings::Table>()) {
    fault.text = settings::toml_text(*keys);
  }
  return fault;
}

}  // namespace stator::rack
