#include "stator/dictionary/abort_code.hpp"

namespace stator::dictionary {

std::string_view to_text(AbortCode code) {
  switch (code) {
    case AbortCode::toggle_bit_not_changed:
      return "toggle bit not changed";
    case AbortCode::protocol_timeout:
      return "SDO protocol timeout";
    case AbortCode::command_specifier_unknown:
      return "client/server command specifier not valid or unknown";
    case AbortCode::invalid_block_size:
      return "invalid block size";
    case AbortCode::invalid_sequence_number:
      return "invalid sequence number";
    case AbortCode::crc_error:
      return "CRC error";
    case AbortCode::out_of_memory:
      return "out of memory";
    case AbortCode::unsupported_access:
      return "unsupported access to an object";
    case AbortCode::write_only:
      return "attempt to read a write-only object";
    case AbortCode::read_only:
      return "attempt to write a read-only object";
    case AbortCode::subindex_zero_must_be_zero:
      return "subindex cannot be written, subindex 0 must be 0 for write access";
    case AbortCode::complete_access_not_supported:
      return "complete access not supported for this object";
    case AbortCode::object_exceeds_mailbox:
      return "object length exceeds mailbox size";
    case AbortCode::mapped_as_receive_pdo:
      return "object mapped to RxPDO, SDO download blocked";
    case AbortCode::object_does_not_exist:
      return "the object does not exist in the object dictionary";
    case AbortCode::not_mappable:
      return "the object cannot be mapped to the PDO";
    case AbortCode::pdo_length_exceeded:
      return "number and length of the objects to be mapped would exceed the PDO length";
    case AbortCode::parameter_incompatible:
      return "general parameter incompatibility";
    case AbortCode::internal_incompatibility:
      return "general internal incompatibility in the device";
    case AbortCode::hardware_error:
      return "access failed due to a hardware error";
    case AbortCode::length_mismatch:
      return "data type does not match, length of service parameter does not match";
    case AbortCode::length_too_high:
      return "data type does not match, length of service parameter too high";
    case AbortCode::length_too_low:
      return "data type does not match, length of service parameter too low";
    case AbortCode::subindex_does_not_exist:
      return "subindex does not exist";
    case AbortCode::value_range_exceeded:
      return "value range of parameter exceeded";
    case AbortCode::value_too_high:
      return "value of parameter written too high";
    case AbortCode::value_too_low:
      return "value of parameter written too low";
    case AbortCode::maximum_below_minimum:
      return "maximum value is less than minimum value";
    case AbortCode::general_error:
      return "general error";
    case AbortCode::cannot_store:
      return "data cannot be transferred or stored to the application";
    case AbortCode::local_control:
      return "data cannot be transferred or stored to the application because of local control";
    case AbortCode::device_state:
      return "data cannot be transferred or stored to the application because of the present "
             "device state";
    case AbortCode::dictionary_missing:
      return "object dictionary dynamic generation fails or no object dictionary is present";
    case AbortCode::no_data_available:
      return "no data available";
  }
  return "unknown abort code";
}

}  // namespace stator::dictionary
