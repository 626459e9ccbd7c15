#pragma once

#include <memory>
#include <variant>

#include "rack/desk.hpp"
#include "web/message.hpp"
#include "web/routes.hpp"
#include "web/state.hpp"

namespace stator::web {

/// A request on its way through the rack's desk.
class Job : public rack::DeskTask {
 public:
  /// What came of it, once it is done. In the server's thread.
  [[nodiscard]] virtual Response response() = 0;
};

/// Answers a request that may pass: at once, or by way of the rack. Changes nothing but `state`.
[[nodiscard]] std::variant<Response, std::unique_ptr<Job>> answer(const Match& match,
                                                                  const Request& request,
                                                                  State& state);

/// Fetches the events that have come; its response is of no use.
[[nodiscard]] std::unique_ptr<Job> fetch_events(State& state);

}  // namespace stator::web
