#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/eoe/ethernet_port.hpp"

namespace stator::ethercat {

/// Type field of the EoE header (ETG.1000.6 §5.7).
enum class EoeType : std::uint8_t {
  fragment = 0,
  time_stamp_response = 1,
  set_ip_request = 2,  ///< also called initiate request
  set_ip_response = 3,
  set_filter_request = 4,
  set_filter_response = 5,
  get_ip_request = 6,
  get_ip_response = 7,
  get_filter_request = 8,
  get_filter_response = 9,
};

/// Result field of the responses.
enum class EoeResult : std::uint16_t {
  success = 0x0000,
  unspecified_error = 0x0001,
  unsupported_frame_type = 0x0002,
  no_ip_support = 0x0201,
  no_dhcp_support = 0x0202,
  no_filter_support = 0x0401,
  invalid_ip_parameter = 0x0402,  ///< not in ETG.1000.6, which has no code for a value
};

/// The EoE header: four bytes behind the mailbox header. Of a fragment the second word holds
/// number, offset and frame number, of a response the result.
struct EoeHeader {
  static constexpr std::size_t kSize = 4;
  /// Bytes that one step of a fragment's offset stands for.
  static constexpr std::size_t kOffsetUnit = 32;

  EoeType type = EoeType::fragment;
  std::uint8_t port = 0;  ///< 0 = no particular one
  bool last_fragment = false;
  bool time_stamp_appended = false;   ///< the last four bytes are a time stamp, not frame
  bool time_stamp_requested = false;  ///< the sender wants a time stamp response
  std::uint8_t fragment_number = 0;   ///< 6 bits
  /// 6 bits, units of 32 bytes: where the fragment lies in the frame; of fragment 0 the size of the
  /// whole frame, rounded up.
  std::uint8_t offset = 0;
  std::uint8_t frame_number = 0;  ///< 4 bits

  /// `bytes` must hold kSize bytes.
  [[nodiscard]] static EoeHeader decode(std::span<const std::byte> bytes) {
    const unsigned info = base::load_le<std::uint16_t>(bytes, 0);
    const unsigned data = base::load_le<std::uint16_t>(bytes, 2);
    return {.type = static_cast<EoeType>(info & 0x0F),
            .port = static_cast<std::uint8_t>(info >> 4 & 0x0F),
            .last_fragment = (info & 0x0100) != 0,
            .time_stamp_appended = (info & 0x0200) != 0,
            .time_stamp_requested = (info & 0x0400) != 0,
            .fragment_number = static_cast<std::uint8_t>(data & 0x3F),
            .offset = static_cast<std::uint8_t>(data >> 6 & 0x3F),
            .frame_number = static_cast<std::uint8_t>(data >> 12)};
  }

  /// `bytes` must hold kSize bytes.
  void encode(std::span<std::byte> bytes) const {
    const unsigned info = static_cast<unsigned>(type) | (port & 0x0FU) << 4 |
                          (last_fragment ? 0x0100U : 0U) | (time_stamp_appended ? 0x0200U : 0U) |
                          (time_stamp_requested ? 0x0400U : 0U);
    const unsigned data =
        (fragment_number & 0x3FU) | (offset & 0x3FU) << 6 | (frame_number & 0x0FU) << 12;
    base::store_le(bytes, 0, static_cast<std::uint16_t>(info));
    base::store_le(bytes, 2, static_cast<std::uint16_t>(data));
  }
};

/// Longest IP parameter block: flags, MAC address, four IPv4 addresses, DNS name.
inline constexpr std::size_t kMaximumIpParameterBlock = 4 + 6 + 4 * 4 + IpParameters::kDnsNameSize;

/// Reads the block behind the header of a set IP parameter request into `parameters`; what it does
/// not contain keeps its value. False, with nothing changed, if it is shorter than its flags say.
/// A DNS name may be shorter than its field. ETG.1000.6 does not say whether a parameter that is
/// not contained keeps its place: SOEM and SOES pack those that are, IgH always sends the longest
/// block with every parameter at its own place. A block of kMaximumIpParameterBlock bytes is read
/// that way, which for a packed one, with all parameters, is the same. Bytes behind the last
/// parameter are ignored. `append_time_stamp` tells whether the master wants a time stamp behind
/// each frame it gets.
[[nodiscard]] bool decode_ip_parameters(std::span<const std::byte> block, IpParameters& parameters,
                                        bool& append_time_stamp);

/// Writes the block of a get IP parameter response into `block` (kMaximumIpParameterBlock bytes)
/// and returns its length.
std::size_t encode_ip_parameters(const IpParameters& parameters, std::span<std::byte> block);

}  // namespace stator::ethercat
