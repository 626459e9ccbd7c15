#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "stator/base/sim_time.hpp"
#include "stator/ethercat/segment/segment.hpp"
#include "stator/ethercat/standard/frame.hpp"

namespace stator::fuzz {

/// A master that sends one datagram at a time into a segment.
class Bus {
 public:
  explicit Bus(ethercat::Segment& segment) : segment_(segment) {}

  [[nodiscard]] base::SimTime now() const { return now_; }
  void wait(base::SimDuration duration) { now_ += duration; }

  /// Sends `data` in a datagram and leaves the answer in it; the working counter, 0 if the frame
  /// was lost.
  unsigned transfer(ethercat::Command command, std::uint32_t address, std::span<std::byte> data) {
    ethercat::FrameBuilder builder(buffer_, kMaster);
    builder.append(command, 0, address, std::span<const std::byte>(data));
    const std::span<std::byte> frame = builder.finish();
    if (!send(frame)) {
      return 0;
    }
    const auto answer = ethercat::DatagramCursor(frame).next();
    std::ranges::copy(answer->bytes(), data.begin());
    return answer->working_counter;
  }

  /// Sends any frame. A frame that comes back has kept its length by construction: it is changed in
  /// place.
  bool send(std::span<std::byte> frame,
            ethercat::MasterInterface interface = ethercat::MasterInterface::primary) {
    now_ += base::SimDuration(10'000);
    return segment_.process(frame, now_, interface).has_value();
  }

 private:
  static constexpr ethercat::MacAddress kMaster{0x01, 0x01, 0x01, 0x01, 0x01, 0x01};

  ethercat::Segment& segment_;
  base::SimTime now_;
  std::array<std::byte, ethercat::kMaximumFrameLength> buffer_{};
};

}  // namespace stator::fuzz
