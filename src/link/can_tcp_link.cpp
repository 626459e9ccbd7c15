#include "link/can_tcp_link.hpp"

#include <cerrno>
#include <utility>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include "link/can_link_events.hpp"
#include "link/failure.hpp"
#include "link/slcan_session.hpp"
#include "link/socket_options.hpp"
#include "link/socketcand_session.hpp"

namespace stator::link {

namespace {

constexpr int kWaitingConnections = 16;

}  // namespace

base::Expected<std::unique_ptr<CanLink>, LinkError> CanTcpLink::open(
    const CanLinkAddress& address, const CanLinkOptions& options) {
  auto link = std::unique_ptr<CanTcpLink>(new CanTcpLink(address, options));
  if (const auto listening = link->listen(); !listening) {
    return base::Unexpected{listening.error()};
  }
  return std::unique_ptr<CanLink>(std::move(link));
}

base::Expected<void, LinkError> CanTcpLink::listen() {
  const std::string wanted = to_text(address_);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(address_.port);
  ::inet_pton(AF_INET, address_.name.c_str(), &address.sin_addr);
  listener_ = FileDescriptor(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!listener_.is_open()) {
    return system_failure("cannot open a TCP socket for " + in_quotes(wanted), errno);
  }
  set_socket_option(listener_.get(), SOL_SOCKET, SO_REUSEADDR, int{1});
  if (::bind(listener_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      ::listen(listener_.get(), kWaitingConnections) != 0) {
    switch (errno) {
      case EADDRINUSE:
        return fail(LinkErrorCode::address_in_use,
                    "another program listens at TCP port " + std::to_string(address_.port) +
                        " of " + address_.name +
                        "; end it (ss -ltnp shows it), or choose another port");
      case EADDRNOTAVAIL:
        return fail(LinkErrorCode::address_missing,
                    address_.name +
                        " is not an address of this machine (ip address lists them); 0.0.0.0 "
                        "listens at all of them");
      case EACCES:
        return fail(LinkErrorCode::not_permitted,
                    "TCP port " + std::to_string(address_.port) +
                        " needs the privilege CAP_NET_BIND_SERVICE; use a port from 1024 on");
      default:
        return system_failure("cannot listen at " + in_quotes(wanted), errno);
    }
  }
  socklen_t size = sizeof address;
  ::getsockname(listener_.get(), reinterpret_cast<sockaddr*>(&address), &size);
  address_.port = ntohs(address.sin_port);
  if (const auto prepared = prepare(to_text(address_)); !prepared) {
    return prepared;
  }
  if (address_.beacon) {
    auto beacon = SocketcandBeacon::open(address_.name, address_.port);
    if (!beacon) {
      return base::Unexpected{beacon.error()};
    }
    beacon_ = std::move(*beacon);
    if (const auto watched = watch(beacon_->descriptor()); !watched) {
      return watched;
    }
  }
  return watch(listener_.get());
}

std::unique_ptr<CanStreamSession> CanTcpLink::make_session() {
  if (address_.kind == CanLinkKind::socketcand) {
    return std::make_unique<SocketcandSession>();
  }
  return std::make_unique<SlcanSession>(address_.acknowledge, [this](unsigned bit_rate) {
    report_bit_rate(*this, options(), now(), bit_rate);
  });
}

void CanTcpLink::on_readable(int descriptor) {
  if (beacon_ && descriptor == beacon_->descriptor()) {
    beacon_->send();
    return;
  }
  FileDescriptor connection(
      ::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
  if (!connection.is_open()) {
    return;
  }
  set_socket_option(connection.get(), IPPROTO_TCP, TCP_NODELAY, int{1});
  set_socket_option(connection.get(), SOL_SOCKET, SO_KEEPALIVE, int{1});
  std::ignore = add_client(std::move(connection), make_session());
}

void CanTcpLink::on_read(Client& client) {
  // The system falls back to delaying acknowledgements by 40 ms, for which a client that does not
  // set TCP_NODELAY waits before it sends its next frame.
  set_socket_option(client.descriptor.get(), IPPROTO_TCP, TCP_QUICKACK, int{1});
}

std::string CanTcpLink::usage() const {
  const std::string host = address_.name == "0.0.0.0" ? "127.0.0.1" : address_.name;
  const std::string port = std::to_string(address_.port);
  if (address_.kind == CanLinkKind::socketcand) {
    return "can.Bus(interface=\"socketcand\", host=\"" + host + "\", port=" + port +
           ", channel=\"can0\")";
  }
  return "can.Bus(interface=\"slcan\", channel=\"socket://" + host + ":" + port + "\")";
}

}  // namespace stator::link
