#pragma once

#include <cstdint>
#include <string>

#include <netinet/in.h>

#include "stator/base/expected.hpp"
#include "stator/link/system/error.hpp"
#include "stator/link/system/file_descriptor.hpp"

namespace stator::link {

/// Tells every two seconds by UDP broadcast, port 42000, where a socketcand server is. One that
/// listens on the loopback address tells this machine only.
class SocketcandBeacon {
 public:
  static base::Expected<SocketcandBeacon, LinkError> open(const std::string& address,
                                                          std::uint16_t port);

  /// Is readable when send() is due.
  [[nodiscard]] int descriptor() const { return timer_.get(); }
  void send();

 private:
  SocketcandBeacon() = default;

  FileDescriptor timer_;
  FileDescriptor socket_;
  sockaddr_in to_{};
  std::string message_;
};

/// The message itself: XML with the server's URL and its bus.
[[nodiscard]] std::string socketcand_beacon(const std::string& host, const std::string& address,
                                            std::uint16_t port);

}  // namespace stator::link
