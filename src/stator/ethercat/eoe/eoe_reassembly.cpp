#include "stator/ethercat/eoe/eoe_reassembly.hpp"

#include <algorithm>

namespace stator::ethercat {

EoeReassembly::Verdict EoeReassembly::add(const EoeHeader& header,
                                          std::span<const std::byte> data) {
  if (header.fragment_number == 0) {
    length_ = 0;
    announced_ = header.offset * EoeHeader::kOffsetUnit;
    expected_fragment_ = 0;
    frame_number_ = header.frame_number;
    in_progress_ = true;
  }
  if (!in_progress_) {
    return Verdict::ignored;
  }
  if (!fits(header, data)) {
    in_progress_ = false;
    return Verdict::dropped;
  }
  std::ranges::copy(data, std::span(buffer_).subspan(length_).begin());
  length_ += data.size();
  ++expected_fragment_;
  in_progress_ = !header.last_fragment;
  return in_progress_ ? Verdict::incomplete : Verdict::complete;
}

bool EoeReassembly::fits(const EoeHeader& header, std::span<const std::byte> data) const {
  const bool in_order =
      header.fragment_number == expected_fragment_ && header.frame_number == frame_number_ &&
      (header.fragment_number == 0 || header.offset * EoeHeader::kOffsetUnit == length_);
  const bool whole_units = header.last_fragment || data.size() % EoeHeader::kOffsetUnit == 0;
  return in_order && whole_units && !data.empty() &&
         length_ + data.size() <= std::min(announced_, buffer_.size());
}

}  // namespace stator::ethercat
