#include "stator/tmcl/sessions/can_session.hpp"

#include <algorithm>

#include "stator/tmcl/sessions/reply.hpp"

namespace stator::tmcl {

namespace {

constexpr std::size_t kShort = 7;
constexpr std::size_t kLong = 8;

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
  const Asked asked{
      .request =
          request_in(data, static_cast<std::uint8_t>(configured(GlobalParameter::serial_address))),
      .reply_identifier = configured(GlobalParameter::can_reply_identifier),
      .host = static_cast<std::uint8_t>(configured(GlobalParameter::serial_host_address)),
      .length = data.size()};
  const HostAnswer answer = firmware_.execute({.command = asked.request.command,
                                               .type = asked.request.type,
                                               .motor = asked.request.motor,
                                               .value = asked.request.value},
                                              Origin::can, now);
  if (answer.waits) {
    asked_ = asked;
    return std::nullopt;
  }
  if (answer.event_mask != 0) {
    HostAnswer second = answer;
    second.status = Status::target_reached;
    event_ = {.mask = answer.event_mask, .reply = frame_of(second, asked, {})};
  }
  return reply_to(answer, asked);
}

std::optional<CanReply> CanSession::finish(base::SimTime now) {
  if (!asked_) {
    return std::nullopt;
  }
  const std::optional<HostAnswer> answer = firmware_.take_answer(now);
  if (!answer) {
    return std::nullopt;
  }
  const Asked asked = *asked_;
  asked_.reset();
  return reply_to(*answer, asked);
}

std::optional<CanReply> CanSession::reply_to(const HostAnswer& answer, const Asked& asked) const {
  if (answer.form == ReplyForm::none) {
    return std::nullopt;
  }
  return frame_of(answer, asked, firmware_.description().version_text);
}

/// The reply without its first byte, the address of the host.
CanReply CanSession::frame_of(const HostAnswer& answer, const Asked& asked,
                              std::string_view version_text) {
  const Telegram telegram = encode_reply(answer, asked.request, asked.host, version_text);
  CanReply reply{.identifier = static_cast<std::uint16_t>(asked.reply_identifier),
                 .length = static_cast<std::uint8_t>(asked.length)};
  std::copy_n(telegram.begin() + 1, asked.length, reply.data.begin());
  return reply;
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
