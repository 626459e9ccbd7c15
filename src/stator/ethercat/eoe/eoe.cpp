#include "stator/ethercat/eoe/eoe.hpp"

#include <algorithm>
#include <bit>

namespace stator::ethercat {

namespace {

using base::EventArgument;

constexpr std::size_t kTimeStampSize = 4;
constexpr std::uint8_t kGroupAddress = 0x01;  // of the first octet of a MAC address

void write_result(std::span<std::byte> reply, const EoeHeader& request, EoeType type,
                  EoeResult result) {
  EoeHeader{.type = type, .port = request.port, .last_fragment = true}.encode(reply);
  base::store_le(reply, 2, static_cast<std::uint16_t>(result));
}

std::uint32_t as_number(const Ipv4Address& address) {
  std::uint32_t number = 0;
  for (const std::uint8_t octet : address) {
    number = number << 8 | octet;
  }
  return number;
}

/// Ones only up to some bit, from there on zeros only.
bool is_contiguous(const Ipv4Address& mask) {
  return std::countl_one(as_number(mask)) == std::popcount(as_number(mask));
}

}  // namespace

void EoeServer::poll(bool running) {
  if (port_ == nullptr) {
    return;
  }
  // Bounded, so that a flood on the port cannot hold up the firmware.
  for (std::size_t i = 0; i < kQueuedFrames && !queue_.full(); ++i) {
    const std::size_t length = port_->take(polled_);
    if (length == 0) {
      return;
    }
    if (running) {
      queue_frame(std::span(polled_).first(length));
    }
  }
}

void EoeServer::queue_frame(std::span<const std::byte> frame) {
  if (frame.empty() || frame.size() > kMaximumFrame || !queue_.push(frame)) {
    ++statistics_.send_dropped;
  }
}

void EoeServer::reset() {
  incoming_.reset();
  drop_reported_ = false;
  append_time_stamp_ = false;
  queue_.clear();
  unsent_ = 0;
}

MailboxReply EoeServer::handle(std::span<const std::byte> request, std::span<std::byte> reply,
                               base::SimTime now) {
  if (request.size() < EoeHeader::kSize) {
    return MailboxReply::refuse(MailboxErrorCode::size_too_short);
  }
  const EoeHeader header = EoeHeader::decode(request);
  const std::span<const std::byte> body = request.subspan(EoeHeader::kSize);
  switch (header.type) {
    case EoeType::fragment:
      return take_fragment(header, body, reply, now);
    case EoeType::set_ip_request:
      write_result(reply, header, EoeType::set_ip_response, set_ip(body, now));
      return {.length = EoeHeader::kSize};
    case EoeType::get_ip_request:
      return get_ip(header, reply);
    case EoeType::set_filter_request:
    case EoeType::get_filter_request:
      reporter_.report(now, rules::kEoeFilterRefused);
      write_result(reply, header,
                   header.type == EoeType::set_filter_request ? EoeType::set_filter_response
                                                              : EoeType::get_filter_response,
                   EoeResult::no_filter_support);
      return {.length = EoeHeader::kSize};
    case EoeType::time_stamp_response:
    case EoeType::set_ip_response:
    case EoeType::set_filter_response:
    case EoeType::get_ip_response:
    case EoeType::get_filter_response:
      return MailboxReply::refuse(MailboxErrorCode::service_not_supported);
  }
  return MailboxReply::refuse(MailboxErrorCode::invalid_header);
}

MailboxReply EoeServer::take_fragment(const EoeHeader& header, std::span<const std::byte> data,
                                      std::span<std::byte> reply, base::SimTime now) {
  // Only the last fragment carries the time stamp. Without room for one nothing is left of the
  // frame, and the reassembly refuses the empty fragment.
  if (header.last_fragment && header.time_stamp_appended) {
    data = data.first(data.size() - std::min(data.size(), kTimeStampSize));
  }
  const bool superseded = header.fragment_number == 0 && incoming_.in_progress();
  const std::uint8_t expected =
      incoming_.in_progress() ? incoming_.expected_fragment() : std::uint8_t{0};
  const EoeReassembly::Verdict verdict = incoming_.add(header, data);
  if (superseded || verdict == EoeReassembly::Verdict::dropped) {
    statistics_.receive_dropped += superseded && verdict == EoeReassembly::Verdict::dropped ? 2 : 1;
    report_dropped(header, expected, data.size(), now);
  }
  if (verdict == EoeReassembly::Verdict::ignored) {
    ++statistics_.fragments_ignored;
  }
  if (verdict != EoeReassembly::Verdict::complete) {
    return MailboxReply::none();
  }
  ++statistics_.frames_received;
  if (port_ != nullptr) {
    port_->send(incoming_.frame());
  }
  if (!header.time_stamp_requested) {
    return MailboxReply::none();
  }
  EoeHeader{.type = EoeType::time_stamp_response,
            .port = header.port,
            .last_fragment = true,
            .frame_number = header.frame_number}
      .encode(reply);
  base::store_le(reply, EoeHeader::kSize, static_cast<std::uint32_t>(now.nanoseconds()));
  return {.length = EoeHeader::kSize + kTimeStampSize};
}

void EoeServer::report_dropped(const EoeHeader& header, std::uint8_t expected, std::size_t length,
                               base::SimTime now) {
  if (drop_reported_) {
    return;
  }
  drop_reported_ = true;
  reporter_.report(now, rules::kEoeFrameDropped,
                   {int{header.frame_number}, int{expected}, int{header.fragment_number},
                    EventArgument(header.offset * EoeHeader::kOffsetUnit), EventArgument(length),
                    EventArgument(kMaximumFrame)});
}

EoeResult EoeServer::set_ip(std::span<const std::byte> block, base::SimTime now) {
  const auto refuse = [&](base::StaticText reason) {
    reporter_.report(now, rules::kEoeIpRefused, {reason, EventArgument(block.size())});
    return EoeResult::unspecified_error;
  };
  IpParameters changed = ip_parameters_;
  bool append_time_stamp = false;
  if (!decode_ip_parameters(block, changed, append_time_stamp)) {
    return refuse("the request is shorter than its flags say");
  }
  if (changed.mac_address && (changed.mac_address->front() & kGroupAddress) != 0) {
    return refuse("a group address cannot be the MAC address of a device");
  }
  if (changed.subnet_mask && !is_contiguous(*changed.subnet_mask)) {
    const Ipv4Address& mask = *changed.subnet_mask;
    reporter_.report(now, rules::kEoeMaskRefused,
                     {int{mask[0]}, int{mask[1]}, int{mask[2]}, int{mask[3]}});
    return EoeResult::invalid_ip_parameter;
  }
  ip_parameters_ = changed;
  append_time_stamp_ = append_time_stamp;
  if (changed.address) {
    const Ipv4Address& address = *changed.address;
    reporter_.report(now, rules::kEoeAddressSet,
                     {int{address[0]}, int{address[1]}, int{address[2]}, int{address[3]},
                      std::popcount(as_number(changed.subnet_mask.value_or(Ipv4Address{})))});
  }
  if (port_ != nullptr) {
    port_->set_ip_parameters(ip_parameters_);
  }
  return EoeResult::success;
}

MailboxReply EoeServer::get_ip(const EoeHeader& request, std::span<std::byte> reply) const {
  std::array<std::byte, kMaximumIpParameterBlock> block{};
  const std::size_t length = encode_ip_parameters(ip_parameters_, block);
  if (reply.size() < EoeHeader::kSize + length) {
    return MailboxReply::refuse(MailboxErrorCode::no_more_memory);
  }
  write_result(reply, request, EoeType::get_ip_response, EoeResult::success);
  std::ranges::copy(std::span(block).first(length), reply.subspan(EoeHeader::kSize).begin());
  return {.length = EoeHeader::kSize + length};
}

std::size_t EoeServer::next_message(std::span<std::byte> message, base::SimTime now) {
  if (unsent_ == 0) {
    sending_length_ = unsent_ = queue_.pop(sending_);
    sending_fragment_ = 0;
    sending_number_ = (sending_number_ + 1) & 0x0F;
  }
  if (unsent_ == 0) {
    return 0;
  }
  const std::size_t room = message.size() - std::min(message.size(), EoeHeader::kSize);
  const std::size_t time_stamp = append_time_stamp_ ? kTimeStampSize : 0;
  const bool last = unsent_ + time_stamp <= room;
  // A frame that only its time stamp keeps from fitting leaves a byte for the last fragment.
  const std::size_t part = std::min(room, unsent_ - 1);
  const std::size_t length = last ? unsent_ : part - part % EoeHeader::kOffsetUnit;
  if (length == 0) {
    ++statistics_.send_dropped;
    unsent_ = 0;
    return 0;
  }
  const std::size_t done = sending_length_ - unsent_;
  const std::size_t offset =
      sending_fragment_ == 0 ? sending_length_ + EoeHeader::kOffsetUnit - 1 : done;
  EoeHeader{.last_fragment = last,
            .time_stamp_appended = last && append_time_stamp_,
            .fragment_number = sending_fragment_,
            .offset = static_cast<std::uint8_t>(offset / EoeHeader::kOffsetUnit),
            .frame_number = sending_number_}
      .encode(message);
  std::ranges::copy(std::span(sending_).subspan(done, length),
                    message.subspan(EoeHeader::kSize).begin());
  if (last && append_time_stamp_) {
    base::store_le(message, EoeHeader::kSize + length,
                   static_cast<std::uint32_t>(now.nanoseconds()));
  }
  unsent_ -= length;
  ++sending_fragment_;
  statistics_.frames_sent += last ? 1 : 0;
  return EoeHeader::kSize + length + (last ? time_stamp : 0);
}

}  // namespace stator::ethercat
