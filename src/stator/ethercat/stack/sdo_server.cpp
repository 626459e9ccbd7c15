#include "stator/ethercat/stack/sdo_server.hpp"

#include <algorithm>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/stack/complete_access.hpp"
#include "stator/ethercat/stack/pdo_configuration.hpp"

namespace stator::ethercat {

namespace {

using base::EventArgument;
using base::Expected;
using base::Unexpected;
using dictionary::AbortCode;
using dictionary::Entry;
using dictionary::Object;
using dictionary::Refusal;
using dictionary::Verdict;

constexpr std::size_t kSdoSize = 8;         ///< an SDO without data behind its header
constexpr std::size_t kSegmentHeader = 1;   ///< command byte
constexpr std::size_t kSegmentMinData = 7;  ///< data of a segment, unused bytes included
constexpr std::size_t kExpeditedMax = 4;

/// Command specifiers, bits 7..5 of the command byte (ETG.1000.6 tables 29 to 40).
enum class ClientCommand : std::uint8_t {
  download_segment = 0,
  initiate_download = 1,
  initiate_upload = 2,
  upload_segment = 3,
  abort = 4,
};
constexpr unsigned kDownloadResponse = 3U << 5;
constexpr unsigned kDownloadSegmentResponse = 1U << 5;
constexpr unsigned kUploadResponse = 2U << 5;
constexpr unsigned kAbortCommand = 4U << 5;

// Other bits of the command byte.
constexpr unsigned kSizeIndicated = 0x01;
constexpr unsigned kExpedited = 0x02;
constexpr unsigned kCompleteAccess = 0x10;
constexpr unsigned kToggle = 0x10;
constexpr unsigned kLastSegment = 0x01;

/// Texts may grow by writing; this much is always possible.
constexpr std::size_t kMinimumBuffer = 1024;

std::size_t buffer_size(const dictionary::Dictionary& dictionary) {
  std::size_t size = kMinimumBuffer;
  for (const Object& object : dictionary.objects()) {
    std::size_t bytes = 2;
    for (const Entry& entry : object.entries) {
      bytes += entry.size();
    }
    size = std::max(size, bytes);
  }
  return size;
}

void write_header(std::span<std::byte> reply, unsigned command, std::uint16_t index,
                  std::uint8_t subindex, std::uint32_t data) {
  reply[0] = static_cast<std::byte>(command);
  base::store_le(reply, 1, index);
  reply[3] = static_cast<std::byte>(subindex);
  base::store_le(reply, 4, data);
}

}  // namespace

SdoServer::SdoServer(dictionary::Dictionary& dictionary, bool complete_access,
                     base::EventReporter reporter, SlaveStackStatistics& statistics,
                     const dictionary::Quirks& quirks)
    : dictionary_(dictionary),
      complete_access_(complete_access && !quirks.no_complete_access),
      reporter_(reporter),
      statistics_(statistics),
      quirks_(quirks),
      buffer_(buffer_size(dictionary)) {}

MailboxReply SdoServer::handle(std::span<const std::byte> request, std::span<std::byte> reply,
                               base::SimTime now) {
  if (request.size() < kSdoSize) {
    return MailboxReply::refuse(MailboxErrorCode::size_too_short);
  }
  written_ = false;
  const auto result = dispatch(request, reply);
  if (result && written_ && completion_ != nullptr) {
    std::ranges::copy(reply.first(kSdoSize), completion_reply_.begin());
    completing_ = true;
    return {.length = answer_when_complete(reply, now)};
  }
  return {.length = result ? *result : abort(reply, result.error(), now)};
}

std::size_t SdoServer::answer_when_complete(std::span<std::byte> reply, base::SimTime now) {
  const std::optional<Verdict> verdict = completion_of_write(now);
  if (!verdict) {
    return 0;
  }
  completing_ = false;
  if (!*verdict) {
    return abort(reply, verdict->error(), now);
  }
  std::ranges::copy(completion_reply_, reply.begin());
  return kSdoSize;
}

/// The verdict on all entries that the write has touched, a refusal if there is one; nothing: some
/// entries are still under way.
std::optional<Verdict> SdoServer::completion_of_write(base::SimTime now) {
  if (!target_.complete) {
    return completion_->poll(*dictionary_.find(target_.index, target_.subindex), now);
  }
  std::optional<Verdict> result = Verdict{};
  for (const Entry& entry : dictionary_.find(target_.index)->entries) {
    const std::optional<Verdict> verdict = completion_->poll(entry, now);
    if (!verdict) {
      result.reset();
    } else if (result && *result && !*verdict) {
      result = verdict;
    }
  }
  return result;
}

bool SdoServer::is_abort(std::span<const std::byte> answer) {
  return !answer.empty() && static_cast<ClientCommand>(std::to_integer<unsigned>(answer[0]) >> 5) ==
                                ClientCommand::abort;
}

Expected<std::size_t, Refusal> SdoServer::dispatch(std::span<const std::byte> request,
                                                   std::span<std::byte> reply) {
  const auto command = std::to_integer<std::uint8_t>(request[0]);
  command_ = command;
  const auto specifier = static_cast<ClientCommand>(command >> 5);
  if (specifier == ClientCommand::download_segment || specifier == ClientCommand::upload_segment) {
    target_ = transfer_.kind == TransferKind::none ? Target{} : transfer_.target;
  } else {
    target_ = {.index = base::load_le<std::uint16_t>(request, 1),
               .subindex = std::to_integer<std::uint8_t>(request[3]),
               .complete = (command & kCompleteAccess) != 0};
    transfer_.kind = TransferKind::none;  // a new request supersedes an abandoned transfer
  }
  if (intervention_ != nullptr && specifier != ClientCommand::abort) {
    if (const auto code = intervention_->aborts_sdo(target_.index, target_.subindex)) {
      return Unexpected{
          protocol_refusal(static_cast<AbortCode>(*code), rules::kSdoFault, std::int64_t{*code})};
    }
  }
  switch (specifier) {
    case ClientCommand::initiate_upload:
      return initiate_upload(reply);
    case ClientCommand::upload_segment:
      return upload_segment(command, reply);
    case ClientCommand::initiate_download:
      return initiate_download(request, reply);
    case ClientCommand::download_segment:
      return download_segment(request, reply);
    case ClientCommand::abort:
      return 0;
  }
  return Unexpected{protocol_refusal(AbortCode::command_specifier_unknown,
                                     rules::kSdoUnknownCommand, int{command})};
}

Expected<std::size_t, Refusal> SdoServer::initiate_upload(std::span<std::byte> reply) {
  auto size = read_target(target_);
  if (!size) {
    return size;
  }
  const unsigned complete = target_.complete ? kCompleteAccess : 0;
  const std::span<const std::byte> data = std::span(buffer_).first(*size);
  if (*size >= 1 && *size <= kExpeditedMax) {
    const auto unused = static_cast<unsigned>(kExpeditedMax - *size);
    const unsigned size_bits = quirks_.size_not_indicated ? 0 : unused << 2 | kSizeIndicated;
    write_header(reply, kUploadResponse | complete | size_bits | kExpedited, target_.index,
                 target_.subindex, 0);
    std::ranges::copy(data, reply.begin() + 4);
    return kSdoSize;
  }
  const std::size_t now_sent = std::min(*size, reply.size() - kSdoSize);
  if (now_sent < *size && quirks_.no_segments) {
    return Unexpected{no_segments(*size)};
  }
  write_header(reply, kUploadResponse | complete | kSizeIndicated, target_.index, target_.subindex,
               static_cast<std::uint32_t>(*size));
  std::ranges::copy(data.first(now_sent), reply.begin() + kSdoSize);
  if (now_sent < *size) {
    transfer_ = {
        .kind = TransferKind::upload, .target = target_, .size = *size, .offset = now_sent};
  }
  return kSdoSize + now_sent;
}

Expected<std::size_t, Refusal> SdoServer::upload_segment(std::uint8_t command,
                                                         std::span<std::byte> reply) {
  if (transfer_.kind != TransferKind::upload) {
    return Unexpected{
        protocol_refusal(AbortCode::command_specifier_unknown, rules::kSdoNoTransfer)};
  }
  const bool toggle = (command & kToggle) != 0;
  if (toggle != transfer_.toggle) {
    return Unexpected{
        protocol_refusal(AbortCode::toggle_bit_not_changed, rules::kSdoToggle, toggle ? 1 : 0)};
  }
  const std::size_t left = transfer_.size - transfer_.offset;
  const std::size_t sent = std::min(left, reply.size() - kSegmentHeader);
  const std::size_t padding = sent < kSegmentMinData ? kSegmentMinData - sent : 0;
  const bool last = sent == left;
  reply[0] =
      static_cast<std::byte>((toggle && !quirks_.toggle_stuck ? kToggle : 0U) |
                             static_cast<unsigned>(padding << 1) | (last ? kLastSegment : 0U));
  const auto body = reply.subspan(kSegmentHeader, sent + padding);
  std::ranges::fill(body, std::byte{0});
  std::ranges::copy(std::span(buffer_).subspan(transfer_.offset, sent), body.begin());
  transfer_.offset += sent;
  transfer_.toggle = !toggle;
  if (last) {
    transfer_.kind = TransferKind::none;
  }
  return kSegmentHeader + body.size();
}

Expected<std::size_t, Refusal> SdoServer::initiate_download(std::span<const std::byte> request,
                                                            std::span<std::byte> reply) {
  const auto command = std::to_integer<unsigned>(request[0]);
  const bool size_indicated = (command & kSizeIndicated) != 0;
  std::span<const std::byte> data;
  if ((command & kExpedited) != 0) {
    std::size_t size = kExpeditedMax - ((command >> 2) & 3);
    const Entry* entry = dictionary_.find(target_.index, target_.subindex);
    if (!size_indicated && !target_.complete && entry != nullptr) {
      size = std::min(kExpeditedMax, entry->size());
    }
    data = request.subspan(4, size);
  } else if (size_indicated) {
    const std::size_t size = base::load_le<std::uint32_t>(request, 4);
    const auto first = request.subspan(kSdoSize);
    if (first.size() < size && quirks_.no_segments) {
      return Unexpected{no_segments(size)};
    }
    if (first.size() < size) {
      if (Verdict verdict = check_long_download(target_, size); !verdict) {
        return Unexpected{verdict.error()};
      }
      std::ranges::copy(first, buffer_.begin());
      transfer_ = {
          .kind = TransferKind::download, .target = target_, .size = size, .offset = first.size()};
      write_header(reply, kDownloadResponse, target_.index, target_.subindex, 0);
      return kSdoSize;
    }
    data = first.first(size);
  } else {
    return Unexpected{
        protocol_refusal(AbortCode::command_specifier_unknown, rules::kSdoUnknownCommand, command)};
  }
  if (Verdict verdict = write_target(target_, data); !verdict) {
    return Unexpected{verdict.error()};
  }
  write_header(reply, kDownloadResponse, target_.index, target_.subindex, 0);
  return kSdoSize;
}

Expected<std::size_t, Refusal> SdoServer::download_segment(std::span<const std::byte> request,
                                                           std::span<std::byte> reply) {
  if (transfer_.kind != TransferKind::download) {
    return Unexpected{
        protocol_refusal(AbortCode::command_specifier_unknown, rules::kSdoNoTransfer)};
  }
  const auto command = std::to_integer<unsigned>(request[0]);
  const bool toggle = (command & kToggle) != 0;
  if (toggle != transfer_.toggle) {
    return Unexpected{
        protocol_refusal(AbortCode::toggle_bit_not_changed, rules::kSdoToggle, toggle ? 1 : 0)};
  }
  std::span<const std::byte> data = request.subspan(kSegmentHeader);
  if (data.size() == kSegmentMinData) {
    data = data.first(kSegmentMinData - ((command >> 1) & 7));
  }
  const std::size_t received = transfer_.offset + data.size();
  if (received > transfer_.size) {
    return Unexpected{protocol_refusal(AbortCode::length_too_high, rules::kSdoSegmentOverrun,
                                       received, transfer_.size)};
  }
  std::ranges::copy(data, buffer_.begin() + static_cast<std::ptrdiff_t>(transfer_.offset));
  transfer_.offset = received;
  transfer_.toggle = !toggle;
  if ((command & kLastSegment) != 0) {
    transfer_.kind = TransferKind::none;
    if (received < transfer_.size) {
      return Unexpected{protocol_refusal(AbortCode::length_too_low, rules::kSdoSegmentUnderrun,
                                         received, transfer_.size)};
    }
    if (Verdict verdict = write_target(target_, std::span(buffer_).first(received)); !verdict) {
      return Unexpected{verdict.error()};
    }
  }
  write_header(reply, kDownloadSegmentResponse | (toggle && !quirks_.toggle_stuck ? kToggle : 0U),
               0, 0, 0);
  return kSdoSize;
}

/// Brings the value into the buffer and returns its length.
Expected<std::size_t, Refusal> SdoServer::read_target(const Target& target) {
  if (target.complete) {
    const auto object = complete_object(target);
    if (!object) {
      return Unexpected{object.error()};
    }
    return read_complete(dictionary_, **object, static_cast<CompleteAccessStart>(target.subindex),
                         buffer_);
  }
  const auto entry = dictionary_.require(target.index, target.subindex);
  if (!entry) {
    return Unexpected{entry.error()};
  }
  if ((*entry)->size() > buffer_.size()) {
    return Unexpected{protocol_refusal(AbortCode::out_of_memory, rules::kSdoTooLong,
                                       (*entry)->size(), buffer_.size())};
  }
  if (Verdict verdict = dictionary_.read(**entry, buffer_); !verdict) {
    return Unexpected{verdict.error()};
  }
  return (*entry)->size();
}

Verdict SdoServer::write_target(const Target& target, std::span<const std::byte> data) {
  written_ = true;
  if (target.complete) {
    const auto object = complete_object(target);
    if (!object) {
      return Unexpected{object.error()};
    }
    return write_complete(dictionary_, **object, static_cast<CompleteAccessStart>(target.subindex),
                          data, context_);
  }
  const auto entry = dictionary_.require(target.index, target.subindex);
  if (!entry) {
    return Unexpected{entry.error()};
  }
  Verdict verdict = dictionary_.write(**entry, data, context_);
  if (!verdict) {
    Refusal refusal = verdict.error();
    refusal.code = PdoConfiguration::refine(**entry, refusal.code);
    return Unexpected{refusal};
  }
  return verdict;
}

Refusal SdoServer::no_segments(std::size_t size) const {
  return protocol_refusal(AbortCode::object_exceeds_mailbox, rules::kSdoNoSegments, size);
}

/// What can be refused before the segments come, so that the master need not send them in vain.
Verdict SdoServer::check_long_download(const Target& target, std::size_t size) const {
  std::size_t expected = buffer_.size();
  if (target.complete) {
    if (const auto object = complete_object(target); !object) {
      return Unexpected{object.error()};
    }
  } else {
    const auto entry = dictionary_.require(target.index, target.subindex);
    if (!entry) {
      return Unexpected{entry.error()};
    }
    if (!(*entry)->writable()) {
      return dictionary::refuse(AbortCode::read_only, dictionary::rules::kReadOnly,
                                {int{target.index}, int{target.subindex}, (*entry)->shared_name()});
    }
    if (!is_string((*entry)->type())) {
      expected = (*entry)->size();
      if (size < expected) {
        return Unexpected{
            protocol_refusal(AbortCode::length_too_low, rules::kSdoTooShort, size, expected)};
      }
    }
  }
  if (size > expected) {
    return Unexpected{
        protocol_refusal(AbortCode::length_too_high, rules::kSdoTooLong, size, expected)};
  }
  return {};
}

Expected<const Object*, Refusal> SdoServer::complete_object(const Target& target) const {
  const auto count = dictionary_.require(target.index, 0);
  if (!count) {
    return Unexpected{count.error()};
  }
  if (!complete_access_) {
    return Unexpected{
        protocol_refusal(AbortCode::unsupported_access, rules::kSdoCompleteUnsupported)};
  }
  const Object* object = dictionary_.find(target.index);
  if (object->single()) {
    return Unexpected{protocol_refusal(AbortCode::unsupported_access, rules::kSdoCompleteVariable)};
  }
  if (target.subindex > 1) {
    return Unexpected{protocol_refusal(AbortCode::unsupported_access, rules::kSdoCompleteSubindex)};
  }
  return object;
}

Refusal SdoServer::protocol_refusal(AbortCode code, const base::EventRule& rule, EventArgument a,
                                    EventArgument b) const {
  return {code, &rule, {int{target_.index}, int{target_.subindex}, a, b}};
}

std::size_t SdoServer::abort(std::span<std::byte> reply, const Refusal& refusal,
                             base::SimTime now) {
  transfer_.kind = TransferKind::none;
  ++statistics_.sdo_aborts;
  if (refusal.rule != nullptr) {
    reporter_.report(now, *refusal.rule, refusal.arguments);
  }
  const unsigned size_bits =
      quirks_.abort_with_size ? command_ & (kExpedited | kSizeIndicated) : 0U;
  write_header(reply, kAbortCommand | size_bits, target_.index, target_.subindex,
               static_cast<std::uint32_t>(refusal.code));
  return kSdoSize;
}

}  // namespace stator::ethercat
