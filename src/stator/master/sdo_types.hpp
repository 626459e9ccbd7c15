#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace stator::master {

/// What an SDO transfer reads or writes.
struct ObjectAddress {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  bool complete_access = false;  ///< all subindices from `subindex` (0 or 1) in one transfer
};

/// An object as the SDO information service describes it (ETG.1000.6 §5.6.3.5).
struct ObjectDescription {
  std::uint16_t index = 0;
  std::uint16_t data_type = 0;
  std::uint8_t maximum_subindex = 0;
  std::uint8_t object_code = 0;
  std::string name{};
};

/// An entry as the SDO information service describes it (ETG.1000.6 §5.6.3.6).
struct EntryDescription {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::uint16_t data_type = 0;
  std::uint16_t bit_length = 0;
  std::uint16_t access = 0;  ///< bits 0-2 read, 3-5 write in PreOp, SafeOp, Op; 6 RxPDO, 7 TxPDO
  std::string name{};
  std::vector<std::byte> default_value{};  ///< as an SDO would carry it; empty: not given
  std::vector<std::byte> minimum{};
  std::vector<std::byte> maximum{};
};

/// Which list of objects the SDO information service shall give (ETG.1000.6 table 44).
enum class ObjectListType : std::uint16_t {
  all = 1,
  mappable_in_receive_pdo = 2,
  mappable_in_transmit_pdo = 3,
  stored_for_replacement = 4,
  startup_parameters = 5,
};

/// An emergency message (ETG.1000.6 §5.6.4), taken aside while waiting for something else.
struct Emergency {
  std::uint16_t error_code = 0;
  std::uint8_t error_register = 0;
  std::vector<std::byte> data;  ///< five bytes of the manufacturer
};

}  // namespace stator::master
