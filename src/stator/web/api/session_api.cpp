#include "stator/web/api/session_api.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "stator/web/api/request_body.hpp"
#include "stator/web/json_text.hpp"
#include "stator/web/problem.hpp"

namespace stator::web {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kLongestName = 64;
constexpr std::size_t kPiece = std::size_t{1} << 20U;
constexpr std::string_view kNothingRecorded =
    "nothing is recorded; start with \"stator run ... --record NAME.stator\"";

class SessionJob final : public ActJob {
 public:
  SessionJob(SessionControl& control, Operation operation, std::string name)
      : control_(control), operation_(operation), name_(std::move(name)) {}

  bool act(rack::Rack& /*rack*/, base::SimTime now) override {
    time_ = now;
    recording_ = control_.recording();
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
      case Operation::start_recording:
        refusal_ = control_.start_recording(name_);
        break;
      case Operation::stop_recording:
        done_ = control_.stop_recording();
        break;
      default:
        break;
    }
    return true;
  }

  Response response() override {
    switch (operation_) {
      case Operation::take_snapshot:
        return done_or(409,
                       recording_.running
                           ? "there is a snapshot of this name, or the recording has broken off"
                           : kNothingRecorded);
      case Operation::restore_snapshot:
        return recording_.file.empty()
                   ? problem(409, kNothingRecorded)
                   : done_or(404, "there is no such snapshot; /api/v1/snapshots lists all");
      case Operation::stop_recording:
        return done_or(409, "nothing is recorded");
      case Operation::start_recording:
        done_ = refusal_.empty();
        return done_or(409, refusal_);
      case Operation::snapshots: {
        Json all = Json::array();
        for (const SessionControl::Snapshot& snapshot : snapshots_) {
          all.push_back({{"name", snapshot.name}, {"time_ns", snapshot.time.nanoseconds()}});
        }
        return json_response({{"snapshots", all}});
      }
      default:
        return to_response(recording_);
    }
  }

  static Response to_response(const SessionControl::Recording& recording) {
    return json_response({{"file", recording.file.empty() ? Json(nullptr) : Json(recording.file)},
                          {"time_ns", recording.time.nanoseconds()},
                          {"bytes", recording.bytes},
                          {"complete", recording.complete},
                          {"running", recording.running}});
  }

 private:
  [[nodiscard]] Response done_or(unsigned status, std::string_view otherwise) const {
    return done_ ? json_response({{"time_ns", time_.nanoseconds()}}) : problem(status, otherwise);
  }

  SessionControl& control_;
  Operation operation_;
  std::string name_;
  bool done_ = false;
  std::string refusal_;
  base::SimTime time_;
  SessionControl::Recording recording_;
  std::vector<SessionControl::Snapshot> snapshots_;
};

Response piece(const std::string& from, SessionControl& control) {
  std::uint64_t begin = 0;
  const char* const end = from.data() + from.size();
  if (!from.empty() && std::from_chars(from.data(), end, begin).ptr != end) {
    return problem(400, "\"from\" is a number of bytes");
  }
  return {.content_type = "application/octet-stream", .body = control.content(begin, kPiece)};
}

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
    return SessionJob::to_response({.running = false});
  }
  if (control == nullptr && match.route->operation == Operation::snapshots) {
    return json_response({{"snapshots", Json::array()}});
  }
  if (control == nullptr) {
    return problem(409, kNothingRecorded);
  }
  const Operation operation = match.route->operation;
  if (operation == Operation::recording_content) {
    return piece(match.query, *control);
  }
  std::string name;
  if (operation == Operation::take_snapshot || operation == Operation::start_recording) {
    const auto value = member_of(request, "name");
    if (const auto* wrong = std::get_if<Response>(&value)) {
      return *wrong;
    }
    const Json& given = std::get<Json>(value);
    name = given.is_string() ? given.get<std::string>() : std::string();
    if (!is_snapshot_name(name)) {
      return problem(422,
                     "the name of a snapshot or recording has 1 to 64 letters of ASCII, digits, "
                     "\"-\" and \"_\", no "
                     "digit first");
    }
  } else if (operation == Operation::restore_snapshot) {
    name = match.parameters[0];
  }
  return std::make_unique<SessionJob>(*control, operation, std::move(name));
}

}  // namespace stator::web
