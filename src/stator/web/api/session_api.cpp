#include "stator/web/api/session_api.hpp"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "stator/web/api/request_body.hpp"
#include "stator/web/json_text.hpp"
#include "stator/web/problem.hpp"

namespace stator::web {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kLongestName = 64;

class SessionJob final : public ActJob {
 public:
  SessionJob(SessionControl& control, Operation operation, std::string name)
      : control_(control), operation_(operation), name_(std::move(name)) {}

  bool act(rack::Rack& /*rack*/, base::SimTime now) override {
    time_ = now;
    switch (operation_) {
      case Operation::take_snapshot:
        done_ = control_.take_snapshot(name_);
        break;
      case Operation::restore_snapshot:
        done_ = control_.restore(name_);
        break;
      case Operation::snapshots:
        snapshots_ = control_.snapshots();
        break;
      default:
        recording_ = control_.recording();
        break;
    }
    return true;
  }

  Response response() override {
    switch (operation_) {
      case Operation::take_snapshot:
        return done_ ? json_response({{"time_ns", time_.nanoseconds()}})
                     : problem(409,
                               "there is a snapshot of this name, or the recording has broken off");
      case Operation::restore_snapshot:
        return done_ ? json_response({{"time_ns", time_.nanoseconds()}})
                     : problem(404, "there is no such snapshot; /api/v1/snapshots lists all");
      case Operation::snapshots: {
        Json all = Json::array();
        for (const SessionControl::Snapshot& snapshot : snapshots_) {
          all.push_back({{"name", snapshot.name}, {"time_ns", snapshot.time.nanoseconds()}});
        }
        return json_response({{"snapshots", all}});
      }
      default:
        return json_response({{"file", recording_.file},
                              {"time_ns", recording_.time.nanoseconds()},
                              {"bytes", recording_.bytes},
                              {"complete", recording_.complete}});
    }
  }

 private:
  SessionControl& control_;
  Operation operation_;
  std::string name_;
  bool done_ = false;
  base::SimTime time_;
  SessionControl::Recording recording_;
  std::vector<SessionControl::Snapshot> snapshots_;
};

}  // namespace

bool is_snapshot_name(std::string_view text) {
  const bool digit = !text.empty() && text.front() >= '0' && text.front() <= '9';
  return !text.empty() && !digit && text.size() <= kLongestName &&
         std::ranges::all_of(text, [](char letter) {
           return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
                  (letter >= '0' && letter <= '9') || letter == '-' || letter == '_';
         });
}

Answer answer_session(const Match& match, const Request& request, SessionControl* control) {
  if (control == nullptr && match.route->operation == Operation::recording) {
    return json_response({{"file", nullptr}, {"time_ns", 0}, {"bytes", 0}, {"complete", true}});
  }
  if (control == nullptr && match.route->operation == Operation::snapshots) {
    return json_response({{"snapshots", Json::array()}});
  }
  if (control == nullptr) {
    return problem(409, "nothing is recorded; start with \"stator run ... --record NAME.stator\"");
  }
  const Operation operation = match.route->operation;
  std::string name;
  if (operation == Operation::take_snapshot) {
    const auto value = member_of(request, "name");
    if (const auto* wrong = std::get_if<Response>(&value)) {
      return *wrong;
    }
    const Json& given = std::get<Json>(value);
    name = given.is_string() ? given.get<std::string>() : std::string();
    if (!is_snapshot_name(name)) {
      return problem(422,
                     "a snapshot's name has 1 to 64 letters of ASCII, digits, \"-\" and \"_\", no "
                     "digit first");
    }
  } else if (operation == Operation::restore_snapshot) {
    name = match.parameters[0];
  }
  return std::make_unique<SessionJob>(*control, operation, std::move(name));
}

}  // namespace stator::web
