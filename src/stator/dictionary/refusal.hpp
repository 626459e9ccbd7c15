#pragma once

#include <array>

#include "stator/base/event.hpp"
#include "stator/base/expected.hpp"
#include "stator/dictionary/abort_code.hpp"

namespace stator::dictionary {

/// Why an access was refused: the code for the master and the sentence for the person.
struct Refusal {
  AbortCode code = AbortCode::general_error;
  const base::EventRule* rule = nullptr;
  std::array<base::EventArgument, 6> arguments{};
};

/// Success, or the refusal.
using Verdict = base::Expected<void, Refusal>;

inline base::Unexpected<Refusal> refuse(AbortCode code, const base::EventRule& rule,
                                        const std::array<base::EventArgument, 6>& arguments) {
  return base::Unexpected<Refusal>{Refusal{code, &rule, arguments}};
}

// Arguments of every rule here: {0} index, {1} subindex, {2} name, then what the rule adds.
namespace rules {
using base::EventRule;
using base::Severity;

inline constexpr EventRule kObjectMissing{
    "od-object-missing", Severity::refusal,
    "object {0:x4} refused: the dictionary has no such object; read the object list to see what "
    "the device offers"};
inline constexpr EventRule kSubindexMissing{
    "od-subindex-missing", Severity::refusal,
    "object {0:x4}:{1:x2} refused: the highest subindex of this object is {2}"};
inline constexpr EventRule kReadOnly{
    "od-read-only", Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: the object is read-only"};
inline constexpr EventRule kWriteOnly{
    "od-write-only", Severity::refusal,
    "read of {0:x4}:{1:x2} \"{2}\" refused: the object is write-only"};
inline constexpr EventRule kNetworkState{
    "od-network-state", Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused in {3}: it can be written in {4} only; change the "
    "state first"};
inline constexpr EventRule kDriveState{
    "od-drive-state", Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: the power drive is in {3}, must be in Switch on "
    "disabled; write controlword 0 first"};
inline constexpr EventRule kLength{
    "od-length", Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: {3} bytes came, the data type has {4}"};
inline constexpr EventRule kTooHigh{
    "od-too-high", Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: {3} is above the maximum {4}"};
inline constexpr EventRule kTooLow{
    "od-too-low", Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: {3} is below the minimum {4}"};
inline constexpr EventRule kIllegalValue{
    "od-illegal-value", Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: {3} is none of the values the device supports: "
    "{4}"};
}  // namespace rules

}  // namespace stator::dictionary
