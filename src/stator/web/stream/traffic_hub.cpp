#include "stator/web/stream/traffic_hub.hpp"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <memory>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/web/json_text.hpp"
#include "stator/web/stream/can_text.hpp"
#include "stator/web/stream/ethercat_text.hpp"
#include "stator/web/stream/object_text.hpp"

namespace stator::web {

namespace {

using Json = nlohmann::ordered_json;
using Direction = rack::TrafficTap::Direction;

constexpr std::chrono::milliseconds kCollectPeriod{20};
/// Configurations of devices change when a master starts; until the next look frames are told with
/// the names of before.
constexpr std::chrono::milliseconds kMapPeriod{1000};
/// Frames decoded in one look; older ones are dropped. Enough for 10,000 frames per second.
constexpr std::size_t kMostAtOnce = 200;

std::string_view to_text(Direction direction) {
  switch (direction) {
    case Direction::request:
      return "request";
    case Direction::answer:
      return "answer";
    case Direction::bus:
    case Direction::error:
      return "bus";
  }
  return "?";
}

void append_lower_case(std::string& text, std::string_view more) {
  std::ranges::transform(more, std::back_inserter(text), [](char letter) {
    return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter;
  });
  text += '\n';
}

}  // namespace

/// Puts the tap into the rack or takes it out.
class TrafficHub::WatchJob final : public ActJob {
 public:
  WatchJob(rack::TrafficTap* tap, bool& inside) : tap_(tap), inside_(inside) {}

  bool act(rack::Rack& rack, base::SimTime /*now*/) override {
    rack.watch_traffic(tap_);
    return true;
  }
  [[nodiscard]] bool changes() const override { return false; }
  Response response() override {
    inside_ = tap_ != nullptr;
    return {};
  }

 private:
  rack::TrafficTap* tap_;
  bool& inside_;
};

TrafficHub::TrafficHub(State& state, RackAccess& access)
    : state_(state), access_(access), map_(empty_traffic_map(state)) {
  const rack::RackConfiguration& configuration = state.configuration();
  for (std::size_t i = 0; i < configuration.segments.size(); ++i) {
    networks_.push_back(fmt::format("segment {}", i));
  }
  for (const rack::BusConfiguration& bus : configuration.buses) {
    networks_.push_back(bus.name);
  }
}

void TrafficHub::add(TrafficWatcher& watcher) {
  watchers_.push_back(&watcher);
}

void TrafficHub::remove(const TrafficWatcher& watcher) {
  std::erase(watchers_, &watcher);
}

void TrafficHub::tick(RackAccess::Clock::time_point now) {
  const bool wanted = !watchers_.empty();
  mapped_ &= wanted;
  if (!under_way_ && wanted && (!mapped_ || now >= next_map_)) {
    mapped_ |= post(make_traffic_map_job(state_, map_));
    next_map_ = now + kMapPeriod;
  } else if (!under_way_ && wanted != inside_) {
    if (!tap_) {
      tap_.emplace();
    }
    static_cast<void>(post(std::make_unique<WatchJob>(wanted ? &*tap_ : nullptr, inside_)));
  }
  if (inside_ && now >= next_collect_) {
    next_collect_ = now + kCollectPeriod;
    collect();
  }
}

// The pointer owns nothing: the server owns both this hub and the access that gets the pointer.
bool TrafficHub::post(std::unique_ptr<Job> job) {
  under_way_ = access_.post(std::move(job), std::shared_ptr<Waiter>(std::shared_ptr<void>(), this));
  return under_way_;
}

// Called when the rack is late, too: the job is carried out nevertheless, in order with later ones.
void TrafficHub::answer(Response /*response*/) {
  under_way_ = false;
}

void TrafficHub::collect() {
  std::uint64_t skipped = tap_->lost() - std::exchange(lost_, tap_->lost());
  std::vector<rack::TrafficTap::Record> records;
  while (auto record = tap_->take()) {
    records.push_back(std::move(*record));
    if (records.size() == 2 * kMostAtOnce) {
      records.erase(records.begin(), records.begin() + kMostAtOnce);
      skipped += kMostAtOnce;
    }
  }
  if (watchers_.empty() || (records.empty() && skipped == 0)) {
    return;
  }
  const std::size_t first = records.size() > kMostAtOnce ? records.size() - kMostAtOnce : 0;
  skipped += first;
  std::vector<TrafficFrame> frames;
  frames.reserve(records.size() - first);
  for (std::size_t i = first; i < records.size(); ++i) {
    frames.push_back(describe(records[i]));
  }
  for (TrafficWatcher* watcher : watchers_) {
    watcher->show(frames, skipped);
  }
}

TrafficFrame TrafficHub::describe(const rack::TrafficTap::Record& record) const {
  const auto& header = record.header;
  DecodedFrame decoded;
  std::string raw;
  if (header.network < map_.segments.size()) {
    decoded = describe_ethercat(record.bytes, header.direction == Direction::answer,
                                map_.segments[header.network]);
    raw = hexadecimal_text(record.bytes);
  } else if (const auto frame = rack::TrafficTap::decode_can(record.bytes)) {
    decoded = describe_can(*frame, map_.buses[header.network - map_.segments.size()]);
    raw = hexadecimal_text(frame->payload());
    if (header.direction == Direction::error) {
      decoded.summary = "error frame instead of " + decoded.summary;
    }
  }
  Json fields = Json::array();
  TrafficFrame shown{.network = header.network};
  append_lower_case(shown.words, decoded.summary);
  for (auto& [name, value] : decoded.fields) {
    append_lower_case(shown.words, name);
    append_lower_case(shown.words, value);
    fields.push_back({std::move(name), std::move(value)});
  }
  shown.json = text_of({{"number", header.number},
                        {"time_ns", header.time.nanoseconds()},
                        {"network", networks_[header.network]},
                        {"direction", to_text(header.direction)},
                        {"summary", decoded.summary},
                        {"fields", std::move(fields)},
                        {"raw", raw}});
  return shown;
}

}  // namespace stator::web
