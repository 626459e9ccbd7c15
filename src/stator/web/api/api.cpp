#include "stator/web/api/api.hpp"

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <system_error>
#include <utility>
#include <vector>

#include "stator/web/api/assets.hpp"
#include "stator/web/api/events_job.hpp"
#include "stator/web/api/fault_api.hpp"
#include "stator/web/api/input_api.hpp"
#include "stator/web/api/manual_api.hpp"
#include "stator/web/api/object_api.hpp"
#include "stator/web/api/panel_api.hpp"
#include "stator/web/api/program_job.hpp"
#include "stator/web/api/rack_file_api.hpp"
#include "stator/web/api/session_api.hpp"
#include "stator/web/api/snapshot_job.hpp"
#include "stator/web/api/state_machines.hpp"
#include "stator/web/api/wiring_job.hpp"
#include "stator/web/problem.hpp"

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
  if (operation == Operation::panel) {
    return make_panel_job(state, *device);
  }
  if (operation == Operation::program) {
    return make_program_job(*device);
  }
  if (operation == Operation::manual || operation == Operation::begin_manual ||
      operation == Operation::end_manual || operation == Operation::command_axis) {
    return answer_manual(match, request, state, *device);
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
    case Operation::keys:
      return Response{.body = state.keys()};
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
    case Operation::wiring:
      return make_wiring_job(state);
    case Operation::connections:
      return describe_connections(state);
    case Operation::state_machines:
      return describe_state_machines();
    case Operation::traffic:
      return problem(426, "what passes over the networks comes over a WebSocket at this path");
    case Operation::device:
    case Operation::panel:
    case Operation::program:
    case Operation::objects:
    case Operation::object:
    case Operation::entry:
    case Operation::write_entry:
    case Operation::manual:
    case Operation::begin_manual:
    case Operation::end_manual:
    case Operation::command_axis:
      return answer_device(match, request, state);
    case Operation::events:
      return answer_events(match, state);
    case Operation::recording:
    case Operation::recording_content:
    case Operation::start_recording:
    case Operation::stop_recording:
    case Operation::snapshots:
    case Operation::take_snapshot:
    case Operation::restore_snapshot:
      return answer_session(match, request, state.session);
    case Operation::rack_file:
    case Operation::check_rack:
    case Operation::run_rack:
      return answer_rack_file(match, request, state);
    case Operation::fault_kinds:
    case Operation::faults:
    case Operation::inject_fault:
    case Operation::clear_fault:
    case Operation::clear_faults:
      return answer_faults(match, request, state);
  }
  return problem(500, "a route without an answer");
}
}  // namespace stator::web
