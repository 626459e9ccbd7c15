#pragma once

#include <cstdint>
#include <optional>

#include "stator/base/sim_time.hpp"
#include "stator/can/transmitter.hpp"
#include "stator/canopen/pdo/pdo_mapping.hpp"
#include "stator/canopen/pdo/pdo_rules.hpp"
#include "stator/dictionary/dictionary.hpp"

namespace stator::canopen {

/// One transmit PDO (CiA 301 §7.2.2, objects 18xxh and 1Axxh): when it is sent, with which data.
///
/// An event is a change of a mapped value, the event timer, a request of the application, the start
/// of process data, and a change of the PDO's COB-ID, transmission type or mapping. Types 254 and
/// 255 answer it at once, or after the inhibit time, which counts from the last transmission
/// whatever has happened since; type 0 answers at the next SYNC.
class TransmitPdo {
 public:
  /// `number` counts from 0 for 1800h; both its objects must exist.
  TransmitPdo(dictionary::Dictionary& dictionary, std::uint16_t number,
              can::Transmitter& transmitter, const PdoRules& limits);

  /// Nothing has been sent since the node's reset.
  void reset();
  /// Follows its objects anew; a new event timer counts from now. True if they make another PDO of
  /// it, for which start() is to be called in Operational.
  bool configure(base::SimTime now);
  /// Operational begins, or it became another PDO in Operational: that is an event.
  void start(base::SimTime now);
  void stop();

  [[nodiscard]] std::uint16_t number() const { return number_; }
  [[nodiscard]] bool valid() const { return valid_; }
  [[nodiscard]] std::uint16_t can_id() const { return can_id_; }
  [[nodiscard]] bool answers_remote_frames() const { return valid_ && remote_; }
  [[nodiscard]] PdoMapping& mapping() { return mapping_; }
  [[nodiscard]] const PdoMapping& mapping() const { return mapping_; }

  /// Its objects were written; configure() is still to be called.
  bool changed = false;

  /// Mapped values may have changed; if one has, that is an event. False: nothing has happened.
  bool values_may_have_changed(base::SimTime now);
  /// The application asks for a transmission.
  void request(base::SimTime now);
  /// A SYNC has come, with its counter or 0 if it has none.
  void on_sync(std::uint8_t counter, base::SimTime now);
  void on_remote_frame(base::SimTime now);
  /// Does what is due: the event timer, or an event that waited for the inhibit time.
  void advance(base::SimTime now);
  [[nodiscard]] base::SimTime next_deadline() const;

  [[nodiscard]] std::uint64_t sent() const { return sent_; }
  /// Transmissions that found the transmitter full.
  [[nodiscard]] std::uint64_t lost() const { return lost_; }

 private:
  [[nodiscard]] bool event_driven() const { return type_ >= kEventDrivenManufacturer; }
  [[nodiscard]] bool timed() const { return event_driven() && event_time_ > base::SimDuration(); }
  void on_event(base::SimTime now);
  void sync_cyclic(std::uint8_t counter, base::SimTime now);
  void send_now(base::SimTime now) { send(mapping_.pack(), now); }
  void send(std::uint64_t data, base::SimTime now);

  const dictionary::Dictionary* dictionary_;
  std::uint16_t number_;
  can::Transmitter* transmitter_;
  const PdoRules* rules_;
  PdoMapping mapping_;

  // Configuration, as its objects have it.
  bool valid_ = false;
  bool remote_ = false;
  std::uint16_t can_id_ = 0;
  std::uint8_t type_ = kEventDrivenManufacturer;
  std::uint8_t sync_start_ = 0;
  base::SimDuration inhibit_time_;
  base::SimDuration event_time_;

  // State in Operational.
  bool running_ = false;
  bool event_ = false;           ///< an event not answered yet
  std::uint64_t last_data_ = 0;  ///< what was sent last, or sampled at a SYNC for a remote frame
  std::uint8_t syncs_ = 0;       ///< since the last cyclic transmission
  bool awaits_start_ = false;    ///< no SYNC with the start value has come yet
  std::optional<base::SimTime> sent_at_;
  base::SimTime inhibited_until_;
  base::SimTime timer_ = base::SimTime::never();
  std::uint64_t sent_ = 0;
  std::uint64_t lost_ = 0;
};

}  // namespace stator::canopen
