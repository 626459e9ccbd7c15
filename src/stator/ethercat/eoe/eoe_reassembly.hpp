#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "stator/ethercat/eoe/eoe_message.hpp"

namespace stator::ethercat {

/// Longest Ethernet frame of EoE without check sequence: 1514 bytes and room for a VLAN tag.
inline constexpr std::size_t kMaximumEoeFrame = 1518;

/// Puts the fragments of an Ethernet frame together (ETG.1000.6 §5.7). They must come in order and
/// without a gap; anything else drops the frame, and what is left of it is ignored.
class EoeReassembly {
 public:
  enum class Verdict : std::uint8_t {
    incomplete,  ///< more fragments are to come
    complete,    ///< frame() is the whole frame
    dropped,     ///< the fragment does not fit; the frame is lost
    ignored,     ///< rest of a frame that is lost already
  };

  /// `data` is the fragment's part of the frame, without a time stamp.
  [[nodiscard]] Verdict add(const EoeHeader& header, std::span<const std::byte> data);

  /// Valid after `complete` until the next add().
  [[nodiscard]] std::span<const std::byte> frame() const {
    return std::span(buffer_).first(length_);
  }

  /// True while fragments of a frame are missing.
  [[nodiscard]] bool in_progress() const { return in_progress_; }
  /// Number of the fragment that has to come while in_progress().
  [[nodiscard]] std::uint8_t expected_fragment() const { return expected_fragment_; }

  void reset() { in_progress_ = false; }

 private:
  [[nodiscard]] bool fits(const EoeHeader& header, std::span<const std::byte> data) const;

  std::array<std::byte, kMaximumEoeFrame> buffer_{};
  std::size_t length_ = 0;
  std::size_t announced_ = 0;  ///< by fragment 0: length of the frame rounded up
  std::uint8_t expected_fragment_ = 0;
  std::uint8_t frame_number_ = 0;
  bool in_progress_ = false;
};

}  // namespace stator::ethercat
