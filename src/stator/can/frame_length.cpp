#include "stator/can/frame_length.hpp"

#include "stator/can/arbitration.hpp"

namespace stator::can {

namespace {

constexpr unsigned kCrcBits = 15;
constexpr unsigned kLongestRun = 5;

/// Takes the bits of a frame in the order in which they are sent; the CRC covers them before
/// stuffing.
class BitCounter {
 public:
  /// The lowest `count` bits of `value`, highest first.
  void append(std::uint32_t value, unsigned count) {
    for (unsigned i = count; i-- > 0;) {
      const unsigned bit = value >> i & 1U;
      bits_.crc = crc15_next(bits_.crc, bit);
      stuff(bit);
    }
  }

  [[nodiscard]] FrameBits finish() {
    for (unsigned i = kCrcBits; i-- > 0;) {
      stuff(bits_.crc >> i & 1U);
    }
    return bits_;
  }

 private:
  void stuff(unsigned bit) {
    ++bits_.unstuffed;
    run_ = bit == last_ ? run_ + 1 : 1;
    last_ = bit;
    if (run_ == kLongestRun) {
      ++bits_.stuff;
      last_ = bit ^ 1U;
      run_ = 1;
    }
  }

  FrameBits bits_;
  unsigned last_ = 1;  // the idle bus is recessive
  unsigned run_ = 0;
};

}  // namespace

FrameBits frame_bits(const Frame& frame) {
  BitCounter counter;
  counter.append(0, 1);  // start of frame
  if (frame.extended) {
    counter.append(arbitration_field(frame), 32);
    counter.append(0, 2);  // r1, r0
  } else {
    counter.append(arbitration_field(frame) >> 19U, 13);  // identifier, RTR, IDE
    counter.append(0, 1);                                 // r0
  }
  counter.append(frame.length, 4);
  for (const std::byte byte : frame.payload()) {
    counter.append(std::to_integer<std::uint32_t>(byte), 8);
  }
  return counter.finish();
}

unsigned frame_length_in_bits(const Frame& frame) {
  const FrameBits bits = frame_bits(frame);
  return bits.unstuffed + bits.stuff + kTailBits;
}

}  // namespace stator::can
