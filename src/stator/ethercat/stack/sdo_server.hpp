#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/base/expected.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/dictionary/quirks.hpp"
#include "stator/dictionary/write_completion.hpp"
#include "stator/ethercat/stack/mailbox_intervention.hpp"
#include "stator/ethercat/stack/slave_stack_statistics.hpp"
#include "stator/ethercat/standard/mailbox_protocol.hpp"

namespace stator::ethercat {

/// The SDO server of CoE (ETG.1000.6 §5.6.2): expedited, normal and segmented transfers in both
/// directions, single entries and complete access. One transfer at a time; a new initiate request
/// supersedes one that the master abandoned.
class SdoServer {
 public:
  SdoServer(dictionary::Dictionary& dictionary, bool complete_access, base::EventReporter reporter,
            SlaveStackStatistics& statistics, const dictionary::Quirks& quirks = {});

  /// Forgets the transfer.
  void reset() {
    transfer_.kind = TransferKind::none;
    completing_ = false;
  }
  void set_network_state(dictionary::NetworkState state) { context_.network_state = state; }

  /// See Mailbox::set_intervention().
  void set_intervention(MailboxIntervention* intervention) { intervention_ = intervention; }

  /// Decides when a write is complete, so that it is answered; null: every write is complete at
  /// once.
  void set_write_completion(dictionary::WriteCompletion* completion) { completion_ = completion; }
  /// A write was taken whose answer is still to come; no other request is to be handled meanwhile.
  [[nodiscard]] bool completing() const { return completing_; }
  /// That answer, if the write is complete by now, else 0 bytes; `reply` as in handle().
  [[nodiscard]] std::size_t answer_when_complete(std::span<std::byte> reply, base::SimTime now);

  /// True if an answer of handle() aborts the transfer; it goes out as an SDO request.
  [[nodiscard]] static bool is_abort(std::span<const std::byte> answer);
  /// Handles an SDO request without its CoE header; `reply` must have room for 8 bytes at least.
  [[nodiscard]] MailboxReply handle(std::span<const std::byte> request, std::span<std::byte> reply,
                                    base::SimTime now);

 private:
  using Refusal = dictionary::Refusal;
  using Verdict = dictionary::Verdict;

  /// What an initiate request names.
  struct Target {
    std::uint16_t index = 0;
    std::uint8_t subindex = 0;
    bool complete = false;
  };

  enum class TransferKind : std::uint8_t { none, upload, download };
  /// A segmented transfer under way.
  struct Transfer {
    TransferKind kind = TransferKind::none;
    Target target;
    std::size_t size = 0;    ///< bytes of the whole value
    std::size_t offset = 0;  ///< bytes moved so far
    bool toggle = false;     ///< toggle bit the next segment must have
  };

  [[nodiscard]] base::Expected<std::size_t, Refusal> dispatch(std::span<const std::byte> request,
                                                              std::span<std::byte> reply);
  [[nodiscard]] base::Expected<std::size_t, Refusal> initiate_upload(std::span<std::byte> reply);
  [[nodiscard]] base::Expected<std::size_t, Refusal> upload_segment(std::uint8_t command,
                                                                    std::span<std::byte> reply);
  [[nodiscard]] base::Expected<std::size_t, Refusal> initiate_download(
      std::span<const std::byte> request, std::span<std::byte> reply);
  [[nodiscard]] base::Expected<std::size_t, Refusal> download_segment(
      std::span<const std::byte> request, std::span<std::byte> reply);

  [[nodiscard]] base::Expected<std::size_t, Refusal> read_target(const Target& target);
  [[nodiscard]] Verdict write_target(const Target& target, std::span<const std::byte> data);
  [[nodiscard]] std::optional<Verdict> completion_of_write(base::SimTime now);
  [[nodiscard]] Refusal no_segments(std::size_t size) const;
  [[nodiscard]] Verdict check_long_download(const Target& target, std::size_t size) const;
  [[nodiscard]] base::Expected<const dictionary::Object*, Refusal> complete_object(
      const Target& target) const;
  [[nodiscard]] Refusal protocol_refusal(dictionary::AbortCode code, const base::EventRule& rule,
                                         base::EventArgument a = {},
                                         base::EventArgument b = {}) const;
  [[nodiscard]] std::size_t abort(std::span<std::byte> reply, const Refusal& refusal,
                                  base::SimTime now);

