#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "stator/master/mailbox_client.hpp"
#include "stator/master/sdo_types.hpp"

namespace stator::master {

/// Reads and writes objects of one slave by SDO (ETG.1000.6 §5.6.2): expedited, normal and
/// segmented, whatever the length asks for. A transfer the slave aborts is ErrorCode::sdo_aborted
/// with the abort code in `detail`.
class SdoClient {
 public:
  explicit SdoClient(MailboxClient& mailbox) : mailbox_(mailbox) {}

  Result<std::vector<std::byte>> upload(const ObjectAddress& object);
  Result<void> download(const ObjectAddress& object, std::span<const std::byte> data);

 private:
  struct Transfer {
    const char* verb = "";  ///< "read" or "write", for messages
    ObjectAddress object;
  };

  Result<void> send(std::span<const std::byte> sdo);
  Result<std::vector<std::byte>> receive(const Transfer& transfer, bool initiate);
  Result<void> upload_segments(const Transfer& transfer, std::size_t total,
                               std::vector<std::byte>& data);
  Result<void> download_segments(const Transfer& transfer, std::span<const std::byte> rest);
  Result<void> abort(const Transfer& transfer, std::uint32_t code, const std::string& reason);
  [[nodiscard]] Error protocol_error(const Transfer& transfer, const std::string& what) const;

  MailboxClient& mailbox_;
};

}  // namespace stator::master
