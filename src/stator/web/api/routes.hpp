#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "stator/web/message.hpp"

namespace stator::web {

/// What can be asked for, one for each row of the table of routes.
enum class Operation : std::uint8_t {
  page,
  asset,
  health,
  metrics,
  openapi,
  rack,
  devices,
  device,
  signals,
  inputs,
  input,
  set_input,
  objects,
  object,
  entry,
  write_entry,
  events,
  recording,
  recording_content,
  start_recording,
  stop_recording,
  snapshots,
  take_snapshot,
  restore_snapshot,
  wiring,
  connections,
  panel,
  state_machines,
  program,
  traffic,
  keys,
  rack_file,
  check_rack,
  run_rack,
  fault_kinds,
  faults,
  inject_fault,
  clear_fault,
  clear_faults,
  manual,
  begin_manual,
  end_manual,
  command_axis,
};

struct QueryParameter {
  std::string_view name;
  std::string_view type;  ///< of a JSON schema
  std::string_view description;
};

/// A route is declared once; who may use it, method errors and the OpenAPI document follow.
struct Route {
  Operation operation;
  std::string_view method;
  std::string_view path;  ///< "{name}" stands for one segment
  std::string_view id;    ///< of the operation in the OpenAPI document
  std::string_view summary;
  std::string_view schema;            ///< of the answer, in the OpenAPI document; empty: text
  std::string_view request_schema{};  ///< of the body; empty: it takes none
  QueryParameter query{};             ///< none if it has no name
  bool open = false;                  ///< needs no token wherever the request comes from
  std::string_view content_type = "application/json";  ///< "*/*": one that fits the file
  unsigned status = 200;  ///< of an answer without error; 101: there is nothing but a WebSocket
  bool kept = false;      ///< by clients, which may ask whether it has changed
  /// What a WebSocket that is opened at the same place sends and takes; empty: there is none.
  std::string_view server_messages{};
  std::string_view client_messages{};

  [[nodiscard]] bool writes() const { return method != "GET"; }
  [[nodiscard]] bool stream() const { return !server_messages.empty(); }
};

[[nodiscard]] std::span<const Route> routes();

/// A request's way to a route.
struct Match {
  const Route* route = nullptr;
  std::vector<std::string> parameters;  ///< decoded, in the order of the path
  std::string query;                    ///< value of the route's parameter; empty: not given
};

/// Finds the route, or the answer that says why there is none: no such path, or not this method.
/// HEAD is taken as GET.
[[nodiscard]] std::variant<Match, Response> find_route(const Request& request);

/// Describes all routes (OpenAPI 3.1).
[[nodiscard]] std::string openapi_document();

}  // namespace stator::web
