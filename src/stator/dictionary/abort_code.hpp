#pragma once

#include <cstdint>
#include <string_view>

namespace stator::dictionary {

/// SDO abort codes (CiA 301 §7.2.4.3.17, ETG.1000.6 table 41).
enum class AbortCode : std::uint32_t {
  toggle_bit_not_changed = 0x05030000,
  protocol_timeout = 0x05040000,
  command_specifier_unknown = 0x05040001,
  invalid_block_size = 0x05040002,
  invalid_sequence_number = 0x05040003,
  crc_error = 0x05040004,
  out_of_memory = 0x05040005,
  unsupported_access = 0x06010000,
  write_only = 0x06010001,
  read_only = 0x06010002,
  subindex_zero_must_be_zero = 0x06010003,
  complete_access_not_supported = 0x06010004,
  object_exceeds_mailbox = 0x06010005,
  mapped_as_receive_pdo = 0x06010006,
  object_does_not_exist = 0x06020000,
  not_mappable = 0x06040041,
  pdo_length_exceeded = 0x06040042,
  parameter_incompatible = 0x06040043,
  internal_incompatibility = 0x06040047,
  hardware_error = 0x06060000,
  length_mismatch = 0x06070010,
  length_too_high = 0x06070012,
  length_too_low = 0x06070013,
  subindex_does_not_exist = 0x06090011,
  value_range_exceeded = 0x06090030,
  value_too_high = 0x06090031,
  value_too_low = 0x06090032,
  maximum_below_minimum = 0x06090036,
  general_error = 0x08000000,
  cannot_store = 0x08000020,
  local_control = 0x08000021,
  device_state = 0x08000022,
  dictionary_missing = 0x08000023,
  no_data_available = 0x08000024,
};

/// The standard's wording for `code`; "unknown abort code" for any other number.
[[nodiscard]] std::string_view to_text(AbortCode code);

}  // namespace stator::dictionary
