#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "stator/master/mailbox_client.hpp"
#include "stator/master/sdo_types.hpp"

namespace stator::master {

/// Asks one slave what its object dictionary contains (SDO information, ETG.1000.6 §5.6.3). A
/// request the slave refuses is ErrorCode::sdo_aborted with the abort code in `detail`.
class SdoInformationClient {
 public:
  explicit SdoInformationClient(MailboxClient& mailbox) : mailbox_(mailbox) {}

  Result<std::vector<std::uint16_t>> object_list(ObjectListType type);
  Result<ObjectDescription> object_description(std::uint16_t index);
  Result<EntryDescription> entry_description(std::uint16_t index, std::uint8_t subindex);

 private:
  Result<std::vector<std::byte>> request(std::uint8_t opcode, std::span<const std::byte> data,
                                         const std::string& what);

  MailboxClient& mailbox_;
};

}  // namespace stator::master
