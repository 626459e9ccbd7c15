// The only source that knows Boost.Beast, which takes long to compile.
#include "web/server.hpp"

#include <algorithm>
#include <deque>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include <boost/asio/dispatch.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <fmt/format.h>

#include "web/api.hpp"
#include "web/guard.hpp"
#include "web/problem.hpp"
#include "web/routes.hpp"
#include "web/signal_stream.hpp"
#include "web/state.hpp"

namespace stator::web {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using Clock = std::chrono::steady_clock;

/// How often the desk is asked for what is done while something is under way, and how often streams
/// are filled.
constexpr std::chrono::milliseconds kDeskPeriod{2};
constexpr std::chrono::milliseconds kStreamPeriod{20};
/// How often events are fetched: far more often than the log forgets them.
constexpr std::chrono::milliseconds kEventPeriod{250};
/// The same while a stream waits for them, as an oscilloscope's trigger does.
constexpr std::chrono::milliseconds kStreamedEventPeriod{50};
/// How long to wait after the system had no descriptor for a connection.
constexpr std::chrono::milliseconds kAcceptPause{100};
/// Jobs of requests under way at most; the rest of the desk is for streams.
constexpr std::size_t kMostJobs = rack::Desk::kCapacity / 2;
/// What is read of a refused request before its connection is closed, so that the answer arrives.
constexpr std::size_t kLingeringBytes = std::size_t{1} << 20U;
constexpr std::chrono::milliseconds kLingeringTime{500};
constexpr int kBacklog = 128;

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
  request.websocket_protocol = field(message, http::field::sec_websocket_protocol);
  if (message.count("Sec-Fetch-Site") == 1) {
    request.fetch_site = std::string(message["Sec-Fetch-Site"]);
  }
  return request;
}

/// The whole answer to a connection that is one too many.
std::string refusal_of_connection() {
  const Response response = problem(503, "too many connections are open; try again later");
  return fmt::format(
      "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nConnection: close\r\nContent-Length: {}\r\n\r\n{}",
      response.status, reason(response.status), response.content_type, response.body.size(),
      response.body);
}

bool is_json(const Request& request) {
  const std::string type = request.content_type.value_or("");
  return beast::iequals(type.substr(0, type.find_first_of("; ")), "application/json");
}

}  // namespace

class Server::Implementation {
 public:
  Implementation(const ServerConfiguration& configuration, rack::Rack& rack,
                 const rack::RackConfiguration& rack_configuration, const rack::EventLog& log,
                 rack::Runner& runner)
      : limits_(configuration.limits),
        address_(configuration.address),
        guard_(configuration.address.loopback(), configuration.token),
        state_(rack, rack_configuration, log, runner),
        desk_(runner.desk()),
        acceptor_(context_),
        accept_pause_(context_),
        tick_(context_) {
    if (configuration.token.empty() && !address_.loopback()) {
      throw std::runtime_error(fmt::format(
          "a web server at {} is open to other machines and needs a token: name a file with "
          "--http-token, or listen at 127.0.0.1",
          address_.text()));
    }
    listen();
  }

  void start() {
    thread_ = std::thread([this] {
      accept();
      tick();
      context_.run();
    });
  }

  void stop() {
    context_.stop();
    if (thread_.joinable()) {
      thread_.join();
    }
    // The rack may still have the tasks, but connections must not outlive what they run on.
    for (Waiting& each : waiting_) {
      each.connection.reset();
    }
    for (Tap& each : taps_) {
      each.stream.reset();
    }
  }

  [[nodiscard]] const Address& address() const { return address_; }

 private:
  class Connection;
  class Stream;

  struct Waiting {
    std::unique_ptr<Job> job;
    std::shared_ptr<Connection> connection;  ///< null: nobody waits any more
    Clock::time_point deadline;
  };

  struct Tap {
    std::unique_ptr<TapTask> task;
    std::shared_ptr<Stream> stream;  ///< null: it is on its way out
    bool under_way = false;          ///< the rack has the task
    bool inside = false;             ///< the rack samples
  };

