// The emergency producer of a CANopen node (CiA 301 §7.2.7) and the indices of its objects.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "stator/base/event.hpp"
#include "stator/can/transmitter.hpp"
#include "stator/canopen/cob_id.hpp"
#include "stator/canopen/emergency/emergency_sink.hpp"
#include "stator/canopen/service.hpp"
#include "stator/dictionary/dictionary.hpp"

namespace stator::canopen {

inline constexpr std::uint16_t kErrorRegister = 0x1001;
inline constexpr std::uint16_t kPredefinedErrorField = 0x1003;
inline constexpr std::uint16_t kCobIdEmergency = 0x1014;
inline constexpr std::uint16_t kInhibitTimeEmergency = 0x1015;

/// How a product changes the emergencies of one code.
struct EmergencyRule {
  std::uint16_t code = 0;
  std::uint8_t error_register = 0;  ///< bits it sets; they replace those it was raised with
  /// Manufacturer-specific bytes in place of those that are 0 where the error was raised.
  std::array<std::uint8_t, 5> information{};
};

struct EmergencyRules {
  std::span<const EmergencyRule> codes{};
  bool change_valid_cob_id = false;  ///< see CobIdRules::change_valid_emergency
};

struct EmergencyStatistics {
  std::uint64_t sent = 0;
  std::uint64_t dropped = 0;  ///< messages that found the queue full, or no valid 1014h
};

/// The emergency producer of a node (CiA 301 §7.2.7): keeps the errors that last, the error
/// register 1001h, where declared the error history 1003h, and sends one message when an error
/// comes and one with code 0000h when it goes.
///
/// Messages are sent in their order, no closer than the inhibit time 1015h, in Pre-operational and
/// Operational while 1014h is valid; up to eight wait, in other states too. Initialisation forgets
/// errors of the communication (81xxh, 82xxh) and messages of the time before; those of the
/// application last until it clears them or calls forget(). Errors that last are told anew after
/// the boot-up message: a node that comes up with one is never error free (CiA 301 §7.2.7.1).
class EmergencyProducer final : public Service, public EmergencySink {
 public:
  /// Messages that wait at most; a further one is lost: the first ones tell the cause.
  static constexpr std::size_t kQueue = 8;
  /// Errors that last at the same time at most; of further ones only the message is sent.
  static constexpr std::size_t kErrors = 32;

  /// 1001h must be declared; without 1014h nothing is sent.
  EmergencyProducer(dictionary::Dictionary& dictionary, can::Transmitter& transmitter,
                    base::EventReporter reporter, const EmergencyRules& limits = {});

  void raise(const Emergency& emergency, base::SimTime now) override;
  void clear(std::uint16_t code, std::uint8_t cause, base::SimTime now) override;
  /// As raise(), without a message: for errors that a product shows in the error register alone.
  void note(const Emergency& emergency, base::SimTime now);
  /// As clear(), without a message: for a device that reports several errors gone with one
  /// report_reset().
  void withdraw(std::uint16_t code, std::uint8_t cause);
  /// Sends code 0000h, whatever lasts.
  void report_reset(base::SimTime now);
  /// Every error is gone, without a message, and what waits is not sent: the application begins
  /// anew.
  void forget();
  [[nodiscard]] bool lasts(std::uint16_t code, std::uint8_t cause) const;

  void start(base::SimTime now) override;
  void on_state(NmtState state, base::SimTime now) override;
  void advance(base::SimTime now) override;
  [[nodiscard]] base::SimTime next_deadline() const override;

  [[nodiscard]] const EmergencyStatistics& statistics() const { return statistics_; }

 private:
  struct Error {
    std::uint16_t code = 0;
    std::uint8_t cause = 0;
    std::uint8_t error_register = 0;
    std::array<std::uint8_t, 5> information{};
    bool sent = false;  ///< by a message; otherwise in the error register alone
  };

  [[nodiscard]] Emergency completed(const Emergency& emergency) const;
  [[nodiscard]] Error* find(std::uint16_t code, std::uint8_t cause);
  bool add(const Emergency& emergency, bool sent);
  bool remove(std::uint16_t code, std::uint8_t cause);
  void begin_anew();
  void update_register();
  void record(const Emergency& emergency);
  void report(const Emergency& emergency, base::StaticText fate, base::SimTime now) const;
  /// Says, for a person, what becomes of the message.
  base::StaticText queue(const Emergency& emergency, base::SimTime now);
  void send_waiting(base::SimTime now);
  [[nodiscard]] bool may_send() const;
  [[nodiscard]] dictionary::Verdict check_cob_id_written(const dictionary::Entry& entry,
                                                         std::uint64_t value);
  [[nodiscard]] dictionary::Verdict check_history_written(const dictionary::Entry& entry,
                                                          std::uint64_t value);
  [[nodiscard]] dictionary::Verdict check_history_read(const dictionary::Entry& entry);

  dictionary::Dictionary& dictionary_;
  can::Transmitter& transmitter_;
  base::EventReporter reporter_;
  EmergencyRules rules_;
  dictionary::Entry* error_register_;
  const dictionary::Object* history_;  ///< null where not declared, as the following
  const dictionary::Entry* cob_id_;
  const dictionary::Entry* inhibit_time_;

  NmtState state_ = NmtState::initialisation;
  std::array<Error, kErrors> errors_{};
  std::size_t error_count_ = 0;
  std::array<can::Frame, kQueue> messages_{};  ///< without their identifier
  std::size_t first_message_ = 0;
  std::size_t message_count_ = 0;
  base::SimTime inhibited_until_;
  EmergencyStatistics statistics_;
};

namespace rules {
/// {4}: what became of the message.
inline constexpr base::EventRule kEmergencyRaised{
    "emergency", base::Severity::fault,
    "error {0:x4}, error register {1:x2}, information {2}, {3}, has come; {4}"};
inline constexpr base::EventRule kEmergencyCleared{"emergency-cleared", base::Severity::information,
                                                   "error {0:x4} is gone, error register {1:x2}"};
inline constexpr base::EventRule kHistoryValue{
    "error-history-value", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: {3} came; only 0, which clears the error history, can "
    "be written"};
inline constexpr base::EventRule kHistoryEmpty{
    "error-history-empty", base::Severity::refusal,
    "read of {0:x4}:{1:x2} \"{2}\" refused: the error history has {3} entries"};
}  // namespace rules

}  // namespace stator::canopen
