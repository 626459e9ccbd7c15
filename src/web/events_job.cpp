#include "web/events_job.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "web/json_text.hpp"

namespace stator::web {

namespace {

using Json = nlohmann::ordered_json;

/// Events copied in one look at the desk.
constexpr std::uint64_t kEventsAtOnce = 64;

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

}  // namespace

std::unique_ptr<Job> make_events_job(State& state, std::uint64_t after) {
  return std::make_unique<EventsJob>(state, after);
}

}  // namespace stator::web
