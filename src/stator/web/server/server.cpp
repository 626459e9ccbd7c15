#include "stator/web/server/server.hpp"

#include <chrono>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/address.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <fmt/format.h>

#include "stator/link/ethernet/machine.hpp"
#include "stator/web/problem.hpp"
#include "stator/web/server/connection.hpp"
#include "stator/web/server/server_context.hpp"

namespace stator::web {

namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using Error = boost::system::error_code;

/// How often the rack is asked for what is done, while something is under way and otherwise.
constexpr std::chrono::milliseconds kBusyPeriod{2};
constexpr std::chrono::milliseconds kIdlePeriod{20};
/// How long those who wait for the rack may still get their answers when the server ends.
constexpr std::chrono::milliseconds kFarewell{500};
/// How long to wait after the system had no descriptor for a connection.
constexpr std::chrono::milliseconds kAcceptPause{100};
constexpr int kBacklog = 128;

/// The whole answer to a connection that is one too many.
std::string refusal_of_connection() {
  const Response response = problem(503, "too many connections are at work; try again later");
  return fmt::format(
      "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nConnection: close\r\nContent-Length: {}\r\n\r\n{}",
      response.status, reason(response.status), response.content_type, response.body.size(),
      response.body);
}

}  // namespace

class Server::Implementation {
 public:
  Implementation(const ServerConfiguration& configuration, rack::Rack& rack,
                 const rack::RackConfiguration& rack_configuration, const rack::EventLog& log,
                 rack::Runner& runner)
      : address_(configuration.address),
        tasks_(runner.tasks()),
        server_{configuration.limits, Guard(configuration.address.loopback(), configuration.token),
                State(rack, rack_configuration, log, runner),
                RackAccess(server_.state, runner.tasks(), configuration.limits.rack_time,
                           [this] { tick_.cancel(); }),
                TrafficHub(server_.state, server_.access)},
        acceptor_(context_),
        accept_pause_(context_),
        tick_(context_) {
    server_.state.session = configuration.session;
    server_.state.rack_file = configuration.rack_file;
    server_.state.manual = configuration.manual;
    server_.state.catalogue = configuration.catalogue;
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
      link::give_way_to_other_threads();
      accept();
      tick();
      context_.run();
    });
  }

  void stop() {
    if (thread_.joinable()) {
      asio::post(context_, [this] {
        ends_ = RackAccess::Clock::now() + kFarewell;
        tick_.cancel();
      });
      thread_.join();
    }
    // The rack may still have tasks, which live on; waiting connections must go before what they
    // use.
    server_.access.forget_all();
  }

  [[nodiscard]] const Address& address() const { return address_; }

 private:
  void listen();
  void accept();
  void take(tcp::socket socket);
  void tick();

  Address address_;
  rack::TaskQueue& tasks_;
  ServerContext server_;
  std::string too_many_ = refusal_of_connection();
  asio::io_context context_{1};  // destroys connections, which use all above
  tcp::acceptor acceptor_;
  asio::steady_timer accept_pause_;
  asio::steady_timer tick_;
  std::optional<RackAccess::Clock::time_point> ends_;  ///< set when the server is to end
  std::thread thread_;
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
  acceptor_.async_accept([this](Error error, tcp::socket socket) {
    if (!error) {
      take(std::move(socket));
      accept();
      return;
    }
    accept_pause_.expires_after(kAcceptPause);
    accept_pause_.async_wait([this](Error) { accept(); });
  });
}

void Server::Implementation::take(tcp::socket socket) {
  Error ignored;
  if (server_.state.counters.connections >= server_.limits.connections &&
      !server_.idle.end_longest()) {
    ++server_.state.counters.connections_refused;
    socket.non_blocking(true, ignored);
    socket.write_some(asio::buffer(too_many_), ignored);
    socket.shutdown(tcp::socket::shutdown_send, ignored);
    return;
  }
  socket.set_option(tcp::no_delay(true), ignored);
  serve_connection(server_, std::move(socket));
}

void Server::Implementation::tick() {
  tasks_.attend(server_.state.counters.connections > 0);
  const auto now = RackAccess::Clock::now();
  server_.access.tick(now);
  server_.traffic.tick(now);
  if (ends_ && (!server_.access.anybody_waits() || now >= *ends_)) {
    context_.stop();
    return;
  }
  tick_.expires_after(server_.access.busy() ? kBusyPeriod : kIdlePeriod);
  tick_.async_wait([this](Error) { tick(); });
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
