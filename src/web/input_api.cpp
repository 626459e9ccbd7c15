#include "web/input_api.hpp"

#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "rack/input_names.hpp"
#include "web/json_text.hpp"
#include "web/problem.hpp"
#include "web/request_body.hpp"

namespace stator::web {

namespace {

using Json = nlohmann::ordered_json;

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

}  // namespace

Answer answer_inputs(const Match& match, const Request& request, const State& state) {
  if (match.route->operation == Operation::inputs) {
    return list_inputs(state);
  }
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

}  // namespace stator::web
