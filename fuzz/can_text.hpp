#pragma once

#include <algorithm>
#include <chrono>
#include <span>
#include <string>

#include "input.hpp"
#include "stator/link/can/can_stream_session.hpp"

namespace stator::fuzz {

/// Feeds `session` with `bytes` in pieces as a stream brings them, lets time pass and frames come
/// in between, and hands each frame it takes to `on_frame`.
template <typename OnFrame>
void feed(link::CanStreamSession& session, std::span<const std::uint8_t> bytes, OnFrame on_frame) {
  constexpr std::size_t kPiece = 37;
  link::MachineTime now;
  std::string input;
  std::string out;
  session.greet(out);
  while (!bytes.empty()) {
    const auto piece = bytes.first(std::min(kPiece, bytes.size()));
    bytes = bytes.subspan(piece.size());
    input.append(piece.begin(), piece.end());
    while (!input.empty()) {
      const auto taken = session.take(input, now, out);
      require(taken.consumed <= input.size());
      if (taken.frame) {
        const can::Frame& frame = *taken.frame;
        require(frame.length <= can::kMaximumData &&
                frame.identifier <= (frame.extended ? 0x1FFFFFFFU : 0x7FFU));
        on_frame(frame);
        session.put(frame, {}, out);
      }
      if (taken.consumed == 0) {
        break;
      }
      input.erase(0, taken.consumed);
    }
    // What waits for the rest of a message is bounded.
    require(input.size() <= 512);
    now += std::chrono::milliseconds(20);
    for (int i = 0; i < 300 && session.advance(now, out); ++i) {
    }
    session.put_error(link::bus_error_frame(), {}, out);
    out.clear();
  }
  require(session.malformed() <= 1'000'000);
}

}  // namespace stator::fuzz
