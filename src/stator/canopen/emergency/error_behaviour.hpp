// The error behaviour object 1029h (CiA 301 §7.5.2.27): which NMT state a node takes after an
// error.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "stator/base/delegate.hpp"
#include "stator/base/event.hpp"
#include "stator/canopen/emergency/emergency_sink.hpp"
#include "stator/canopen/nmt_state.hpp"
#include "stator/dictionary/dictionary.hpp"

namespace stator::canopen {

inline constexpr std::uint16_t kErrorBehaviour = 0x1029;

/// What a node in Operational does about an error of a class that 1029h knows.
enum class ErrorReaction : std::uint8_t { none, pre_operational, stopped };

/// What a value of 1029h means.
struct ErrorBehaviourValue {
  std::uint8_t value = 0;
  ErrorReaction reaction = ErrorReaction::none;
};

/// CiA 301 §7.5.2.27.
inline constexpr std::array<ErrorBehaviourValue, 3> kErrorBehaviourOfCia301{
    {{0, ErrorReaction::pre_operational}, {1, ErrorReaction::none}, {2, ErrorReaction::stopped}}};

/// The error behaviour object 1029h: changes the NMT state when an error is found in Operational.
/// Values that mean nothing are refused with 06090030h. Where the product does not declare an error
/// class, value 0 holds for communication errors and nothing is done about others.
class ErrorBehaviour final : public CommunicationErrorReaction {
 public:
  static constexpr std::uint8_t kCommunicationError = 1;  ///< subindex of the class
  static constexpr std::uint8_t kApplicationError = 2;

  /// How the NMT state is asked for and changed, e.g. canopen::Node's functions.
  struct NmtAccess {
    base::Delegate<NmtState()> state;
    base::Delegate<void(NmtState, base::SimTime)> enter;
  };

  ErrorBehaviour(dictionary::Dictionary& dictionary, const NmtAccess& nmt,
                 base::EventReporter reporter,
                 std::span<const ErrorBehaviourValue> values = kErrorBehaviourOfCia301);
  ErrorBehaviour(const ErrorBehaviour&) = delete;
  ErrorBehaviour& operator=(const ErrorBehaviour&) = delete;

  void on_communication_error(base::SimTime now) override { react(kCommunicationError, now); }
  /// An error of the class with this subindex of 1029h was found.
  void react(std::uint8_t error_class, base::SimTime now);

 private:
  [[nodiscard]] ErrorReaction reaction_to(std::uint8_t error_class) const;
  [[nodiscard]] dictionary::Verdict check_value(const dictionary::Entry& entry,
                                                std::uint64_t value);

  const dictionary::Dictionary& dictionary_;
  NmtAccess nmt_;
  base::EventReporter reporter_;
  std::span<const ErrorBehaviourValue> values_;
};

namespace rules {
inline constexpr base::EventRule kErrorBehaviourValue{
    "error-behaviour-value", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: {3} is no error behaviour the device knows; see the "
    "object's description"};
inline constexpr base::EventRule kErrorReaction{
    "error-reaction", base::Severity::warning,
    "NMT state changes to {0} because of an error, as 1029h:{1:x2} asks; read the emergency "
    "messages for its cause"};
}  // namespace rules

}  // namespace stator::canopen
