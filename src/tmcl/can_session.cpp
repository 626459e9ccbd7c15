#include "tmcl/can_session.hpp"

#include <algorithm>

#include "tmcl/reply.hpp"

namespace stator::tmcl {

namespace {

constexpr std::size_t kShort = 7;
constexpr std::size_t kLong = 8;

/// The reply without its first byte, the address of the host.
CanReply frame_of(const Telegram& telegram, std::int32_t identifier, std::size_t length) {
  CanReply reply{.identifier = static_cast<std::uint16_t>(identifier),
                 .length = static_cast<std::uint8_t>(length)};
  std::copy_n(telegram.begin() + 1, length, reply.data.begin());
  return reply;
}

Request request_in(std::span<const std::byte> data, std::uint8_t address) {
  Telegram telegram{};
  telegram[0] = std::byte{address};
  std::copy_n(data.begin(), kShort, telegram.begin() + 1);
  return decode_request(telegram);
}

}  // namespace

std::array<std::uint32_t, 2> CanSession::identifiers() const {
  const auto configured = [this](GlobalParameter parameter) {
    return static_cast<std::uint32_t>(firmware_.configuration(parameter));
  };
  return {configured(GlobalParameter::can_identifier) + identifier_offset_,
          configured(GlobalParameter::can_secondary_identifier)};
}

bool CanSession::is_for_this(std::uint32_t identifier) const {
  const auto [own, second] = identifiers();
  return identifier == own || (second != 0 && identifier == second);
}

std::optional<CanReply> CanSession::take(std::uint32_t identifier, std::span<const std::byte> data,
                                         base::SimTime now) {
  if ((data.size() != kShort && data.size() != kLong) || !is_for_this(identifier)) {
    return std::nullopt;  // A10
  }
  const auto configured = [this](GlobalParameter parameter) {
    return firmware_.configuration(parameter);
  };
  // Before the command, which may change them (A59).
  const std::int32_t reply_identifier = configured(GlobalParameter::can_reply_identifier);
  const auto host = static_cast<std::uint8_t>(configured(GlobalParameter::serial_host_address));
  const Request request =
      request_in(data, static_cast<std::uint8_t>(configured(GlobalParameter::serial_address)));
  const HostAnswer answer = firmware_.execute({.command = request.command,
                                               .type = request.type,
                                               .motor = request.motor,
                                               .value = request.value},
                                              Origin::can, now);
  if (answer.event_mask != 0) {
    HostAnswer second = answer;
    second.status = Status::target_reached;
    event_ = {
        .mask = answer.event_mask,
        .reply = frame_of(encode_reply(second, request, host, {}), reply_identifier, data.size())};
  }
  if (answer.form == ReplyForm::none) {
    return std::nullopt;
  }
  return frame_of(encode_reply(answer, request, host, firmware_.description().version_text),
                  reply_identifier, data.size());
}

std::optional<CanReply> CanSession::take_event() {
  if (!event_ || !firmware_.targets_reached(event_->mask)) {
    return std::nullopt;
  }
  const CanReply reply = event_->reply;
  event_.reset();
  return reply;
}

}  // namespace stator::tmcl
