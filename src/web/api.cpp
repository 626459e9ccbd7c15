#include "web/api.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dictionary/description.hpp"
#include "rack/input_names.hpp"
#include "web/assets.hpp"
#include "web/json_text.hpp"
#include "web/object_value.hpp"
#include "web/problem.hpp"
#include "web/snapshot.hpp"

namespace stator::web {

namespace {

using dictionary::Entry;
using Json = nlohmann::ordered_json;
using Answer = std::variant<Response, std::unique_ptr<Job>>;

/// Entries of a dictionary read, and events copied, in one look at the desk.
constexpr std::size_t kEntriesAtOnce = 16;
constexpr std::uint64_t kEventsAtOnce = 64;

Response json_response(const Json& value) {
  return {.body = text_of(value)};
}

std::string_view state_name(const Snapshot::DeviceState& state) {
  if (!state.powered) {
    return "off";
  }
  switch (state.network_state) {
    case dictionary::NetworkState::operational:
      return "operational";
    case dictionary::NetworkState::safe_operational:
      return "safe-operational";
    case dictionary::NetworkState::pre_operational:
      break;
  }
  return "pre-operational or below";
}

Json device_json(const DeviceRecord& device, const Snapshot::DeviceState& state) {
  return {
      {"name", device.name},
      {"product", device.product},
      {"network", device.network},
      {"powered", state.powered},
      {"state", state_name(state)},
      {"objects", device.objects == nullptr ? std::size_t{0} : device.objects->entries().size()},
      {"inputs", device.inputs->size()}};
}

/// JSON has no infinity and no NaN.
Json finite(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

/// What can be read of the rack at one moment.
class SnapshotJob final : public Job {
 public:
  SnapshotJob(const State& state, Operation operation, std::vector<std::size_t> chosen)
      : state_(state), operation_(operation), chosen_(std::move(chosen)), snapshot_(state) {}

  bool run(rack::Rack& rack, base::SimTime now) override {
    snapshot_.time = now;
    state_.read_networks(snapshot_.networks);
    for (std::size_t i = 0; i < snapshot_.devices.size(); ++i) {
      const rack::DeviceAddress address = state_.devices()[i].address;
      snapshot_.devices[i] = {rack.powered(address), rack.network_state(address)};
    }
    for (const std::size_t i : chosen_) {
      snapshot_.signals[i] = state_.signals()[i].read();
    }
    return true;
  }

  Response response() override {
    switch (operation_) {
      case Operation::health:
        return {.content_type = "text/plain; charset=utf-8", .body = "ok\n"};
      case Operation::metrics:
        return {.content_type = "application/openmetrics-text; version=1.0.0; charset=utf-8",
                .body = openmetrics(state_, snapshot_)};
      case Operation::rack:
        return json_response(rack());
      case Operation::devices:
        return json_response({{"devices", devices()}});
      case Operation::device:
        return json_response(
            device_json(state_.devices()[chosen_device], snapshot_.devices[chosen_device]));
      default:
        return json_response(signals());
    }
  }

  std::size_t chosen_device = 0;

 private:
  Json rack() {
    Json networks = Json::array();
    for (const NetworkRecord& network : snapshot_.networks) {
      networks.push_back({{"name", network.name},
                          {"kind", network.kind},
                          {"received", network.frames},
                          {"overruns", network.overruns},
                          {"worst_lag_ns", network.worst_lag_ns}});
    }
    return {{"clock", state_.clock()},
            {"time_ns", snapshot_.time.nanoseconds()},
            {"networks", networks},
            {"devices", state_.devices().size()},
            {"signals", state_.signals().size()}};
  }

  Json devices() {
    Json all = Json::array();
    for (std::size_t i = 0; i < snapshot_.devices.size(); ++i) {
      all.push_back(device_json(state_.devices()[i], snapshot_.devices[i]));
    }
    return all;
  }

  Json signals() {
    Json all = Json::array();
    for (const std::size_t i : chosen_) {
      const devices::Signal& signal = state_.signals()[i];
      all.push_back(
          {{"name", signal.name}, {"unit", signal.unit}, {"value", finite(snapshot_.signals[i])}});
    }
    return {{"time_ns", snapshot_.time.nanoseconds()}, {"signals", all}};
  }

  const State& state_;
  Operation operation_;
  std::vector<std::size_t> chosen_;  ///< signals to read
  Snapshot snapshot_;
};

class EventsJob final : public Job {
 public:
  EventsJob(State& state, std::uint64_t after) : state_(state), after_(after) {
    events_.reserve(rack::EventLog::kKept);
  }

  bool run(rack::Rack& /*rack*/, base::SimTime /*now*/) override {
    const auto& kept = state_.log().events();
    const std::uint64_t total = state_.log().total();
    const std::uint64_t first_kept = total - kept.size() + 1;
    std::uint64_t& fetched = state_.fetched();
    for (std::uint64_t i = 0; i < kEventsAtOnce && fetched < total; ++i) {
      if (events_.size() == events_.capacity()) {
        return true;
      }
      fetched = std::max(fetched + 1, first_kept);
      events_.emplace_back(fetched, kept[fetched - first_kept]);
    }
    return fetched == total;
  }

  Response response() override {
    for (const auto& [number, event] : events_) {
      state_.take_event(number, event);
    }
    Json all = Json::array();
    for (const EventRecord& event : state_.events()) {
      if (event.number > after_) {
        all.push_back({{"number", event.number},
                       {"time_ns", event.time.nanoseconds()},
                       {"device", event.device},
                       {"rule", event.rule},
                       {"severity", to_text(event.severity)},
                       {"text", event.text}});
      }
    }
    return json_response({{"events", std::move(all)}});
  }

 private:
  State& state_;
  std::uint64_t after_;
  std::vector<std::pair<std::uint64_t, base::Event>> events_;
};

class SetInputJob final : public Job {
 public:
  explicit SetInputJob(rack::InputEvent event) : event_(std::move(event)) {}

  bool run(rack::Rack& rack, base::SimTime now) override {
    try {
      rack.apply(event_, now);
    } catch (const std::exception&) {
      failed_ = true;  // checked before it came here
    }
    time_ = now;
    return true;
  }
  Response response() override {
    return failed_ ? problem(500, "the input could not be set")
                   : json_response({{"time_ns", time_.nanoseconds()}});
  }

 private:
  rack::RackEvent event_;
  base::SimTime time_;
  bool failed_ = false;
};

Json declaration_json(const Entry& entry) {
  const dictionary::EntryDescription text = describe(entry);
  Json json{{"index", text.index},     {"subindex", text.subindex},
            {"name", text.name},       {"type", text.data_type},
            {"access", text.access},   {"pdo", text.pdo_mapping},
            {"unit", text.unit},       {"minimum", text.minimum},
            {"maximum", text.maximum}, {"default", text.default_value}};
  return json;
}

Response switched_off(const DeviceRecord& device) {
  return problem(
      409, fmt::format("{} is switched off; its firmware answers when it is on", device.name));
}

class ReadEntriesJob final : public Job {
 public:
  ReadEntriesJob(const DeviceRecord& device, std::span<Entry> entries, bool whole_object)
      : device_(device), entries_(entries), whole_object_(whole_object), results_(entries.size()) {}

  bool run(rack::Rack& rack, base::SimTime /*now*/) override {
    powered_ = rack.powered(device_.address);
    if (!powered_) {
      return true;
    }
    for (std::size_t i = 0; i < kEntriesAtOnce && read_ < entries_.size(); ++i, ++read_) {
      Result& result = results_[read_];
      const auto verdict = rack.read_object(device_.address, entries_[read_], result.value);
      if (!verdict) {
        result.refusal = verdict.error();
      }
    }
    return read_ == entries_.size();
  }

  Response response() override {
    if (!powered_) {
      return switched_off(device_);
    }
    if (!whole_object_) {
      return results_[0].refusal ? problem(*results_[0].refusal) : json_response(entry(0));
    }
    Json all = Json::array();
    for (std::size_t i = 0; i < results_.size(); ++i) {
      all.push_back(entry(i));
    }
    return json_response({{"device", device_.name}, {"entries", all}});
  }

 private:
  struct Result {
    std::vector<std::byte> value;
    std::optional<dictionary::Refusal> refusal;
  };

  Json entry(std::size_t i) {
    Json json = declaration_json(entries_[i]);
    json["value"] =
        results_[i].refusal ? Json(nullptr) : to_json(entries_[i].type(), results_[i].value);
    return json;
  }

  const DeviceRecord& device_;
  std::span<Entry> entries_;
  bool whole_object_;
  std::vector<Result> results_;
  std::size_t read_ = 0;
  bool powered_ = true;
};

class WriteEntryJob final : public Job {
 public:
  WriteEntryJob(const DeviceRecord& device, Entry& entry, std::vector<std::byte> value)
      : device_(device), entry_(entry), value_(std::move(value)) {}

  bool run(rack::Rack& rack, base::SimTime now) override {
    time_ = now;
    powered_ = rack.powered(device_.address);
    if (powered_) {
      const auto verdict = rack.write_object(device_.address, entry_, value_, now);
      if (!verdict) {
        refusal_ = verdict.error();
      }
    }
    return true;
  }
  Response response() override {
    if (!powered_) {
      return switched_off(device_);
    }
    return refusal_ ? problem(*refusal_) : json_response({{"time_ns", time_.nanoseconds()}});
  }

 private:
  const DeviceRecord& device_;
  Entry& entry_;
  std::vector<std::byte> value_;
  base::SimTime time_;
  bool powered_ = true;
  std::optional<dictionary::Refusal> refusal_;
};

/// The member "value" of a body, or the answer that says what is wrong with it.
std::variant<Json, Response> value_of(const Request& request) {
  const Json body = Json::parse(request.body, nullptr, false);
  if (!body.is_object() || body.size() != 1 || !body.contains("value")) {
    return problem(400, "the body must be a JSON object with the one member \"value\"");
  }
  return body["value"];
}

struct InputAddress {
  const DeviceRecord* device = nullptr;
  const devices::Input* input = nullptr;
};

/// "gantry.axis0.load_torque"; names of devices may have dots as well.
InputAddress find_input(const State& state, std::string_view name) {
  for (const DeviceRecord& device : state.devices()) {
    if (!name.starts_with(device.name) || !name.substr(device.name.size()).starts_with('.')) {
      continue;
    }
    const auto found = std::ranges::find(*device.inputs, name.substr(device.name.size() + 1),
                                         &devices::Input::name);
    if (found != device.inputs->end()) {
      return {&device, &*found};
    }
  }
  return {};
}

Json input_json(const DeviceRecord& device, const devices::Input& input) {
  return {{"name", device.name + "." + input.name},
          {"unit", input.unit},
          {"minimum", finite(input.minimum)},
          {"maximum", finite(input.maximum)}};
}

Response list_inputs(const State& state) {
  Json all = Json::array();
  for (const DeviceRecord& device : state.devices()) {
    for (const devices::Input& input : *device.inputs) {
      all.push_back(input_json(device, input));
    }
  }
  return json_response({{"inputs", all}});
}

Answer answer_input(const Match& match, const Request& request, const State& state) {
  const InputAddress address = find_input(state, match.parameters[0]);
  if (address.input == nullptr) {
    return problem(404, "the rack has no such input; /api/v1/inputs lists all");
  }
  if (match.route->operation == Operation::input) {
    return json_response(input_json(*address.device, *address.input));
  }
  const auto value = value_of(request);
  if (const auto* wrong = std::get_if<Response>(&value)) {
    return *wrong;
  }
  const Json& number = std::get<Json>(value);
  if (!number.is_number()) {
    return problem(422, "the value of an input is a number");
  }
  const std::string wrong =
      rack::input_problem(*address.device->inputs, address.input->name, number.get<double>());
  if (!wrong.empty()) {
    return problem(422, wrong);
  }
  return std::make_unique<SetInputJob>(rack::InputEvent{.device = address.device->address,
                                                        .input = address.input->name,
                                                        .value = number.get<double>()});
}

std::optional<std::uint16_t> hexadecimal(const std::string& text, std::uint16_t maximum) {
  std::uint16_t number = 0;
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, number, 16);
  if (result.ec != std::errc() || result.ptr != end || number > maximum) {
    return std::nullopt;
  }
  return number;
}

Response list_objects(const DeviceRecord& device) {
  Json all = Json::array();
  for (const Entry& entry : device.objects->entries()) {
    all.push_back(declaration_json(entry));
  }
  return json_response({{"device", device.name}, {"entries", std::move(all)}});
}

Answer answer_object(const Match& match, const Request& request, const DeviceRecord& device) {
  const auto index = hexadecimal(match.parameters[1], 0xFFFF);
  const bool one = match.parameters.size() > 2;
  const auto subindex = one ? hexadecimal(match.parameters[2], 0xFF) : std::uint16_t{0};
  if (!index || !subindex) {
    return problem(400, "index and subindex are hexadecimal numbers without \"0x\", e.g. 6041/00");
  }
  if (!one) {
    const dictionary::Object* object = device.objects->find(*index);
    if (object == nullptr) {
      return problem(device.objects->require(*index, 0).error());
    }
    return std::make_unique<ReadEntriesJob>(device, object->entries, true);
  }
  const auto entry = device.objects->require(*index, static_cast<std::uint8_t>(*subindex));
  if (!entry) {
    return problem(entry.error());
  }
  if (!match.route->writes()) {
    return std::make_unique<ReadEntriesJob>(device, std::span(*entry, 1), false);
  }
  const auto value = value_of(request);
  if (const auto* wrong = std::get_if<Response>(&value)) {
    return *wrong;
  }
  auto bytes = to_bytes(**entry, std::get<Json>(value));
  if (!bytes) {
    return problem(bytes.error());
  }
  return std::make_unique<WriteEntryJob>(device, **entry, std::move(*bytes));
}

Answer answer_device(const Match& match, const Request& request, const State& state) {
  const DeviceRecord* device = state.find_device(match.parameters[0]);
  if (device == nullptr) {
    return problem(404, "the rack has no such device; /api/v1/devices lists all");
  }
  const Operation operation = match.route->operation;
  if (operation == Operation::device) {
    auto job = std::make_unique<SnapshotJob>(state, operation, std::vector<std::size_t>());
    job->chosen_device = static_cast<std::size_t>(device - state.devices().data());
    return job;
  }
  if (device->objects == nullptr) {
    return problem(404, fmt::format("{} has no object dictionary", device->name));
  }
  if (operation == Operation::objects) {
    return list_objects(*device);
  }
  return answer_object(match, request, *device);
}

Answer answer_signals(const Match& match, const State& state) {
  std::vector<std::size_t> chosen = state.matching(match.query.empty() ? "*" : match.query);
  if (chosen.empty() && !match.query.empty()) {
    return problem(404, "no signal matches; without \"names\" all are listed");
  }
  return std::make_unique<SnapshotJob>(state, match.route->operation, std::move(chosen));
}

Answer answer_events(const Match& match, State& state) {
  std::uint64_t after = 0;
  const char* end = match.query.data() + match.query.size();
  if (!match.query.empty() && std::from_chars(match.query.data(), end, after).ptr != end) {
    return problem(400, "\"after\" is the number of an event");
  }
  return std::make_unique<EventsJob>(state, after);
}

}  // namespace

Answer answer(const Match& match, const Request& request, State& state) {
  switch (const Operation operation = match.route->operation) {
    case Operation::page:
      return answer_asset(request, "/");
    case Operation::asset:
      return answer_asset(request, "/assets/" + match.parameters[0]);
    case Operation::openapi:
      return Response{.body = openapi_document()};
    case Operation::metrics:
      return std::make_unique<SnapshotJob>(state, operation, state.matching("*"));
    case Operation::health:
    case Operation::rack:
    case Operation::devices:
      return std::make_unique<SnapshotJob>(state, operation, std::vector<std::size_t>());
    case Operation::signals:
      return answer_signals(match, state);
    case Operation::inputs:
      return list_inputs(state);
    case Operation::input:
    case Operation::set_input:
      return answer_input(match, request, state);
    case Operation::device:
    case Operation::objects:
    case Operation::object:
    case Operation::entry:
    case Operation::write_entry:
      return answer_device(match, request, state);
    case Operation::events:
      return answer_events(match, state);
  }
  return problem(500, "a route without an answer");
}

std::unique_ptr<Job> fetch_events(State& state) {
  return std::make_unique<EventsJob>(state, UINT64_MAX);
}

}  // namespace stator::web
