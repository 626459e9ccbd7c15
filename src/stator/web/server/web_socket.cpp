#include "stator/web/server/web_socket.hpp"

#include <cstddef>
#include <string>
#include <utility>

#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>

namespace stator::web {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;

/// Owned by what is under way for it: a read or a write, or what its session waits for.
class WebSocket : public std::enable_shared_from_this<WebSocket> {
 public:
  WebSocket(ServerContext& server, asio::ip::tcp::socket&& socket,
            std::unique_ptr<StreamSession> session)
      : server_(server), socket_(std::move(socket)), session_(std::move(session)) {
    ++server_.state.counters.streams;
    ++server_.state.counters.connections;
  }
  ~WebSocket() {
    --server_.state.counters.streams;
    --server_.state.counters.connections;
  }
  WebSocket(const WebSocket&) = delete;
  WebSocket& operator=(const WebSocket&) = delete;

  void begin(const UpgradeRequest& request, std::string_view protocol) {
    session_->watch(weak_from_this(), [weak = weak_from_this()] {
      if (const std::shared_ptr<WebSocket> self = weak.lock()) {
        self->write();
        self->read();
      }
    });
    // Never switch on websocket::permessage_deflate here: it would inflate what clients send, and
    // the inflate that Beast carries in Boost 1.74, as Debian 12 has it, lacks the corrections of
    // zlib's. Messages are compressed enough in binary.
    websocket::stream_base::timeout timeout{};
    timeout.handshake_timeout = server_.limits.request_time;
    timeout.idle_timeout = server_.limits.stream_idle_time;
    timeout.keep_alive_pings = true;
    socket_.set_option(timeout);
    socket_.auto_fragment(false);  // the messages are short, and one frame each is easier to read
    socket_.read_message_max(server_.limits.message_bytes);
    socket_.set_option(websocket::stream_base::decorator(
        [chosen = std::string(protocol)](websocket::response_type& response) {
          if (!chosen.empty()) {
            response.set(beast::http::field::sec_websocket_protocol, chosen);
          }
        }));
    socket_.async_accept(request, [self = shared_from_this()](beast::error_code error) {
      if (error) {
        self->end();
        return;
      }
      self->open_ = true;
      self->read();
      self->write();
    });
  }

 private:
  void read() {
    if (!open_ || reading_ || !session_->ready()) {
      return;
    }
    reading_ = true;
    socket_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      self->reading_ = false;
      if (error) {
        self->end();
      } else {
        self->take();
      }
    });
  }

  void take() {
    const std::string text = beast::buffers_to_string(buffer_.data());
    buffer_.consume(buffer_.size());
    if (!open_) {
      return;
    }
    if (!socket_.got_text()) {
      end();
      socket_.async_close(websocket::close_code::unknown_data,
                          [self = shared_from_this()](beast::error_code) {});
      return;
    }
    session_->take(text);
    write();
    read();
  }

  void write() {
    if (!open_ || writing_ || session_->empty()) {
      return;
    }
    writing_ = true;
    socket_.binary(session_->next_is_binary());
    message_ = session_->next();
    socket_.async_write(asio::buffer(message_),
                        [self = shared_from_this()](beast::error_code error, std::size_t) {
                          self->writing_ = false;
                          if (error) {
                            self->end();
                          } else {
                            self->write();
                          }
                        });
  }

  void end() {
    open_ = false;
    session_->end();
  }

  ServerContext& server_;
  websocket::stream<beast::tcp_stream> socket_;
  beast::flat_buffer buffer_;
  std::unique_ptr<StreamSession> session_;
  std::string message_;  ///< on its way
  bool open_ = false;
  bool reading_ = false;
  bool writing_ = false;
};

}  // namespace

void serve_web_socket(ServerContext& server, asio::ip::tcp::socket&& socket,
                      const UpgradeRequest& request, std::string_view protocol,
                      std::unique_ptr<StreamSession> session) {
  std::make_shared<WebSocket>(server, std::move(socket), std::move(session))
      ->begin(request, protocol);
}

}  // namespace stator::web
