#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "stator/link/can/can_link_address.hpp"
#include "stator/link/can/can_stream_link.hpp"
#include "stator/link/can/socketcand_beacon.hpp"

namespace stator::link {

/// A TCP server for slcan or socketcand with any number of programs.
class CanTcpLink final : public CanStreamLink {
 public:
  /// `address` is of one of the two kinds.
  static base::Expected<std::unique_ptr<CanLink>, LinkError> open(const CanLinkAddress& address,
                                                                  const CanLinkOptions& options);

  [[nodiscard]] std::string usage() const override;
  [[nodiscard]] std::uint16_t port() const { return address_.port; }

 private:
  CanTcpLink(CanLinkAddress address, const CanLinkOptions& options)
      : CanStreamLink(Medium::socket, options), address_(std::move(address)) {}

  base::Expected<void, LinkError> listen();
  void on_readable(int descriptor) override;
  void on_read(Client& client) override;
  [[nodiscard]] std::unique_ptr<CanStreamSession> make_session();

  CanLinkAddress address_;
  FileDescriptor listener_;
  std::optional<SocketcandBeacon> beacon_;
};

}  // namespace stator::link
