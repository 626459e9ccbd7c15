#pragma once

#include <cstdint>

#include "stator/can/transmitter.hpp"
#include "stator/canopen/service.hpp"
#include "stator/canopen/sync/sync_consumer.hpp"
#include "stator/dictionary/dictionary.hpp"

namespace stator::canopen {

/// Sends SYNC messages (CiA 301 §7.2.5) while bit 30 of 1005h is set and 1006h is not 0, in
/// Pre-operational and Operational. The node takes part in them as in those of others.
///
/// The counter (1019h) begins with 1 at the boot-up, when production begins, and when the node
/// leaves Stopped.
class SyncProducer final : public Service {
 public:
  /// 1005h and 1006h must be declared. `consumer` is told of each SYNC; both arguments must outlive
  /// the producer.
  SyncProducer(dictionary::Dictionary& dictionary, can::Transmitter& transmitter,
               SyncConsumer& consumer);

  void start(base::SimTime now) override;
  void on_state(NmtState state, base::SimTime now) override;
  void advance(base::SimTime now) override;
  [[nodiscard]] base::SimTime next_deadline() const override;

  [[nodiscard]] std::uint64_t sent() const { return sent_; }

 private:
  void on_written(const dictionary::Entry& entry);
  void follow_objects(base::SimTime now);
  void produce(base::SimTime now);

  can::Transmitter& transmitter_;
  SyncConsumer& consumer_;
  const dictionary::Entry* cob_id_;
  const dictionary::Entry* period_;
  const dictionary::Entry* overflow_;  ///< null where not declared
  NmtState state_ = NmtState::initialisation;
  bool changed_ = false;
  std::uint8_t counter_ = 1;
  base::SimTime due_ = base::SimTime::never();
  std::uint64_t sent_ = 0;
};

}  // namespace stator::canopen
