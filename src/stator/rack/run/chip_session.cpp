#include "stator/rack/run/chip_session.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include "stator/base/byte_order.hpp"

namespace stator::rack {

namespace {

using namespace link::chip_protocol;
using base::SimDuration;
using base::SimTime;
using link::ChipMessage;
using product::HostPin;
using product::HostSpi;

constexpr product::HostLines kAllLines = (1U << product::kHostLines) - 1;

void store_status(std::span<std::byte> out, product::HostLines levels, SimTime now) {
  base::store_le(out.data(), levels);
  base::store_le(out.data() + 4, static_cast<std::uint64_t>((now - SimTime()).nanoseconds()));
}

unsigned number(std::byte byte) {
  return std::to_integer<unsigned>(byte);
}

}  // namespace

ChipSession::ChipSession(product::HostPort& port, std::string name, Output output)
    : port_(port), name_(std::move(name)), output_(std::move(output)) {
  miso_.reserve(kMaximumTransfer);
  body_.reserve(kStatusLength + kMaximumTransfer);
}

void ChipSession::begin() {
  leave();
  greeted_ = false;
  lost_ = 0;
}

void ChipSession::leave() {
  port_.watch(0, nullptr);
  for (std::size_t i = 0; i < selected_.size(); ++i) {
    if (std::exchange(selected_[i], false)) {
      port_.deselect(static_cast<HostSpi>(i), 0);
    }
  }
}

void ChipSession::take(const ChipMessage& message, SimTime now) {
  now_ = now;
  const auto request = static_cast<Request>(message.kind);
  if (!greeted_ && request != Request::hello) {
    output_.refuse(message.tag, Refusal::no_hello,
                   "the first message has to be a greeting: kind 01h with STCH and version 1");
    return;
  }
  switch (request) {
    case Request::hello:
      greet(message);
      return;
    case Request::transfer:
      transfer(message);
      return;
    case Request::levels:
      reply(message);
      return;
    case Request::watch:
      watch(message);
      return;
    case Request::pin:
      set_pin(message);
      return;
    case Request::power:
      switch_power(message);
      return;
  }
  output_.refuse(message.tag, Refusal::unknown_request,
                 "this kind of message does not exist; 01h to 06h do");
}

void ChipSession::greet(const ChipMessage& message) {
  const auto magic = std::as_bytes(std::span(kMagic));
  if (message.body.size() < magic.size() + 1 ||
      !std::ranges::equal(message.body.first(magic.size()), magic)) {
    output_.refuse(message.tag, Refusal::no_hello,
                   "the greeting does not begin with STCH and a version");
    return;
  }
  if (number(message.body[magic.size()]) != kVersion) {
    output_.refuse(message.tag, Refusal::version, "this program speaks version 1 only");
    return;
  }
  greeted_ = true;
  output_.greeted();
  std::array<std::byte, 6> content{};
  content[0] = std::byte{kVersion};
  content[1] = static_cast<std::byte>((1U << product::kHostSpis) - 1);
  base::store_le(content.data() + 2, static_cast<std::uint16_t>(kMaximumTransfer));
  base::store_le(content.data() + 4, kAllLines);
  std::vector<std::byte> all(content.begin(), content.end());
  const auto name = std::as_bytes(std::span(name_)).first(std::min<std::size_t>(name_.size(), 255));
  all.insert(all.end(), name.begin(), name.end());
  reply(message, all);
}

void ChipSession::transfer(const ChipMessage& message) {
  if (message.body.size() < kTransferPrefix) {
    malformed(message, "a transfer is port, flags, pause of 16 bits, data");
    return;
  }
  const unsigned port = number(message.body[0]);
  if (port >= product::kHostSpis) {
    output_.refuse(message.tag, Refusal::unknown_target, "SPI port 0 is the PDI, 1 is MFC CTRL");
    return;
  }
  const unsigned flags = number(message.body[1]);
  std::optional<SimDuration> pause;
  if ((flags & kPauseGiven) != 0) {
    pause = SimDuration(base::load_le<std::uint16_t>(message.body.data() + 2));
  }
  const auto spi = static_cast<HostSpi>(port);
  const Body mosi = message.body.subspan(kTransferPrefix);
  miso_.assign(mosi.size(), std::byte{0});
  if (!std::exchange(selected_[port], true)) {
    port_.select(spi);
  }
  port_.transfer(spi, mosi, miso_, pause);
  if ((flags & kKeepSelected) == 0) {
    selected_[port] = false;
    port_.deselect(spi, (flags & kSurplusClocks) >> kSurplusShift);
  }
  reply(message, miso_);
}

void ChipSession::watch(const ChipMessage& message) {
  if (message.body.size() != 2) {
    malformed(message, "what is to be watched is a mask of 16 bits");
    return;
  }
  const auto mask = base::load_le<std::uint16_t>(message.body.data());
  port_.watch(static_cast<product::HostLines>(mask & kAllLines), this);
  reply(message);
}

void ChipSession::set_pin(const ChipMessage& message) {
  if (message.body.size() != 2) {
    malformed(message, "a pin is set by its number and its level");
    return;
  }
  const unsigned pin = number(message.body[0]);
  if (pin >= product::kHostPins) {
    output_.refuse(message.tag, Refusal::unknown_target,
                   "the pins are 0 LATCH_IN0, 1 LATCH_IN1, 2 MFC_NES, 3 NRESET");
    return;
  }
  port_.set_pin(static_cast<HostPin>(pin), number(message.body[1]) != 0);
  reply(message);
}

void ChipSession::switch_power(const ChipMessage& message) {
  if (message.body.size() != 1) {
    malformed(message, "power is one byte, 0 or 1");
    return;
  }
  selected_.fill(false);
  output_.power(number(message.body[0]) != 0);
  reply(message);
}

void ChipSession::reply(const ChipMessage& request, Body content) {
  body_.assign(kStatusLength, std::byte{0});
  store_status(body_, port_.levels(), now_);
  body_.insert(body_.end(), content.begin(), content.end());
  output_.reply({.kind = static_cast<std::uint8_t>(request.kind | kReply),
                 .tag = request.tag,
                 .body = body_});
}

void ChipSession::malformed(const ChipMessage& message, std::string_view form) const {
  output_.refuse(message.tag, Refusal::malformed, form);
}

void ChipSession::on_lines(const product::HostLineChange& change) {
  std::array<std::byte, kEventLength> body{};
  base::store_le(body.data(), change.levels);
  base::store_le(body.data() + 2, change.rose);
  base::store_le(body.data() + 4, change.fell);
  base::store_le(body.data() + 6, lost_);
  base::store_le(body.data() + 8,
                 static_cast<std::uint64_t>((change.time - SimTime()).nanoseconds()));
  if (output_.event({.kind = kEvent, .tag = 0, .body = body})) {
    lost_ = 0;
  } else if (lost_ != std::numeric_limits<std::uint16_t>::max()) {
    ++lost_;
  }
}

}  // namespace stator::rack