  void listen();
  void accept();
  void take(tcp::socket socket);
  void tick();
  void fetch_done();
  void finish_job(const rack::DeskTask* task);
  void finish_tap(const rack::DeskTask* task);
  void drop_late();
  void fill_streams();
  void serve_taps();
  [[nodiscard]] bool post(std::unique_ptr<Job> job, std::shared_ptr<Connection> connection);
  void tap(const std::shared_ptr<Stream>& stream, const Subscription& subscription);
  void untap(const Stream* stream);
  [[nodiscard]] std::int64_t values_left(const Stream* asking) const;
  void wake() {
    tick_period_ = kDeskPeriod;
    tick_.cancel();
  }

  ServerLimits limits_;
  Address address_;
  Guard guard_;
  State state_;
  rack::Desk& desk_;
  std::string too_many_ = refusal_of_connection();
  std::deque<Waiting> waiting_;
  std::vector<Tap> taps_;
  Clock::time_point next_fill_;
  Clock::time_point next_fetch_;
  bool events_streamed_ = false;
  std::chrono::milliseconds tick_period_{kDeskPeriod};
  asio::io_context context_{1};
  tcp::acceptor acceptor_;
  asio::steady_timer accept_pause_;
  asio::steady_timer tick_;
  std::vector<std::weak_ptr<Stream>> streams_;
  std::thread thread_;
};

/// A WebSocket of one client.
class Server::Implementation::Stream : public std::enable_shared_from_this<Stream> {
 public:
  Stream(Implementation& server, beast::tcp_stream&& stream)
      : server_(server), socket_(std::move(stream)), queue_(server.state_.counters) {
    ++server_.state_.counters.streams;
    ++server_.state_.counters.connections;
  }
  ~Stream() {
    --server_.state_.counters.streams;
    --server_.state_.counters.connections;
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  void begin(const http::request<http::string_body>& request, std::string_view protocol) {
    beast::get_lowest_layer(socket_).expires_never();
    websocket::stream_base::timeout timeout{};
    timeout.handshake_timeout = server_.limits_.request_time;
    timeout.idle_timeout = server_.limits_.stream_idle_time;
    timeout.keep_alive_pings = true;
    socket_.set_option(timeout);
    socket_.auto_fragment(false);  // the messages are short, and one frame each is easier to read
    socket_.read_message_max(server_.limits_.message_bytes);
    socket_.set_option(websocket::stream_base::decorator(
        [chosen = std::string(protocol)](websocket::response_type& response) {
          if (!chosen.empty()) {
            response.set(http::field::sec_websocket_protocol, chosen);
          }
        }));
    socket_.async_accept(request, [self = shared_from_this()](beast::error_code error) {
      if (!error) {
        self->read();
      }
    });
  }

  /// The subscription has taken effect, or ended: the client may say the next thing.
  void changed() { read(); }
  void collect(rack::SignalTap& tap) {
    queue_.collect(tap);
    write();
  }
  void forget_tap() { queue_.forget_tap(); }
  /// Whether the client wants events; those that came since are on their way then.
  bool collect_events() {
    if (ended_ || !queue_.wants_events()) {
      return false;
    }
    queue_.collect_events(server_.state_);
    write();
    return true;
  }

  std::int64_t values_per_second = 0;

 private:
  void read() {
    if (ended_) {
      return;
    }
    socket_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (error) {
        self->end();
        return;
      }
      self->take();
    });
  }

  void take() {
    const std::string text = beast::buffers_to_string(buffer_.data());
    buffer_.consume(buffer_.size());
    if (!socket_.got_text()) {
      close(websocket::close_code::unknown_data);
      return;
    }
    const auto parsed = parse_subscription(text, server_.state_, server_.values_left(this));
    if (const auto* wrong = std::get_if<Response>(&parsed)) {
      queue_.push_problem(*wrong);
      write();
      read();
      return;
    }
    const auto& subscription = std::get<Subscription>(parsed);
    queue_.forget_tap();
    queue_.push_subscribed(server_.state_, subscription);
    values_per_second = subscription.values_per_second();
    server_.untap(this);
    write();
    if (subscription.signals.empty()) {
      read();
    } else {
      server_.tap(shared_from_this(), subscription);  // then reads on
    }
  }

  void write() {
    if (ended_ || writing_ || queue_.empty()) {
      return;
    }
    writing_ = true;
    message_ = queue_.take();
    socket_.text(!message_.binary);
    socket_.async_write(asio::buffer(message_.payload),
                        [self = shared_from_this()](beast::error_code error, std::size_t) {
                          self->writing_ = false;
                          if (error) {
                            self->end();
                          } else {
                            self->write();
                          }
                        });
  }

  void close(websocket::close_code code) {
    end();
    socket_.async_close(code, [self = shared_from_this()](beast::error_code) {});
  }

  void end() {
    if (!std::exchange(ended_, true)) {
      server_.untap(this);
    }
  }

  Implementation& server_;
  websocket::stream<beast::tcp_stream> socket_;
  beast::flat_buffer buffer_;
  StreamQueue queue_;
  StreamQueue::Message message_;  ///< on its way
  bool writing_ = false;
  bool ended_ = false;
};

