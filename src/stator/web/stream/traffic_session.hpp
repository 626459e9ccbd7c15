#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "stator/web/stream/message_queue.hpp"
#include "stator/web/stream/stream_session.hpp"
#include "stator/web/stream/traffic_hub.hpp"

namespace stator::web {

/// A client that watches what passes over the networks.
class TrafficSession final : public StreamSession, public TrafficWatcher {
 public:
  explicit TrafficSession(TrafficHub& hub) : hub_(hub) {}
  ~TrafficSession() override { hub_.remove(*this); }
  TrafficSession(const TrafficSession&) = delete;
  TrafficSession& operator=(const TrafficSession&) = delete;

  /// {"networks": ["segment 0"], "filter": "statusword", "frames": true}; no networks: all.
  void take(std::string_view message) override;
  [[nodiscard]] bool ready() const override { return true; }
  [[nodiscard]] bool empty() const override { return queue_.empty(); }
  [[nodiscard]] std::string next() override { return queue_.take().text; }
  void end() override { hub_.remove(*this); }

  void show(const std::vector<TrafficFrame>& frames, std::uint64_t lost) override;

 private:
  void push_problem(std::string_view detail);

  TrafficHub& hub_;
  MessageQueue queue_;
  std::vector<bool> networks_;  ///< by number
  std::string filter_;          ///< in lower case
  bool watching_ = false;
  std::uint64_t dropped_ = 0;
};

}  // namespace stator::web
