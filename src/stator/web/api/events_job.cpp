#include "stator/web/api/events_job.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "stator/rack/observe/event_log.hpp"
#include "stator/web/json_text.hpp"

namespace stator::web {

namespace {

using Json = nlohmann::ordered_json;

/// Events copied in one look at the task queue.
constexpr std::uint64_t kEventsAtOnce = 64;

class EventsJob final : public LookJob {
 public:
  EventsJob(State& state, std::uint64_t after) : state_(state), after_(after) {
    events_.reserve(rack::EventLog::kKept);
  }

  bool look(const rack::View& /*rack*/, base::SimTime /*now*/) override {
    std::uint64_t& fetched = state_.fetched();
    std::uint64_t left = kEventsAtOnce;
    bool all = true;
    state_.log().visit(fetched, [&](std::uint64_t number, const base::Event& event) {
      if (left == 0) {
        all = false;
        return false;
      }
      if (events_.size() == events_.capacity()) {
        return false;
      }
      --left;
      fetched = number;
      events_.emplace_back(number, event);
      return true;
    });
    return all;
  }

  Response response() override {
    for (const auto& [number, event] : events_) {
      state_.take_event(number, event);
    }
    Json all = Json::array();
    for (const EventRecord& event : state_.events()) {
      if (event.number > after_) {
        all.push_back(to_json(event));
      }
    }
    return json_response({{"events", std::move(all)}});
  }

 private:
  State& state_;
  std::uint64_t after_;
  std::vector<std::pair<std::uint64_t, base::Event>> events_;
};

}  // namespace

std::unique_ptr<Job> make_events_job(State& state, std::uint64_t after) {
  return std::make_unique<EventsJob>(state, after);
}

}  // namespace stator::web