/// A connection of HTTP, one request after the other.
class Server::Implementation::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Implementation& server, tcp::socket&& socket)
      : server_(server),
        socket_(std::move(socket)),
        buffer_(server.limits_.header_bytes + server.limits_.body_bytes) {
    ++server_.state_.counters.connections;
  }
  ~Connection() { --server_.state_.counters.connections; }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void read() {
    parser_.emplace();
    parser_->header_limit(static_cast<std::uint32_t>(server_.limits_.header_bytes));
    parser_->body_limit(server_.limits_.body_bytes);
    socket_.expires_after(server_.limits_.request_time);
    http::async_read_header(socket_, buffer_, *parser_,
                            [self = shared_from_this()](beast::error_code error, std::size_t) {
                              self->take_header(error);
                            });
  }

  void answer(Response response) {
    ++server_.state_.counters.answers[response.status];
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
    socket_.expires_after(server_.limits_.request_time);
    http::async_write(socket_, *serializer_,
                      [self = shared_from_this()](beast::error_code error, std::size_t) {
                        self->written(error);
                      });
  }

 private:
  void take_header(beast::error_code error) {
    if (error) {
      refuse(error);
      return;
    }
    const auto& message = parser_->get();
    request_ = request_of(message);
    keep_alive_ = message.keep_alive();
    const auto found = find_route(request_);
    const auto* nowhere = std::get_if<Response>(&found);
    auto refused = server_.guard_.check_source(request_);
    if (!refused && nowhere != nullptr) {
      // Also what does not exist is told only to those who may ask.
      refused = server_.guard_.check_token(request_, false, false).value_or(*nowhere);
    }
    if (!refused) {
      match_ = std::get<Match>(found);
      refused = server_.guard_.check_token(request_, match_.route->writes(), match_.route->open);
    }
    if (!refused && match_.route->writes() && !is_json(request_)) {
      refused = problem(415, "the body must be of type application/json");
    }
    if (refused) {
      keep_alive_ = keep_alive_ && parser_->is_done();
      answer(std::move(*refused));
      return;
    }
    if (match_.route->stream && websocket::is_upgrade(message)) {
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
    auto found = [this]() -> std::variant<Response, std::unique_ptr<Job>> {
      try {
        return web::answer(match_, request_, server_.state_);
      } catch (const std::exception& failure) {
        return problem(500, failure.what());
      }
    }();
    if (auto* response = std::get_if<Response>(&found)) {
      answer(std::move(*response));
      return;
    }
    socket_.expires_never();  // the job has a deadline of its own
    if (!server_.post(std::get<std::unique_ptr<Job>>(std::move(found)), shared_from_this())) {
      answer(problem(503, "the rack has too much to do; try again later"));
    }
  }

  void upgrade() {
    if (server_.state_.counters.streams >= server_.limits_.streams) {
      keep_alive_ = false;
      answer(problem(
          503, fmt::format("{} streams are open, more are not possible", server_.limits_.streams)));
      return;
    }
    ++server_.state_.counters.answers[101];
    auto stream = std::make_shared<Stream>(server_, std::move(socket_));
    std::erase_if(server_.streams_, [](const auto& each) { return each.expired(); });
    server_.streams_.push_back(stream);
    stream->begin(parser_->get(), Guard::chosen_protocol(request_));
  }

  /// The request could not be read.
  void refuse(beast::error_code error) {
    keep_alive_ = false;
    if (error == http::error::header_limit || error == http::error::buffer_overflow) {
      answer(problem(431, fmt::format("the head of a request has {} bytes at most",
                                      server_.limits_.header_bytes)));
    } else if (error == http::error::body_limit) {
      answer(problem(413, fmt::format("the body of a request has {} bytes at most",
                                      server_.limits_.body_bytes)));
    } else if (error == beast::error::timeout) {
      // The library has closed the connection; there is nobody to tell.
      ++server_.state_.counters.answers[408];
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

  Implementation& server_;
  beast::tcp_stream socket_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::string_body>> parser_;
  Request request_;
  Match match_;
  http::response<http::string_body> response_;
  std::optional<http::response_serializer<http::string_body>> serializer_;
  bool keep_alive_ = false;
  std::size_t lingered_ = 0;
};

void Server::Implementation::listen() {
  try {
    const tcp::endpoint endpoint(asio::ip::make_address(address_.host), address_.port);
    acceptor_.open(endpoint.protocol());
    acceptor_.set_option(asio::socket_base::reuse_address(true));
    acceptor_.bind(endpoint);
    acceptor_.listen(kBacklog);
    acceptor_.non_blocking(true);
    address_.port = acceptor_.local_endpoint().port();
  } catch (const boost::system::system_error& failure) {
    throw std::runtime_error(fmt::format(
        "the web server cannot listen at {}: {}; name a free port and an address of this machine",
        address_.text(), failure.code().message()));
  }
}

void Server::Implementation::accept() {
  acceptor_.async_accept([this](beast::error_code error, tcp::socket socket) {
    if (!error) {
      take(std::move(socket));
      accept();
      return;
    }
    accept_pause_.expires_after(kAcceptPause);
    accept_pause_.async_wait([this](beast::error_code) { accept(); });
  });
}

void Server::Implementation::take(tcp::socket socket) {
  if (state_.counters.connections >= limits_.connections) {
    ++state_.counters.connections_refused;
    beast::error_code ignored;
    socket.non_blocking(true, ignored);
    socket.write_some(asio::buffer(too_many_), ignored);
    socket.shutdown(tcp::socket::shutdown_send, ignored);
    return;
  }
  beast::error_code ignored;
  socket.set_option(tcp::no_delay(true), ignored);
  std::make_shared<Connection>(*this, std::move(socket))->read();
}

void Server::Implementation::tick() {
  fetch_done();
  drop_late();
  serve_taps();
  const Clock::time_point now = Clock::now();
  if (now >= next_fill_) {
    next_fill_ = now + kStreamPeriod;
    fill_streams();
  }
  if (now >= next_fetch_) {
    next_fetch_ = now + (events_streamed_ ? kStreamedEventPeriod : kEventPeriod);
    static_cast<void>(post(fetch_events(state_), nullptr));
  }
  const bool busy = !waiting_.empty() ||
                    std::ranges::any_of(taps_, [](const Tap& each) { return each.under_way; });
  tick_period_ = busy ? kDeskPeriod : kStreamPeriod;
  tick_.expires_after(tick_period_);
  tick_.async_wait([this](beast::error_code) { tick(); });
}

void Server::Implementation::fetch_done() {
  while (const rack::DeskTask* task = desk_.take_done()) {
    finish_tap(task);
    finish_job(task);
  }
}

void Server::Implementation::finish_job(const rack::DeskTask* task) {
  const auto found = std::ranges::find_if(
      waiting_, [task](const Waiting& each) { return each.job.get() == task; });
  if (found == waiting_.end()) {
    return;
  }
  const Waiting done = std::move(*found);
  waiting_.erase(found);
  Response response = done.job->response();
  if (done.connection != nullptr) {
    done.connection->answer(std::move(response));
  }
}

void Server::Implementation::finish_tap(const rack::DeskTask* task) {
  const auto found =
      std::ranges::find_if(taps_, [task](const Tap& each) { return each.task.get() == task; });
  if (found == taps_.end()) {
    return;
  }
  found->under_way = false;
  found->inside = !found->inside;
  if (!found->inside) {
    taps_.erase(found);
  } else if (found->stream != nullptr) {
    found->stream->changed();
  }
}

// The job itself stays until the rack has done it.
void Server::Implementation::drop_late() {
  const Clock::time_point now = Clock::now();
  for (Waiting& each : waiting_) {
    if (each.connection != nullptr && each.deadline <= now) {
      std::exchange(each.connection, nullptr)
          ->answer(problem(503, "the rack has not answered; have its links failed?"));
    }
  }
}

void Server::Implementation::fill_streams() {
  for (Tap& each : taps_) {
    if (each.inside && each.stream != nullptr) {
      const std::shared_ptr<Stream> stream = each.stream;
      stream->collect(each.task->tap());
    }
  }
  events_streamed_ = false;
  for (const auto& each : streams_) {
    if (const std::shared_ptr<Stream> stream = each.lock()) {
      events_streamed_ |= stream->collect_events();
    }
  }
}

// Brings taps into the rack, and those that nobody wants any more out of it.
void Server::Implementation::serve_taps() {
  for (Tap& each : taps_) {
    const bool wanted = each.stream != nullptr;
    if (!each.under_way && wanted != each.inside) {
      each.under_way = desk_.post(*each.task);
    }
  }
  std::erase_if(taps_, [](const Tap& each) {
    return !each.under_way && !each.inside && each.stream == nullptr;
  });
}

bool Server::Implementation::post(std::unique_ptr<Job> job,
                                  std::shared_ptr<Connection> connection) {
  if (waiting_.size() >= kMostJobs || !desk_.post(*job)) {
    return false;
  }
  waiting_.push_back({std::move(job), std::move(connection), Clock::now() + limits_.rack_time});
  wake();
  return true;
}

void Server::Implementation::tap(const std::shared_ptr<Stream>& stream,
                                 const Subscription& subscription) {
  Tap added;
  added.task = std::make_unique<TapTask>(state_, subscription);
  added.stream = stream;
  taps_.push_back(std::move(added));
  wake();
}

void Server::Implementation::untap(const Stream* stream) {
  for (Tap& each : taps_) {
    if (each.stream.get() == stream) {
      each.stream.reset();
    }
  }
}

std::int64_t Server::Implementation::values_left(const Stream* asking) const {
  std::int64_t left = kMostValuesPerSecond;
  for (const auto& each : streams_) {
    const std::shared_ptr<Stream> stream = each.lock();
    left -= stream != nullptr && stream.get() != asking ? stream->values_per_second : 0;
  }
  return left;
}

Server::Server(const ServerConfiguration& configuration, rack::Rack& rack,
               const rack::RackConfiguration& rack_configuration, const rack::EventLog& log,
               rack::Runner& runner)
    : implementation_(
          std::make_unique<Implementation>(configuration, rack, rack_configuration, log, runner)) {}

Server::~Server() {
  stop();
}

void Server::start() {
  implementation_->start();
}

void Server::stop() {
  implementation_->stop();
}

const Address& Server::address() const {
  return implementation_->address();
}

}  // namespace stator::web
