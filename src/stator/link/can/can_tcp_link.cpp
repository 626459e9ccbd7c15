#include "stator/link/can/can_tcp_link.hpp"

#include <cerrno>
#include <utility>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include "stator/link/can/can_link_events.hpp"
#include "stator/link/can/slcan_session.hpp"
#include "stator/link/can/socketcand_session.hpp"
#include "stator/link/system/failure.hpp"
#include "stator/link/system/socket_options.hpp"
#include "stator/link/system/tcp_listener.hpp"

namespace stator::link {

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
  auto listener = listen_at(address_.name, address_.port, wanted);
  if (!listener) {
    return base::Unexpected{listener.error()};
  }
  listener_ = std::move(*listener);
  if (auto prepared = prepare(to_text(address_)); !prepared) {
    return prepared;
  }
  if (address_.beacon) {
    auto beacon = SocketcandBeacon::open(address_.name, address_.port);
    if (!beacon) {
      return base::Unexpected{beacon.error()};
    }
    beacon_ = std::move(*beacon);
    if (auto watched = watch(beacon_->descriptor()); !watched) {
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
  FileDescriptor connection = accept_connection(listener_);
  if (!connection.is_open()) {
    return;
  }
  std::ignore = add_client(std::move(connection), make_session());
}

void CanTcpLink::on_read(Client& client) {
  // The system falls back to delaying acknowledgements by 40 ms, for which a client that does not
  // set TCP_NODELAY waits before it sends its next frame.
  set_socket_option(client.descriptor.get(), IPPROTO_TCP, TCP_QUICKACK, int{1});
}

std::string CanTcpLink::usage() const {
  return "can.Bus(" + python_can_arguments(address_) + ")";
}

}  // namespace stator::link
