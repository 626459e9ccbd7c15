#pragma once

#include <cstdint>

#include "stator/base/event.hpp"
#include "stator/can/transmitter.hpp"
#include "stator/canopen/emergency/communication_errors.hpp"
#include "stator/canopen/service.hpp"
#include "stator/dictionary/dictionary.hpp"

namespace stator::canopen {

/// Error control of the node itself (CiA 301 §7.2.8.3.2): the heartbeat it produces (1017h), or, as
/// long as it produces none, node guarding and life guarding (100Ch, 100Dh). Works in every state
/// but Initialisation.
///
/// A heartbeat time acts when it is written: the first heartbeat comes at once. Where it is there
/// from the beginning, the boot-up message stands for the first one. Guarding requests are answered
/// if 100Ch is declared. Life guarding begins with the first request.
class ErrorControl final : public Service {
 public:
  ErrorControl(dictionary::Dictionary& dictionary, can::Transmitter& transmitter,
               base::EventReporter reporter, CommunicationErrors& errors);

  /// To be called before start().
  void set_node_id(std::uint8_t node_id) { node_id_ = node_id; }

  void start(base::SimTime now) override;
  void on_state(NmtState state, base::SimTime now) override;
  bool receive(const can::Frame& frame, base::SimTime now) override;
  void advance(base::SimTime now) override;
  [[nodiscard]] base::SimTime next_deadline() const override;

 private:
  enum class LifeGuarding : std::uint8_t { waiting, running, expired };

  void on_written(const dictionary::Entry& entry);
  void apply_configuration(base::SimTime now);
  void stop_life_guarding(base::SimTime now);
  [[nodiscard]] base::SimDuration heartbeat_time() const;
  [[nodiscard]] base::SimDuration life_time() const;
  void send_state(unsigned toggle);

  can::Transmitter& transmitter_;
  base::EventReporter reporter_;
  CommunicationErrors& errors_;
  // Null where the object is not declared.
  const dictionary::Entry* producer_heartbeat_time_;  ///< 1017h, ms
  const dictionary::Entry* guard_time_;               ///< 100Ch, ms
  const dictionary::Entry* life_time_factor_;         ///< 100Dh
  std::uint8_t node_id_ = 0;
  NmtState state_ = NmtState::initialisation;
  bool configuration_changed_ = false;  ///< one of the three objects was written
  bool heartbeat_changed_ = false;      ///< it was 1017h
  base::SimTime heartbeat_due_ = base::SimTime::never();
  bool toggle_ = false;
  LifeGuarding life_guarding_ = LifeGuarding::waiting;
  base::SimTime life_end_ = base::SimTime::never();
};

}  // namespace stator::canopen
