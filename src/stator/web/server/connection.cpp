#include "stator/web/server/connection.hpp"

#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <fmt/format.h>

#include "stator/web/api/api.hpp"
#include "stator/web/api/routes.hpp"
#include "stator/web/problem.hpp"
#include "stator/web/server/web_socket.hpp"
#include "stator/web/stream/signal_session.hpp"
#include "stator/web/stream/traffic_session.hpp"

namespace stator::web {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;

/// What is read of a refused request before its connection is closed, so that the answer arrives.
constexpr std::size_t kLingeringBytes = std::size_t{1} << 20U;
constexpr std::chrono::milliseconds kLingeringTime{500};

template <typename Message>
std::optional<std::string> field(const Message& message, http::field name) {
  if (message.count(name) != 1) {
    return std::nullopt;
  }
  return std::string(message[name]);
}

template <typename Message>
Request request_of(const Message& message) {
  Request request;
  request.method = std::string(message.method_string());
  request.target = std::string(message.target());
  request.host = field(message, http::field::host);
  request.origin = field(message, http::field::origin);
  request.authorization = field(message, http::field::authorization);
  request.content_type = field(message, http::field::content_type);
  request.if_none_match = field(message, http::field::if_none_match);
  request.accept_encoding = field(message, http::field::accept_encoding);
  request.websocket_protocol = field(message, http::field::sec_websocket_protocol);
  if (message.count("Sec-Fetch-Site") == 1) {
    request.fetch_site = std::string(message["Sec-Fetch-Site"]);
  }
  return request;
}

bool is_json(const Request& request) {
  const std::string type = request.content_type.value_or("");
  return beast::iequals(type.substr(0, type.find_first_of("; ")), "application/json");
}

/// A connection of HTTP, one request after the other.
class Connection final : public Waiter,
                         public IdleConnection,
                         public std::enable_shared_from_this<Connection> {
 public:
  Connection(ServerContext& server, tcp::socket&& socket)
      : server_(server),
        socket_(std::move(socket)),
        buffer_(server.limits.header_bytes + server.limits.body_bytes) {
    ++server_.state.counters.connections;
  }
  ~Connection() override {
    leave_idle();
    server_.state.counters.connections -= displaced_ ? 0U : 1U;
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void read() {
    idle_ = server_.idle.enter(*this);
    parser_.emplace();
    parser_->header_limit(static_cast<std::uint32_t>(server_.limits.header_bytes));
    parser_->body_limit(server_.limits.body_bytes);
    socket_.expires_after(server_.limits.request_time);
    http::async_read_header(socket_, buffer_, *parser_,
                            [self = shared_from_this()](beast::error_code error, std::size_t) {
                              self->take_header(error);
                            });
  }

  // Its place counts as free from now on, though it ends only when its read has.
  void give_way() override {
    leave_idle();
    displaced_ = true;
    --server_.state.counters.connections;
    ++server_.state.counters.connections_displaced;
    socket_.close();
  }

  void answer(Response response) override {
    ++server_.state.counters.answers[response.status];
    response_ = {};
    response_.version(11);
    response_.result(response.status);
    response_.reason(std::string(reason(response.status)));
    response_.set(http::field::content_type, response.content_type);
    response_.set(http::field::cache_control, "no-store");
    response_.set("Content-Security-Policy", "default-src 'none'; frame-ancestors 'none'");
    response_.set("Cross-Origin-Resource-Policy", "same-origin");
    response_.set("X-Content-Type-Options", "nosniff");
    for (const auto& [name, value] : response.headers) {
      response_.set(name, value);
    }
    response_.keep_alive(keep_alive_);
    response_.content_length(response.body.size());
    if (request_.method != "HEAD") {
      response_.body() = std::move(response.body);
    }
    serializer_.emplace(response_);
    socket_.expires_after(server_.limits.request_time);
    http::async_write(socket_, *serializer_,
                      [self = shared_from_this()](beast::error_code error, std::size_t) {
                        self->written(error);
                      });
  }

 private:
  void leave_idle() {
    if (idle_) {
      server_.idle.leave(*idle_);
      idle_.reset();
    }
  }

  void take_header(beast::error_code error) {
    leave_idle();
    if (displaced_) {
      return;
    }
    if (error) {
      refuse(error);
      return;
    }
    const auto& message = parser_->get();
    request_ = request_of(message);
    keep_alive_ = message.keep_alive();
    const auto found = find_route(request_);
    const auto* nowhere = std::get_if<Response>(&found);
    auto refused = server_.guard.check_source(request_);
    if (!refused && nowhere != nullptr) {
      // That a path does not exist is told to authorised clients only.
      refused = server_.guard.check_token(request_, false, false).value_or(*nowhere);
    }
    if (!refused) {
      match_ = std::get<Match>(found);
      refused = server_.guard.check_token(request_, match_.route->writes(), match_.route->open);
    }
    if (!refused && !match_.route->request_schema.empty() && !is_json(request_)) {
      refused = problem(415, "the body must be of type application/json");
    }
    if (refused) {
      keep_alive_ = keep_alive_ && parser_->is_done();
      answer(std::move(*refused));
      return;
    }
    if (match_.route->stream() && websocket::is_upgrade(message)) {
      upgrade();
      return;
    }
    http::async_read(socket_, buffer_, *parser_,
                     [self = shared_from_this()](beast::error_code failure, std::size_t) {
                       if (failure) {
                         self->refuse(failure);
                       } else {
                         self->execute();
                       }
                     });
  }

  void execute() {
    request_.body = std::move(parser_->get().body());
    auto found = [this]() -> Answer {
      try {
        return web::answer(match_, request_, server_.state);
      } catch (const std::exception& failure) {
        return problem(500, failure.what());
      }
    }();
    if (auto* response = std::get_if<Response>(&found)) {
      answer(std::move(*response));
      return;
    }
    socket_.expires_never();  // the job has a deadline of its own
    if (!server_.access.post(std::get<std::unique_ptr<Job>>(std::move(found)),
                             shared_from_this())) {
      answer(problem(503, "the rack has too much to do; try again later"));
    }
  }

  void upgrade() {
    if (server_.state.counters.streams >= server_.limits.streams) {
      keep_alive_ = false;
      answer(problem(
          503, fmt::format("{} streams are open, more are not possible", server_.limits.streams)));
      return;
    }
    ++server_.state.counters.answers[101];
    serve_web_socket(server_, socket_.release_socket(), parser_->get(),
                     Guard::chosen_protocol(request_), make_session());
  }

  [[nodiscard]] std::unique_ptr<StreamSession> make_session() {
    if (match_.route->operation == Operation::traffic) {
      return std::make_unique<TrafficSession>(server_.traffic);
    }
    return std::make_unique<SignalSession>(server_.state, server_.access);
  }

  /// The request could not be read.
  void refuse(beast::error_code error) {
    keep_alive_ = false;
    if (error == http::error::header_limit || error == http::error::buffer_overflow) {
      answer(problem(431, fmt::format("the head of a request has {} bytes at most",
                                      server_.limits.header_bytes)));
    } else if (error == http::error::body_limit) {
      answer(problem(413, fmt::format("the body of a request has {} bytes at most",
                                      server_.limits.body_bytes)));
    } else if (error == beast::error::timeout) {
      // The library has closed the connection; there is nobody to tell.
      ++server_.state.counters.answers[408];
    } else if (error.category() == http::make_error_code(http::error::bad_target).category() &&
               error != http::error::end_of_stream && error != http::error::partial_message) {
      answer(problem(400, "this is no request of HTTP/1.1: " + error.message()));
    }
  }

  void written(beast::error_code error) {
    if (error) {
      return;
    }
    if (keep_alive_) {
      read();
      return;
    }
    beast::error_code ignored;
    socket_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    socket_.expires_after(kLingeringTime);
    linger();
  }

  // A connection that is closed with bytes unread is reset, and the answer may be lost with it.
  void linger() {
    buffer_.consume(buffer_.size());
    socket_.async_read_some(buffer_.prepare(4096),
                            [self = shared_from_this()](beast::error_code error, std::size_t read) {
                              self->lingered_ += read;
                              if (!error && self->lingered_ < kLingeringBytes) {
                                self->linger();
                              }
                            });
  }

  ServerContext& server_;
  beast::tcp_stream socket_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::string_body>> parser_;
  Request request_;
  Match match_;
  http::response<http::string_body> response_;
  std::optional<http::response_serializer<http::string_body>> serializer_;
  std::optional<IdleConnections::Place> idle_;  ///< while no request is under way
  bool displaced_ = false;
  bool keep_alive_ = false;
  std::size_t lingered_ = 0;
};

}  // namespace

void serve_connection(ServerContext& server, tcp::socket&& socket) {
  std::make_shared<Connection>(server, std::move(socket))->read();
}

}  // namespace stator::web
