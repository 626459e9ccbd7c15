#include "stator/web/state.hpp"

#include <algorithm>
#include <charconv>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/base/name_pattern.hpp"
#include "stator/base/severity_text.hpp"
#include "stator/dictionary/abort_code.hpp"
#include "stator/ethercat/standard/al_status_text.hpp"
#include "stator/formats/json/schema.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/file/rack_file_description.hpp"
#include "stator/rack/observe/event_log.hpp"
#include "stator/web/address.hpp"

namespace stator::web {

nlohmann::ordered_json to_json(const EventRecord& event) {
  return {
      {"number", event.number},  {"time_ns", event.time.nanoseconds()}, {"device", event.device},
      {"rule", event.rule},      {"severity", to_text(event.severity)}, {"text", event.text},
      {"meaning", event.meaning}};
}

namespace {

/// The number that an event's sentence tells behind `mark`, e.g. "axis {": the argument named
/// there.
std::optional<std::int64_t> number_behind(std::string_view mark, const base::Event& event) {
  const std::string_view text = event.rule->text;
  const std::size_t at = text.find(mark);
  if (at == std::string_view::npos || at + mark.size() >= text.size()) {
    return std::nullopt;
  }
  const auto argument = static_cast<std::size_t>(text[at + mark.size()] - '0');
  return argument < event.arguments.size() && event.arguments[argument].is_number()
             ? std::optional(event.arguments[argument].number())
             : std::nullopt;
}

/// The code that a sentence tells behind `mark`, e.g. "AL status 0011h".
std::optional<std::uint32_t> code_behind(std::string_view mark, std::string_view sentence) {
  const std::size_t at = sentence.find(mark);
  if (at == std::string_view::npos) {
    return std::nullopt;
  }
  const char* const end = sentence.data() + sentence.size();
  std::uint32_t code = 0;
  const auto [after, error] = std::from_chars(sentence.data() + at + mark.size(), end, code, 16);
  return error == std::errc() && after != end && *after == 'h' ? std::optional(code) : std::nullopt;
}

/// The standard's words for the code that an event's sentence tells; empty: it tells none.
std::string meaning_of(std::string_view sentence) {
  if (const auto code = code_behind("AL status ", sentence)) {
    return fmt::format("AL status code {:04X}h: {}", *code,
                       to_text(static_cast<ethercat::AlStatusCode>(*code)));
  }
  for (const std::string_view mark : {"abort code ", "aborted with "}) {
    if (const auto code = code_behind(mark, sentence)) {
      return fmt::format("Abort code {:08X}h: {}", *code,
                         to_text(static_cast<dictionary::AbortCode>(*code)));
    }
  }
  return "";
}

}  // namespace

State::State(rack::Rack& rack, const rack::RackConfiguration& configuration,
             const rack::EventLog& log, const rack::Runner& runner)
    : configuration_(configuration),
      log_(log),
      runner_(runner),
      run_(make_token()),
      signals_(rack.signals()) {
  for (std::size_t i = 0; i < configuration.segments.size(); ++i) {
    networks_.push_back({.name = fmt::format("segment {}", i), .kind = "ethercat"});
  }
  for (std::size_t i = 0; i < configuration.buses.size(); ++i) {
    if (configuration.buses[i].wire) {
      wires_.push_back(i);
      networks_.push_back({.name = configuration.buses[i].name, .kind = "can"});
    }
  }
  for (std::size_t i = 0; i < rack.line_count(); ++i) {
    lines_.push_back(rack.line(i).configuration());
    networks_.push_back({.name = lines_.back().link, .kind = "serial"});
  }
  for (const rack::DeviceAddress& address : rack.addresses()) {
    const bool on_bus = address.kind == rack::NetworkKind::bus;
    const rack::DeviceConfiguration& device =
        (on_bus ? configuration.buses[address.network].devices
                : configuration.segments[address.network].devices)[address.device];
    devices_.push_back({.name = device.name,
                        .product = device.setup.product().identity().name(),
                        .network = on_bus ? configuration.buses[address.network].name
                                          : fmt::format("segment {}", address.network),
                        .address = address,
                        .objects = rack.device(address).object_dictionary(),
                        .inputs = &rack.inputs(address),
                        .motion_units = device.setup.product().motion_units()});
  }
}

const DeviceRecord* State::find_device(std::string_view name) const {
  const auto found = std::ranges::find(devices_, name, &DeviceRecord::name);
  return found == devices_.end() ? nullptr : &*found;
}

std::vector<std::size_t> State::matching(std::string_view patterns) const {
  std::vector<bool> chosen(signals_.size(), false);
  while (!patterns.empty()) {
    const std::size_t end = std::min(patterns.find(','), patterns.size());
    for (std::size_t i = 0; i < signals_.size(); ++i) {
      chosen[i] = chosen[i] || base::matches(patterns.substr(0, end), signals_[i].name);
    }
    patterns.remove_prefix(std::min(end + 1, patterns.size()));
  }
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (chosen[i]) {
      numbers.push_back(i);
    }
  }
  return numbers;
}

std::string_view State::clock() const {
  return runner_.clock_kind() == rack::ClockKind::real ? "real" : "lockstep";
}

void State::take_event(std::uint64_t number, const base::Event& event) {
  ++event_counts_[static_cast<std::size_t>(event.rule->severity)];
  std::string text = base::to_sentence(event);
  std::string meaning = meaning_of(text);
  events_.push_back({.number = number,
                     .time = event.time,
                     .device = log_.device_name(event),
                     .rule = event.rule->id,
                     .severity = event.rule->severity,
                     .text = std::move(text),
                     .axis = number_behind("axis {", event),
                     .meaning = std::move(meaning)});
  if (events_.size() > rack::EventLog::kKept) {
    events_.pop_front();
  }
}

const EventRecord* State::last_refusal(std::string_view device,
                                       std::optional<std::int64_t> axis) const {
  const auto last = std::find_if(events_.rbegin(), events_.rend(), [&](const EventRecord& event) {
    return event.severity == base::Severity::refusal && event.device == device &&
           (!axis || event.axis == axis);
  });
  return last == events_.rend() ? nullptr : &*last;
}

void State::read_networks(std::vector<NetworkRecord>& networks) const {
  auto network = networks.begin();
  for (std::size_t i = 0; network != networks.end() && network->kind == "ethercat"; ++i) {
    const rack::SegmentStatistics statistics = runner_.segment_in_task(i);
    network->frames = statistics.frames;
    network->overruns = statistics.overruns;
    network->worst_lag_ns = statistics.worst_lag_ns;
    ++network;
  }
  for (const std::size_t bus : wires_) {
    const rack::BusThreadStatistics& statistics = runner_.bus(bus).statistics_in_task();
    network->frames = statistics.frames_in;
    network->overruns = statistics.overruns;
    network->worst_lag_ns = statistics.worst_lag_ns;
    ++network;
  }
  for (std::size_t i = 0; network != networks.end(); ++i) {
    const rack::SerialLineThreadStatistics statistics = runner_.line(i).statistics_in_task();
    network->frames = statistics.line.bytes_in;
    network->overruns = statistics.overruns;
    network->worst_lag_ns = statistics.worst_lag_ns;
    ++network;
  }
}

const std::string& State::keys() {
  if (keys_.empty()) {
    keys_ = formats::json_schema(rack::describe_rack_file(catalogue), rack::kRackFileTitle, "rack");
  }
  return keys_;
}

}  // namespace stator::web
