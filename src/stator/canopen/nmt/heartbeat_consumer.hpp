#pragma once

#include <cstdint>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/canopen/emergency/communication_errors.hpp"
#include "stator/canopen/service.hpp"
#include "stator/dictionary/dictionary.hpp"

namespace stator::canopen {

/// Watches the heartbeats of other nodes (1016h, CiA 301 §7.5.2.19). An entry watches from the
/// first heartbeat it hears; one that does not come in time is a communication error until the next
/// comes. Works in every state but Initialisation.
class HeartbeatConsumer final : public Service {
 public:
  /// Refuses to watch one node by two entries (06040043h).
  HeartbeatConsumer(dictionary::Dictionary& dictionary, base::EventReporter reporter,
                    CommunicationErrors& errors);

  void start(base::SimTime now) override;
  bool receive(const can::Frame& frame, base::SimTime now) override;
  void advance(base::SimTime now) override;
  [[nodiscard]] base::SimTime next_deadline() const override;

 private:
  enum class Watch : std::uint8_t { unused, waiting, running, missed };
  struct Producer {
    const dictionary::Entry* entry = nullptr;
    Watch watch = Watch::unused;
    bool configuration_changed = false;
    std::uint8_t node_id = 0;
    base::SimDuration time{};
    base::SimTime due = base::SimTime::never();
  };

  [[nodiscard]] dictionary::Verdict check(const dictionary::Entry& entry, std::uint64_t value);
  void on_written(const dictionary::Entry& entry);
  void configure(Producer& producer);

  base::EventReporter reporter_;
  CommunicationErrors& errors_;
  std::vector<Producer> producers_;  ///< one per sub-index from 1
};

}  // namespace stator::canopen
