#pragma once

#include <cstdint>

#include "stator/base/sim_time.hpp"
#include "stator/can/frame.hpp"
#include "stator/canopen/pdo/pdo_mapping.hpp"
#include "stator/canopen/pdo/pdo_rules.hpp"
#include "stator/dictionary/dictionary.hpp"

namespace stator::canopen {

/// One receive PDO (CiA 301 §7.2.2, objects 14xxh and 16xxh). It is told of frames that carry its
/// CAN-ID; where they go and what is reported is PdoService's business.
class ReceivePdo {
 public:
  /// What became of a frame.
  enum class Reception : std::uint8_t {
    written,    ///< its values are in the dictionary
    waiting,    ///< they will be at the next SYNC
    too_short,  ///< not taken
    too_long,   ///< not taken
    no_mapping  ///< nothing is mapped: the frame means nothing
  };

  /// `number` counts from 0 for 1400h; both its objects must exist.
  ReceivePdo(dictionary::Dictionary& dictionary, std::uint16_t number, const PdoRules& limits);

  /// Do its objects make another PDO of it, with another mapping or CAN-ID, or take it away?
  [[nodiscard]] bool becomes_another() const;
  /// Follows its objects anew. What waits for a SYNC is forgotten only if it becomes another PDO.
  void configure();
  /// Leaves Operational: what waits for a SYNC and when the next frame was due is forgotten.
  void stop();

  [[nodiscard]] std::uint16_t number() const { return number_; }
  [[nodiscard]] bool valid() const { return valid_; }
  [[nodiscard]] std::uint16_t can_id() const { return can_id_; }
  [[nodiscard]] bool synchronous() const { return type_ <= kLastCyclicSynchronous; }
  [[nodiscard]] PdoMapping& mapping() { return mapping_; }
  [[nodiscard]] const PdoMapping& mapping() const { return mapping_; }

  /// Takes a data frame with its CAN-ID.
  Reception receive(const can::Frame& frame, base::SimTime now, PdoMapping::RefusedHook on_refused);
  /// A SYNC has come: brings waiting values into the dictionary; false if there were none.
  bool apply(PdoMapping::RefusedHook on_refused);

  /// Its objects were written; configure() is still to be called.
  bool changed = false;
  /// The emergency code by which the length of the last frame was reported; 0: it was right.
  std::uint16_t length_error = 0;
  /// The emergency code 8250h was raised and holds.
  bool timed_out = false;

  /// When the next frame must have come at the latest (14xxh:05); never() while nothing is
  /// expected.
  [[nodiscard]] base::SimTime deadline() const { return deadline_; }
  [[nodiscard]] bool supervised() const { return timeout_ > base::SimDuration(); }
  /// The frame expected has not come; the next one starts the supervision again.
  void expire() { deadline_ = base::SimTime::never(); }

 private:
  std::uint16_t number_;
  const PdoRules* rules_;
  const dictionary::Entry* cob_id_;
  const dictionary::Entry* transmission_type_;
  const dictionary::Entry* event_timer_;  ///< null where not declared
  PdoMapping mapping_;

  bool valid_ = false;
  std::uint16_t can_id_ = 0;
  std::uint8_t type_ = kEventDrivenManufacturer;
  base::SimDuration timeout_;
  base::SimTime deadline_ = base::SimTime::never();
  std::uint64_t data_ = 0;
  bool waiting_ = false;
};

}  // namespace stator::canopen
