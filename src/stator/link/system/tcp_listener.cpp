#include "stator/link/system/tcp_listener.hpp"

#include <cerrno>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include "stator/link/system/failure.hpp"
#include "stator/link/system/socket_options.hpp"

namespace stator::link {

namespace {

constexpr int kWaitingConnections = 16;

base::Unexpected<LinkError> explain(int error, const std::string& address, std::uint16_t port,
                                    const std::string& wanted) {
  switch (error) {
    case EADDRINUSE:
      return fail(LinkErrorCode::address_in_use,
                  "another program listens at TCP port " + std::to_string(port) + " of " + address +
                      "; end it (ss -ltnp shows it), or choose another port");
    case EADDRNOTAVAIL:
      return fail(LinkErrorCode::address_missing,
                  address +
                      " is not an address of this machine (ip address lists them); 0.0.0.0 "
                      "listens at all of them");
    case EACCES:
      return fail(LinkErrorCode::not_permitted,
                  "TCP port " + std::to_string(port) +
                      " needs the privilege CAP_NET_BIND_SERVICE; use a port from 1024 on");
    default:
      return system_failure("cannot listen at " + in_quotes(wanted), error);
  }
}

}  // namespace

base::Expected<FileDescriptor, LinkError> listen_at(const std::string& address, std::uint16_t& port,
                                                    const std::string& wanted) {
  sockaddr_in place{};
  place.sin_family = AF_INET;
  place.sin_port = htons(port);
  ::inet_pton(AF_INET, address.c_str(), &place.sin_addr);
  FileDescriptor listener(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!listener.is_open()) {
    return system_failure("cannot open a TCP socket for " + in_quotes(wanted), errno);
  }
  set_socket_option(listener.get(), SOL_SOCKET, SO_REUSEADDR, int{1});
  if (::bind(listener.get(), reinterpret_cast<const sockaddr*>(&place), sizeof place) != 0 ||
      ::listen(listener.get(), kWaitingConnections) != 0) {
    return explain(errno, address, port, wanted);
  }
  socklen_t size = sizeof place;
  ::getsockname(listener.get(), reinterpret_cast<sockaddr*>(&place), &size);
  port = ntohs(place.sin_port);
  return listener;
}

FileDescriptor accept_connection(const FileDescriptor& listener) {
  FileDescriptor connection(
      ::accept4(listener.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
  if (connection.is_open()) {
    set_socket_option(connection.get(), IPPROTO_TCP, TCP_NODELAY, int{1});
    set_socket_option(connection.get(), SOL_SOCKET, SO_KEEPALIVE, int{1});
  }
  return connection;
}

}  // namespace stator::link
