// The SYNC consumer of a CANopen node (CiA 301 §7.2.5) and the indices of the SYNC objects.
#pragma once

#include <cstdint>

#include "stator/base/delegate.hpp"
#include "stator/base/event.hpp"
#include "stator/canopen/cob_id.hpp"
#include "stator/canopen/emergency/emergency_sink.hpp"
#include "stator/canopen/service.hpp"
#include "stator/dictionary/dictionary.hpp"

namespace stator::canopen {

inline constexpr std::uint16_t kCobIdSync = 0x1005;
inline constexpr std::uint16_t kCommunicationCyclePeriod = 0x1006;
inline constexpr std::uint16_t kSynchronousWindowLength = 0x1007;
inline constexpr std::uint16_t kSynchronousCounterOverflow = 0x1019;

/// A SYNC as it reaches the node's other services.
struct Sync {
  base::SimTime time;
  std::uint8_t counter = 0;  ///< 1 to 240; 0 for a SYNC without counter
  /// When the synchronous window ends (1007h); never() without one. Synchronous receive PDOs that
  /// come later belong to no SYNC.
  base::SimTime window_end = base::SimTime::never();
};

struct SyncRules {
  /// 1005h accepts no CAN-ID that another communication object of the device uses.
  bool refuse_shared_can_id = false;
};

/// Takes SYNC messages (CiA 301 §7.2.5) and checks writes to their objects: 1005h, and where the
/// product declares them 1006h, 1007h and 1019h.
///
/// Where 1019h is declared, a SYNC must have the length it asks for: none, or one byte with the
/// counter; another one is reported with emergency 8240h and passed over. Devices without 1019h
/// take a SYNC of any length.
class SyncConsumer final : public Service {
 public:
  using Listener = base::Delegate<void(const Sync&)>;

  /// 1005h must be declared.
  SyncConsumer(dictionary::Dictionary& dictionary, EmergencySink& emergencies,
               const SyncRules& limits = {});

  /// Called at each SYNC, e.g. PdoService::on_sync.
  void set_listener(Listener listener) { listener_ = listener; }

  void start(base::SimTime now) override;
  bool receive(const can::Frame& frame, base::SimTime now) override;

  /// Passes a SYNC on; the producer calls it for those of its own.
  void notify(std::uint8_t counter, base::SimTime now);

  [[nodiscard]] std::uint16_t can_id() const { return can_id_of(cob_id_->value()); }
  /// SYNC messages since the start that had the wrong length.
  [[nodiscard]] std::uint64_t malformed() const { return malformed_; }

 private:
  [[nodiscard]] dictionary::Verdict check_identifier(const dictionary::Entry& entry,
                                                     std::uint64_t value);
  [[nodiscard]] dictionary::Verdict check_overflow(const dictionary::Entry& entry,
                                                   std::uint64_t value);
  [[nodiscard]] bool length_fits(const can::Frame& frame) const;

  dictionary::Dictionary& dictionary_;
  EmergencySink& emergencies_;
  SyncRules rules_;
  Listener listener_;
  const dictionary::Entry* cob_id_;
  const dictionary::Entry* period_;  ///< null where not declared, as the following
  const dictionary::Entry* window_;
  const dictionary::Entry* overflow_;
  std::uint64_t malformed_ = 0;
};

// Arguments: {0} index, {1} subindex, {2} name, {3} the value that came.
namespace rules {
inline constexpr base::EventRule kSyncOverflowRange{
    "sync-overflow-range", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: {3} is no counter overflow; 0 (no counter) and 2 to "
    "240 are"};
inline constexpr base::EventRule kSyncOverflowPeriod{
    "sync-overflow-period", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: it changes only while 1006h is 0; write 0 there "
    "first"};
}  // namespace rules

}  // namespace stator::canopen
