#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/can/frame.hpp"
#include "stator/master/error.hpp"
#include "stator/master/sdo_types.hpp"

namespace stator::master {

/// SDO client of a CANopen node on the identifiers of the predefined connection set (CiA 301
/// §7.2.4, §7.3.3): expedited and segmented transfers.
class CanSdoClient {
 public:
  /// Sends a request; returns the node's next answer to it, nothing if none came in time.
  using Exchange = std::function<std::optional<can::Frame>(const can::Frame&)>;

  /// Identifiers of the node's default SDO.
  static constexpr std::uint32_t kRequest = 0x600;
  static constexpr std::uint32_t kAnswer = 0x580;

  CanSdoClient(std::uint8_t node_id, Exchange exchange)
      : node_id_(node_id), exchange_(std::move(exchange)) {}

  /// ErrorCode::sdo_aborted with the node's abort code, mailbox: no answer, protocol: an answer
  /// that is none.
  Result<std::vector<std::byte>> upload(ObjectAddress object);
  Result<void> download(ObjectAddress object, std::span<const std::byte> data);

 private:
  using Data = std::array<std::byte, can::kMaximumData>;

  Result<Data> ask(const Data& request, ObjectAddress object);
  Result<std::vector<std::byte>> upload_segments(ObjectAddress object);
  Result<void> download_segments(ObjectAddress object, std::span<const std::byte> data);

  std::uint8_t node_id_;
  Exchange exchange_;
};

}  // namespace stator::master
