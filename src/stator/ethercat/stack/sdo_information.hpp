#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/base/expected.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/ethercat/stack/slave_stack_statistics.hpp"
#include "stator/ethercat/standard/mailbox_protocol.hpp"

namespace stator::ethercat {

/// The SDO information service of CoE (ETG.1000.6 §5.6.3): lists of objects, descriptions of
/// objects and entries. Answers longer than the mailbox come as fragments; a new request supersedes
/// the rest.
class SdoInformation {
 public:
  SdoInformation(dictionary::Dictionary& dictionary, base::EventReporter reporter,
                 SlaveStackStatistics& statistics);

  void reset() { sent_ = answer_.size(); }

  /// Handles a request without its CoE header; `reply` must have room for 8 bytes at least.
  [[nodiscard]] MailboxReply handle(std::span<const std::byte> request, std::span<std::byte> reply,
                                    base::SimTime now);

  [[nodiscard]] bool has_fragment() const { return sent_ < answer_.size(); }
  [[nodiscard]] std::size_t next_fragment(std::span<std::byte> reply);

 private:
  using Verdict = dictionary::Verdict;

  [[nodiscard]] Verdict answer_list(std::span<const std::byte> request);
  [[nodiscard]] Verdict answer_object(std::span<const std::byte> request);
  [[nodiscard]] Verdict answer_entry(std::span<const std::byte> request);
  [[nodiscard]] std::size_t refuse(std::span<std::byte> reply, const dictionary::Refusal& refusal,
                                   base::SimTime now);
  template <typename T>
  void append(T value);
  void append_text(std::string_view text);

  dictionary::Dictionary& dictionary_;
  base::EventReporter reporter_;
  SlaveStackStatistics& statistics_;
  std::uint8_t opcode_ = 0;        ///< of the answer
  std::vector<std::byte> answer_;  ///< without headers
  std::size_t sent_ = 0;
};

namespace rules {
inline constexpr base::EventRule kInformationUnknown{
    "sdo-information-unknown", base::Severity::refusal,
    "SDO information refused: request {0} is none of 1 (list), 3 (object), 5 (entry)"};
inline constexpr base::EventRule kInformationList{
    "sdo-information-list", base::Severity::refusal,
    "SDO information refused: list type {0} is none of 0 to 5"};
}  // namespace rules

}  // namespace stator::ethercat