  dictionary::Dictionary& dictionary_;
  bool complete_access_;
  base::EventReporter reporter_;
  SlaveStackStatistics& statistics_;
  dictionary::Quirks quirks_;
  std::uint8_t command_ = 0;  ///< of the request being handled
  dictionary::AccessContext context_;
  MailboxIntervention* intervention_ = nullptr;
  Target target_;  ///< of the request being handled, for abort replies
  Transfer transfer_;
  std::vector<std::byte> buffer_;  ///< the value of a transfer
  dictionary::WriteCompletion* completion_ = nullptr;
  bool written_ = false;     ///< the request being handled was a write, which the dictionary took
  bool completing_ = false;  ///< completion_ is asked until it gives a verdict
  std::array<std::byte, 8> completion_reply_{};  ///< what answers the write that is being completed
};

// Arguments: {0} index, {1} subindex, then what the rule adds.
namespace rules {
inline constexpr base::EventRule kSdoFault{
    "sdo-fault", base::Severity::fault,
    "SDO to {0:x4}:{1:x2} aborted with {2:x8} by a fault that was asked for"};
inline constexpr base::EventRule kSdoUnknownCommand{
    "sdo-unknown-command", base::Severity::refusal,
    "SDO refused: command byte {2:x2} is no request this server knows; block transfer is not "
    "supported, use expedited, normal or segmented transfer"};
inline constexpr base::EventRule kSdoNoTransfer{
    "sdo-no-transfer", base::Severity::refusal,
    "SDO segment refused: no segmented transfer is under way; begin with an initiate request"};
inline constexpr base::EventRule kSdoToggle{
    "sdo-toggle", base::Severity::refusal,
    "SDO segment for {0:x4}:{1:x2} refused: toggle bit {2} came twice; the transfer has ended"};
inline constexpr base::EventRule kSdoSegmentOverrun{
    "sdo-segment-overrun", base::Severity::refusal,
    "SDO download to {0:x4}:{1:x2} refused: {2} bytes came, {3} were announced"};
inline constexpr base::EventRule kSdoSegmentUnderrun{
    "sdo-segment-underrun", base::Severity::refusal,
    "SDO download to {0:x4}:{1:x2} refused: the last segment came after {2} of {3} bytes"};
inline constexpr base::EventRule kSdoTooLong{
    "sdo-too-long", base::Severity::refusal,
    "SDO download to {0:x4}:{1:x2} refused: {2} bytes announced, the object takes {3}"};
inline constexpr base::EventRule kSdoTooShort{
    "sdo-too-short", base::Severity::refusal,
    "SDO download to {0:x4}:{1:x2} refused: {2} bytes announced, the object needs {3}"};
inline constexpr base::EventRule kSdoCompleteUnsupported{
    "sdo-complete-unsupported", base::Severity::refusal,
    "complete access to {0:x4} refused: this device does not support complete access; access the "
    "subindices one by one"};
inline constexpr base::EventRule kSdoNoSegments{
    "sdo-no-segments", base::Severity::refusal,
    "SDO transfer of {0:x4}:{1:x2} refused: its {2} bytes do not fit the mailbox, and the quirk "
    "no-segments is on; take it off the device's table in the rack file"};
inline constexpr base::EventRule kSdoCompleteVariable{
    "sdo-complete-variable", base::Severity::refusal,
    "complete access to {0:x4} refused: it is a single variable, neither array nor record"};
inline constexpr base::EventRule kSdoCompleteSubindex{
    "sdo-complete-subindex", base::Severity::refusal,
    "complete access to {0:x4} refused: it begins at subindex {1}, only 0 and 1 are possible"};
}  // namespace rules

}  // namespace stator::ethercat
