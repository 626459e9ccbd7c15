#include "stator/canopen/sdo/sdo_server.hpp"

#include <algorithm>

#include "stator/base/byte_order.hpp"
#include "stator/canopen/sdo/sdo_protocol.hpp"

namespace stator::canopen {

namespace {

using base::EventArgument;
using base::SimDuration;
using base::SimTime;
using base::Unexpected;
using dictionary::AbortCode;
using dictionary::Entry;
using dictionary::Refusal;
using dictionary::Verdict;
using sdo::ClientCommand;

constexpr std::uint16_t kFirstServer = 0x1200;
// Identifiers of the first server in the predefined connection set (CiA 301 §7.3.5).
constexpr std::uint32_t kRequestBase = 0x600;
constexpr std::uint32_t kResponseBase = 0x580;
// COB-IDs in the parameter object (CiA 301 §7.5.2.33).
constexpr std::uint32_t kInvalid = 0x80000000;
constexpr std::uint32_t kIdentifierMask = 0x7FF;
constexpr std::uint8_t kClientToServer = 1;
constexpr std::uint8_t kServerToClient = 2;

constexpr SimDuration kCompletionPoll(1'000'000);
constexpr std::size_t kLongestNumber = 8;

std::size_t longest_download(const dictionary::Dictionary& dictionary,
                             const SdoServerConfiguration& configuration) {
  const bool writable_text = std::ranges::any_of(dictionary.entries(), [](const Entry& entry) {
    return entry.writable() && is_string(entry.type());
  });
  return writable_text ? std::max(configuration.longest_download, kLongestNumber) : kLongestNumber;
}

}  // namespace

SdoServer::SdoServer(dictionary::Dictionary& dictionary, std::uint16_t parameter_index,
                     can::Transmitter& transmitter, base::EventReporter reporter,
                     const SdoServerConfiguration& configuration)
    : dictionary_(dictionary),
      parameter_index_(parameter_index),
      transmitter_(transmitter),
      reporter_(reporter),
      configuration_(configuration),
      parameters_{dictionary.find(parameter_index, kClientToServer),
                  dictionary.find(parameter_index, kServerToClient)},
      longest_download_(longest_download(dictionary, configuration)),
      // A block's last segment may bring up to seven bytes that do not count.
      buffer_(longest_download_ + sdo::kSegmentData) {
  configuration_.block_transfer =
      configuration_.block_transfer && !configuration_.quirks.no_block_transfer;
  configuration_.block_size =
      std::clamp<std::uint8_t>(configuration.block_size, 1, sdo::kMaximumBlockSize);
}

void SdoServer::start(SimTime /*now*/) {
  forget();
  if (parameter_index_ != kFirstServer) {
    return;
  }
  for (const std::uint8_t subindex : {kClientToServer, kServerToClient}) {
    if (Entry* entry = dictionary_.find(parameter_index_, subindex); entry != nullptr) {
      entry->set_value(channel(subindex));
    }
  }
}

void SdoServer::on_state(NmtState state, SimTime /*now*/) {
  enabled_ = state == NmtState::pre_operational || state == NmtState::operational;
  context_.network_state = state == NmtState::operational
                               ? dictionary::NetworkState::operational
                               : dictionary::NetworkState::pre_operational;
  if (!enabled_) {
    forget();
    held_.reset();
    held_until_ = SimTime::never();
  }
}

/// COB-ID of one direction.
std::uint32_t SdoServer::channel(std::uint8_t subindex) const {
  if (parameter_index_ == kFirstServer) {
    return (subindex == kClientToServer ? kRequestBase : kResponseBase) + node_id_;
  }
  const Entry* entry = parameters_[subindex - kClientToServer];
  return entry == nullptr ? kInvalid : static_cast<std::uint32_t>(entry->value());
}

bool SdoServer::valid() const {
  return ((channel(kClientToServer) | channel(kServerToClient)) & kInvalid) == 0;
}

bool SdoServer::receive(const can::Frame& frame, SimTime now) {
  if (!enabled_ || frame.remote || frame.extended ||
      frame.identifier != (channel(kClientToServer) & kIdentifierMask) || !valid()) {
    return false;
  }
  if (!length_fits(frame)) {
    ++statistics_.malformed;
    reporter_.report(now, sdo::rules::kWrongLength, {int{parameter_index_}, 0, int{frame.length}});
    return true;
  }
  ++statistics_.requests;
  command_ = std::to_integer<unsigned>(frame.data[0]);
  if (held_ && command_ != sdo::kAbort) {
    return true;
  }
  Reply request{};
  std::ranges::copy(frame.payload(), request.begin());
  conclude(dispatch(request, now), now);
  return true;
}

/// Every SDO has eight bytes (CiA 301 §7.2.4.3). Segments of a block tell by their place alone how
/// many bytes count.
bool SdoServer::length_fits(const can::Frame& frame) const {
  if (frame.length == can::kMaximumData || !configuration_.quirks.short_sdo ||
      transfer_ == Transfer::block_download) {
    return frame.length == can::kMaximumData;
  }
  return frame.length != 0 &&
         frame.length >= sdo::bytes_that_count(std::to_integer<unsigned>(frame.data[0]));
}

/// Sends what a request or a moment has led to, and waits for the client if the transfer goes on.
void SdoServer::conclude(const Answer& answer, SimTime now) {
  if (!answer) {
    abort(answer.error(), now);
    return;
  }
  if (*answer) {
    this->answer(**answer, now);
  }
  const bool waits_for_client =
      transfer_ != Transfer::none && transfer_ != Transfer::completing_write;
  deadline_ = waits_for_client ? now + configuration_.timeout : SimTime::never();
  if (transfer_ == Transfer::block_download && block_.pending) {
    deadline_ = now + SimDuration(configuration_.timeout.nanoseconds() / 2);
  }
}

SdoServer::Answer SdoServer::dispatch(Request request, SimTime now) {
  const auto command = std::to_integer<unsigned>(request[0]);
  const auto specifier = static_cast<ClientCommand>(command >> 5);
  if (command == sdo::kAbort) {
    if (transfer_ != Transfer::none) {
      reporter_.report(now, sdo::rules::kAbortedByClient,
                       {int{multiplexer_.index}, int{multiplexer_.subindex},
                        std::int64_t{base::load_le<std::uint32_t>(request, 4)}});
    }
    forget();
    held_.reset();
    held_until_ = SimTime::never();
    return std::optional<Reply>();
  }
  if (transfer_ == Transfer::block_download) {
    return block_download_segment(request);
  }
  const unsigned subcommand =
      specifier == ClientCommand::block_upload     ? command & sdo::kBlockUploadSubcommand
      : specifier == ClientCommand::block_download ? command & sdo::kBlockDownloadSubcommand
                                                   : sdo::kInitiateBlock;
  const bool segment = specifier == ClientCommand::download_segment ||
                       specifier == ClientCommand::upload_segment ||
                       subcommand != sdo::kInitiateBlock;
  if (segment && transfer_ == Transfer::none) {
    multiplexer_ = {};
  } else if (!segment) {
    forget();  // a new request supersedes an abandoned transfer
    multiplexer_ = {.index = base::load_le<std::uint16_t>(request, 1),
                    .subindex = std::to_integer<std::uint8_t>(request[3])};
  }
  switch (specifier) {
    case ClientCommand::initiate_upload:
      return initiate_upload();
    case ClientCommand::upload_segment:
      return upload_segment(command);
    case ClientCommand::initiate_download:
      return initiate_download(request, now);
    case ClientCommand::download_segment:
      return download_segment(request, now);
    case ClientCommand::block_upload:
      return block_upload(request, subcommand, now);
    case ClientCommand::block_download:
      return block_download(request, subcommand, now);
    case ClientCommand::abort:
      break;
  }
  return refuse(AbortCode::command_specifier_unknown, sdo::rules::kUnknownCommand, command);
}

SdoServer::Answer SdoServer::initiate_upload() {
  if (Verdict verdict = open_upload(); !verdict) {
    return Unexpected{verdict.error()};
  }
  return answer_upload();
}

/// Expedited if the value fits, which one without any byte does not.
SdoServer::Answer SdoServer::answer_upload() {
  const std::size_t size = *size_;
  if (size >= 1 && size <= sdo::kExpeditedMaximum) {
    const auto unused = static_cast<unsigned>(sdo::kExpeditedMaximum - size);
    const unsigned size_bits =
        configuration_.quirks.size_not_indicated ? 0 : unused << 2 | sdo::kSizeIndicated;
    Reply reply = reply_to_initiate(sdo::kUploadResponse | size_bits | sdo::kExpedited);
    std::ranges::copy(upload_data(), reply.begin() + 4);
    return std::optional(reply);
  }
  if (configuration_.quirks.no_segments) {
    return refuse_segments();
  }
  transfer_ = Transfer::segmented_upload;
  return std::optional(reply_to_initiate(sdo::kUploadResponse | sdo::kSizeIndicated,
                                         static_cast<std::uint32_t>(size)));
}

SdoServer::Answer SdoServer::upload_segment(unsigned command) {
  if (transfer_ != Transfer::segmented_upload) {
    return refuse(AbortCode::command_specifier_unknown, sdo::rules::kNoTransfer, command);
  }
  if (Verdict verdict = check_toggle(command); !verdict) {
    return Unexpected{verdict.error()};
  }
  if (Verdict verdict = check_unchanged(); !verdict) {
    return Unexpected{verdict.error()};
  }
  const std::size_t sent = std::min(*size_ - offset_, sdo::kSegmentData);
  const bool last = offset_ + sent == *size_;
  Reply reply{};
  reply[0] = static_cast<std::byte>(sdo::kUploadSegmentResponse | toggle_of_answer(command) |
                                    static_cast<unsigned>((sdo::kSegmentData - sent) << 1) |
                                    (last ? sdo::kLastSegment : 0U));
  std::ranges::copy(upload_data().subspan(offset_, sent), reply.begin() + 1);
  offset_ += sent;
  toggle_ = !toggle_;
  if (last) {
    forget();
  }
  return std::optional(reply);
}

SdoServer::Answer SdoServer::initiate_download(Request request, SimTime now) {
  const auto command = std::to_integer<unsigned>(request[0]);
  const bool size_indicated = (command & sdo::kSizeIndicated) != 0;
  const Reply reply = reply_to_initiate(sdo::kDownloadResponse);
  if ((command & sdo::kExpedited) == 0 && configuration_.quirks.no_segments) {
    return refuse_segments();
  }
  if ((command & sdo::kExpedited) == 0) {
    std::optional<std::size_t> announced;
    if (size_indicated) {
      announced = base::load_le<std::uint32_t>(request, 4);
    }
    if (Verdict verdict = open_download(announced); !verdict) {
      return Unexpected{verdict.error()};
    }
    transfer_ = Transfer::segmented_download;
    return std::optional(reply);
  }
  const auto entry = dictionary_.require(multiplexer_.index, multiplexer_.subindex);
  if (!entry) {
    return Unexpected{entry.error()};
  }
  entry_ = *entry;
  std::size_t size = sdo::kExpeditedMaximum - ((command >> 2) & 3);
  if (!size_indicated) {
    size = is_string(entry_->type()) ? sdo::kExpeditedMaximum
                                     : std::min(sdo::kExpeditedMaximum, entry_->size());
  }
  return write(std::span<const std::byte>(request).subspan(4, size), reply, now);
}

SdoServer::Answer SdoServer::download_segment(Request request, SimTime now) {
  const auto command = std::to_integer<unsigned>(request[0]);
  if (transfer_ != Transfer::segmented_download) {
    return refuse(AbortCode::command_specifier_unknown, sdo::rules::kNoTransfer, command);
  }
  if (Verdict verdict = check_toggle(command); !verdict) {
    return Unexpected{verdict.error()};
  }
  const std::size_t came = sdo::kSegmentData - ((command >> 1) & 7);
  if (Verdict verdict = check_room(offset_ + came); !verdict) {
    return Unexpected{verdict.error()};
  }
  std::copy_n(request.begin() + 1, came, buffer_.begin() + static_cast<std::ptrdiff_t>(offset_));
  offset_ += came;
  toggle_ = !toggle_;
  Reply reply{};
  reply[0] = static_cast<std::byte>(sdo::kDownloadSegmentResponse | toggle_of_answer(command));
  if ((command & sdo::kLastSegment) == 0) {
    return std::optional(reply);
  }
  return complete_download(reply, now);
}

SdoServer::Answer SdoServer::refuse_segments() const {
  return refuse(AbortCode::command_specifier_unknown, sdo::rules::kNoSegments);
}

unsigned SdoServer::toggle_of_answer(unsigned command) const {
  return configuration_.quirks.toggle_stuck ? 0U : command & sdo::kToggle;
}

Verdict SdoServer::check_toggle(unsigned command) const {
  const bool toggle = (command & sdo::kToggle) != 0;
  if (toggle != toggle_) {
    return refuse(AbortCode::toggle_bit_not_changed, sdo::rules::kToggle, toggle ? 1 : 0,
                  toggle_ ? 1 : 0);
  }
  return {};
}

/// Finds the value to upload and brings it up to date.
Verdict SdoServer::open_upload() {
  const auto entry = dictionary_.require(multiplexer_.index, multiplexer_.subindex);
  if (!entry) {
    return Unexpected{entry.error()};
  }
  entry_ = *entry;
  if (Verdict verdict = is_string(entry_->type()) ? dictionary_.prepare_read(*entry_)
                                                  : dictionary_.read(*entry_, number_);
      !verdict) {
    return verdict;
  }
  size_ = entry_->size();
  return {};
}

/// The value being uploaded: a text where the dictionary has it, a number as it was at the begin.
std::span<const std::byte> SdoServer::upload_data() const {
  return is_string(entry_->type()) ? entry_->bytes() : std::span(number_).first(*size_);
}

Verdict SdoServer::check_unchanged() const {
  if (entry_->size() != *size_) {
    return refuse(AbortCode::device_state, sdo::rules::kValueChanged, *size_, entry_->size());
  }
  return {};
}

/// Checks what can be refused before the data come, so that the client need not send them in vain.
Verdict SdoServer::open_download(std::optional<std::size_t> announced) {
  const auto entry = dictionary_.require(multiplexer_.index, multiplexer_.subindex);
  if (!entry) {
    return Unexpected{entry.error()};
  }
  entry_ = *entry;
  if (Verdict verdict = dictionary_.prepare_write(*entry_, announced, context_); !verdict) {
    return verdict;
  }
  if (announced && *announced > longest_download_) {
    return refuse(AbortCode::out_of_memory, sdo::rules::kTooLong, *announced, longest_download_);
  }
  size_ = announced;
  return {};
}

/// May `size` bytes have come so far?
Verdict SdoServer::check_room(std::size_t size) const {
  const bool number = !is_string(entry_->type());
  if (size_ || number) {
    const std::size_t expected = size_ ? *size_ : entry_->size();
    if (size > expected) {
      return refuse(AbortCode::length_too_high, sdo::rules::kTooManyBytes, size, expected);
    }
  } else if (size > longest_download_) {
    return refuse(AbortCode::out_of_memory, sdo::rules::kTooLong, size, longest_download_);
  }
  return {};
}

SdoServer::Answer SdoServer::complete_download(const Reply& reply, SimTime now) {
  if (size_ && offset_ < *size_) {
    return refuse(AbortCode::length_too_low, sdo::rules::kTooFewBytes, offset_, *size_);
  }
  return write(std::span(buffer_).first(offset_), reply, now);
}

SdoServer::Answer SdoServer::write(std::span<const std::byte> data, const Reply& reply,
                                   SimTime now) {
  if (Verdict verdict = dictionary_.write(*entry_, data, context_); !verdict) {
    return Unexpected{verdict.error()};
  }
  transfer_ = Transfer::completing_write;
  completion_reply_ = reply;
  return answer_when_complete(now);
}

SdoServer::Answer SdoServer::answer_when_complete(SimTime now) {
  if (completion_ != nullptr) {
    const std::optional<Verdict> verdict = completion_->poll(*entry_, now);
    if (!verdict) {
      retry_ = now + kCompletionPoll;
      return std::optional<Reply>();
    }
    if (!*verdict) {
      return Unexpected{verdict->error()};
    }
  }
  const Reply reply = completion_reply_;
  forget();
  return std::optional(reply);
}

void SdoServer::advance(SimTime now) {
  if (now >= held_until_) {
    send_held(now);
  } else if (now >= retry_) {
    retry_ = SimTime::never();
    conclude(transfer_ == Transfer::completing_write ? answer_when_complete(now) : send_block(now),
             now);
  } else if (now >= deadline_) {
    if (transfer_ == Transfer::block_download && block_.pending) {
      // The block's end was lost: what has come is acknowledged, so that the client goes on there.
      conclude(finish_block(), now);
    } else {
      conclude(refuse(AbortCode::protocol_timeout, sdo::rules::kTimeout,
                      configuration_.timeout / SimDuration(1'000'000)),
               now);
    }
  }
}

SimTime SdoServer::next_deadline() const {
  return std::min({deadline_, retry_, held_until_});
}

SdoServer::Reply SdoServer::reply_to_initiate(unsigned command, std::uint32_t data) const {
  Reply reply{};
  reply[0] = static_cast<std::byte>(command);
  base::store_le(reply, 1, multiplexer_.index);
  reply[3] = std::byte{multiplexer_.subindex};
  base::store_le(reply, 4, data);
  return reply;
}

Unexpected<Refusal> SdoServer::refuse(AbortCode code, const base::EventRule& rule,
                                      EventArgument third, EventArgument fourth) const {
  return dictionary::refuse(code, rule,
                            {int{multiplexer_.index}, int{multiplexer_.subindex}, third, fourth});
}

void SdoServer::forget() {
  transfer_ = Transfer::none;
  entry_ = nullptr;
  size_.reset();
  offset_ = 0;
  toggle_ = false;
  block_ = {};
  deadline_ = SimTime::never();
  retry_ = SimTime::never();
}

/// A slow device answers later, and its client has the whole time for the next request from then
/// on.
void SdoServer::answer(const Reply& reply, SimTime now) {
  if (configuration_.quirks.slow_sdo > SimDuration()) {
    held_ = reply;
    held_until_ = now + configuration_.quirks.slow_sdo;
  } else {
    send(reply);
  }
}

void SdoServer::send_held(SimTime now) {
  send(*held_);
  held_.reset();
  held_until_ = SimTime::never();
  if (deadline_ != SimTime::never()) {
    deadline_ = now + configuration_.timeout;
  }
}

void SdoServer::send(const Reply& reply) {
  transmitter_.send(can::data_frame(channel(kServerToClient) & kIdentifierMask, reply));
}

void SdoServer::abort(const Refusal& refusal, SimTime now) {
  ++statistics_.aborts;
  if (refusal.rule != nullptr) {
    reporter_.report(now, *refusal.rule, refusal.arguments);
  }
  const unsigned size_bits = configuration_.quirks.abort_with_size
                                 ? command_ & (sdo::kExpedited | sdo::kSizeIndicated)
                                 : 0U;
  answer(reply_to_initiate(sdo::kAbort | size_bits, static_cast<std::uint32_t>(refusal.code)), now);
  forget();
}

}  // namespace stator::canopen
