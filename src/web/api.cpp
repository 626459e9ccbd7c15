#include "web/api.hpp"

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <system_error>
#include <utility>
#include <vector>

#include "web/assets.hpp"
#include "web/events_job.hpp"
#include "web/input_api.hpp"
#include "web/object_api.hpp"
#include "web/problem.hpp"
#include "web/snapshot_job.hpp"

namespace stator::web {

namespace {

Answer answer_device(const Match& match, const Request& request, const State& state) {
  const DeviceRecord* device = state.find_device(match.parameters[0]);
  if (device == nullptr) {
    return problem(404, "the rack has no such device; /api/v1/devices lists all");
  }
  const Operation operation = match.route->operation;
  if (operation == Operation::device) {
    return make_snapshot_job(state, operation, {},
                             static_cast<std::size_t>(device - state.devices().data()));
  }
  return answer_objects(match, request, *device);
}

Answer answer_signals(const Match& match, const State& state) {
  std::vector<std::size_t> chosen = state.matching(match.query.empty() ? "*" : match.query);
  if (chosen.empty() && !match.query.empty()) {
    return problem(404, "no signal matches; without \"names\" all are listed");
  }
  return make_snapshot_job(state, match.route->operation, std::move(chosen));
}

Answer answer_events(const Match& match, State& state) {
  std::uint64_t after = 0;
  const char* end = match.query.data() + match.query.size();
  if (!match.query.empty() && std::from_chars(match.query.data(), end, after).ptr != end) {
    return problem(400, "\"after\" is the number of an event");
  }
  return make_events_job(state, after);
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
      return make_snapshot_job(state, operation, state.matching("*"));
    case Operation::health:
    case Operation::rack:
    case Operation::devices:
      return make_snapshot_job(state, operation);
    case Operation::signals:
      return answer_signals(match, state);
    case Operation::inputs:
    case Operation::input:
    case Operation::set_input:
      return answer_inputs(match, request, state);
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
}  // namespace stator::web
