#pragma once

#include <boost/asio/ip/tcp.hpp>

#include "stator/web/server/server_context.hpp"

namespace stator::web {

/// Answers the requests of HTTP that come over `socket`, one after the other, until it ends or
/// becomes a WebSocket.
void serve_connection(ServerContext& server, boost::asio::ip::tcp::socket&& socket);

}  // namespace stator::web
