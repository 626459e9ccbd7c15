#include "stator/replay/step_text.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "stator/ethercat/standard/frame.hpp"

namespace stator::replay {

namespace {

/// Bytes of a datagram that are shown before it is cut.
constexpr std::size_t kShownBytes = 64;

constexpr std::array<std::string_view, 15> kCommands{"NOP",  "APRD", "APWR", "APRW", "FPRD",
                                                     "FPWR", "FPRW", "BRD",  "BWR",  "BRW",
                                                     "LRD",  "LWR",  "LRW",  "ARMW", "FRMW"};

std::string describe(const ethercat::DatagramView& datagram, unsigned number) {
  const auto command = static_cast<std::size_t>(datagram.command);
  const bool logical = command >= 10 && command <= 12;
  const auto data = std::span<const std::byte>(datagram.data, datagram.length);
  return fmt::format("datagram {}: {} {}, {} bytes: {}{}, interrupt {:04X}h, working counter {}",
                     number, command < kCommands.size() ? kCommands[command] : "?",
                     logical ? fmt::format("{:08X}h", datagram.address)
                             : fmt::format("{:04X}h:{:04X}h", datagram.adp(), datagram.ado()),
                     datagram.length, to_hex(data.first(std::min(data.size(), kShownBytes))),
                     data.size() > kShownBytes ? " ..." : "", datagram.interrupt,
                     datagram.working_counter);
}

/// Of the datagram in which the byte at `offset` lies.
std::string describe_at(const LeavingFrame& frame, std::size_t offset) {
  if (!frame.exit) {
    return "the frame gets lost";
  }
  std::vector<std::byte> copy(frame.frame.begin(), frame.frame.end());
  ethercat::DatagramCursor cursor(copy);
  unsigned number = 0;
  while (const auto datagram = cursor.next()) {
    ++number;
    const auto end = static_cast<std::size_t>(datagram->data - copy.data()) + datagram->length +
                     ethercat::kWorkingCounterLength;
    if (offset < end) {
      return describe(*datagram, number);
    }
  }
  return fmt::format("byte {}: {:02X}h", offset,
                     offset < copy.size() ? std::to_integer<unsigned>(copy[offset]) : 0U);
}

}  // namespace

std::string to_hex(std::span<const std::byte> bytes) {
  std::string text;
  for (const std::byte byte : bytes) {
    text += fmt::format("{}{:02X}", text.empty() ? "" : " ", std::to_integer<unsigned>(byte));
  }
  return text;
}

std::string to_text(const can::TimedFrame& frame) {
  return fmt::format("{:X}h [{}] {}{}{} at {:.9f} s", frame.frame.identifier, frame.frame.length,
                     to_hex(frame.frame.payload()), frame.frame.remote ? "remote" : "",
                     frame.destroyed ? " destroyed by an error frame" : "", frame.time.seconds());
}

std::pair<std::string, std::string> explain_frames(const LeavingFrame& expected,
                                                   const LeavingFrame& got) {
  const auto different = std::ranges::mismatch(expected.frame, got.frame);
  const auto offset = static_cast<std::size_t>(different.in1 - expected.frame.begin());
  std::string first = describe_at(expected, offset);
  std::string second = describe_at(got, offset);
  if (expected.exit && got.exit && *expected.exit != *got.exit) {
    const auto name = [](ethercat::MasterInterface interface) {
      return interface == ethercat::MasterInterface::primary ? "at the primary interface; "
                                                             : "at the secondary interface; ";
    };
    first = name(*expected.exit) + first;
    second = name(*got.exit) + second;
  }
  return {std::move(first), std::move(second)};
}

}  // namespace stator::replay
