#pragma once

#include <memory>
#include <string_view>

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>

#include "stator/web/server/server_context.hpp"
#include "stator/web/stream/stream_session.hpp"

namespace stator::web {

using UpgradeRequest = boost::beast::http::request<boost::beast::http::string_body>;

/// Makes `socket`, on which `request` came, a WebSocket of `protocol` (empty: none) on which
/// `session` talks, until one of both ends.
void serve_web_socket(ServerContext& server, boost::asio::ip::tcp::socket&& socket,
                      const UpgradeRequest& request, std::string_view protocol,
                      std::unique_ptr<StreamSession> session);

}  // namespace stator::web
