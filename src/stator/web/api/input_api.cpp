#include "stator/web/api/input_api.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "stator/rack/world/input_names.hpp"
#include "stator/web/api/request_body.hpp"
#include "stator/web/json_text.hpp"
#include "stator/web/problem.hpp"

namespace stator::web {

namespace {

using Json = nlohmann::ordered_json;

class SetInputJob final : public ActJob {
 public:
  explicit SetInputJob(rack::InputEvent event) : event_(std::move(event)) {}

  bool act(rack::Rack& rack, base::SimTime now) override {
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

struct InputAddress {
  const DeviceRecord* device = nullptr;
  const product::InputRange* input = nullptr;
};

/// "gantry.axis0.load_torque"; names of devices may have dots as well.
InputAddress find_input(const State& state, std::string_view name) {
  for (const DeviceRecord& device : state.devices()) {
    if (!name.starts_with(device.name) || !name.substr(device.name.size()).starts_with('.')) {
      continue;
    }
    const auto found = std::ranges::find(*device.inputs, name.substr(device.name.size() + 1),
                                         &product::InputRange::name);
    if (found != device.inputs->end()) {
      return {&device, &*found};
    }
  }
  return {};
}

/// Tells inputs with what they have been set to.
class ReadInputsJob final : public LookJob {
 public:
  explicit ReadInputsJob(bool list) : list_(list) {}

  void add(const InputAddress& address) {
    inputs_.push_back({.address = address,
                       .key = {address.device->address, address.input->name},
                       .value = std::nullopt});
  }

  /// Some of the inputs in each call.
  bool look(const rack::View& rack, base::SimTime /*now*/) override {
    for (std::size_t i = 0; i < kInputsAtOnce && read_ < inputs_.size(); ++i, ++read_) {
      inputs_[read_].value = rack.input_value(inputs_[read_].key);
    }
    return read_ == inputs_.size();
  }

  Response response() override {
    Json all = Json::array();
    for (const ReadInput& input : inputs_) {
      const auto& [device, declared] = input.address;
      all.push_back({{"name", device->name + "." + declared->name},
                     {"unit", declared->unit},
                     {"minimum", finite(declared->minimum)},
                     {"maximum", finite(declared->maximum)},
                     {"group", base::name_of(declared->group)},
                     {"normal", declared->normal},
                     {"value", input.value ? Json(*input.value) : Json(nullptr)}});
    }
    return json_response(list_ ? Json{{"inputs", std::move(all)}} : std::move(all.front()));
  }

 private:
  static constexpr std::size_t kInputsAtOnce = 16;
  struct ReadInput {
    InputAddress address;
    std::pair<rack::DeviceAddress, std::string> key;
    std::optional<double> value;
  };
  std::vector<ReadInput> inputs_;
  std::size_t read_ = 0;
  bool list_;
};

std::unique_ptr<Job> read_all_inputs(const State& state) {
  auto job = std::make_unique<ReadInputsJob>(true);
  for (const DeviceRecord& device : state.devices()) {
    for (const product::InputRange& input : *device.inputs) {
      job->add({&device, &input});
    }
  }
  return job;
}

std::unique_ptr<Job> read_input(const InputAddress& address) {
  auto job = std::make_unique<ReadInputsJob>(false);
  job->add(address);
  return job;
}

}  // namespace

Answer answer_inputs(const Match& match, const Request& request, const State& state) {
  if (match.route->operation == Operation::inputs) {
    return read_all_inputs(state);
  }
  const InputAddress address = find_input(state, match.parameters[0]);
  if (address.input == nullptr) {
    return problem(404, "the rack has no such input; /api/v1/inputs lists all");
  }
  if (match.route->operation == Operation::input) {
    return read_input(address);
  }
  const auto value = member_of(request, "value");
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

}  // namespace stator::web
