// Commands to a TMCL module over a serial port or pseudo-terminal: nine bytes out, nine bytes back.
#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <deque>
#include <string_view>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include "stator/link/system/file_descriptor.hpp"
#include "stator/link/system/host_and_port.hpp"
#include "stator/tmcl/command.hpp"
#include "stator/tmcl_tools/failure.hpp"
#include "stator/tmcl_tools/tmcl_connection.hpp"

namespace stator::tmcl_tools {

namespace {

using Clock = std::chrono::steady_clock;

std::string reason() {
  return std::generic_category().message(errno);
}

struct BaudRate {
  unsigned bits_per_second;
  speed_t setting;
};
constexpr std::array<BaudRate, 10> kBaudRates{{{9600, B9600},
                                               {19200, B19200},
                                               {38400, B38400},
                                               {57600, B57600},
                                               {115200, B115200},
                                               {230400, B230400},
                                               {460800, B460800},
                                               {500000, B500000},
                                               {921600, B921600},
                                               {1000000, B1000000}}};

link::FileDescriptor open_terminal(const std::string& path, unsigned baud_rate) {
  link::FileDescriptor file(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!file.is_open()) {
    throw Failure(fmt::format("cannot open {}: {}; is the module running, and is the name right?",
                              path, reason()));
  }
  termios settings{};
  if (::tcgetattr(file.get(), &settings) != 0) {
    throw Failure(fmt::format("{} is no serial line: {}", path, reason()));
  }
  const auto rate = std::ranges::find(kBaudRates, baud_rate, &BaudRate::bits_per_second);
  if (rate == kBaudRates.end()) {
    throw Failure(fmt::format("--baud {} is no rate of a serial interface here", baud_rate));
  }
  ::cfmakeraw(&settings);
  ::cfsetispeed(&settings, rate->setting);
  ::cfsetospeed(&settings, rate->setting);
  if (::tcsetattr(file.get(), TCSANOW, &settings) != 0) {
    throw Failure(fmt::format("cannot set up {}: {}", path, reason()));
  }
  return file;
}

link::FileDescriptor open_tcp(const std::string& address) {
  const auto parts = link::split_host_and_port(address);
  if (!parts || !parts->port) {
    throw Failure(fmt::format("\"tcp:{}\" names no port; write tcp:HOST:PORT", address));
  }
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int error = ::getaddrinfo(std::string(parts->host).c_str(),
                                  std::string(*parts->port).c_str(), &hints, &found);
  if (error != 0) {
    throw Failure(fmt::format("cannot find {}: {}", address, ::gai_strerror(error)));
  }
  link::FileDescriptor socket;
  for (const addrinfo* each = found; each != nullptr && !socket.is_open(); each = each->ai_next) {
    link::FileDescriptor attempt(
        ::socket(each->ai_family, each->ai_socktype | SOCK_CLOEXEC, each->ai_protocol));
    if (attempt.is_open() && ::connect(attempt.get(), each->ai_addr, each->ai_addrlen) == 0) {
      socket = std::move(attempt);
    }
  }
  ::freeaddrinfo(found);
  if (!socket.is_open()) {
    throw Failure(
        fmt::format("cannot connect to {}: {}; does somebody listen there?", address, reason()));
  }
  return socket;
}

class SerialConnection final : public TmclConnection {
 public:
  SerialConnection(std::string name, link::FileDescriptor file, const TmclHostOptions& options)
      : name_(std::move(name)), file_(std::move(file)), options_(options) {}

  base::Expected<TmclReply, Error> execute(const tmcl::Instruction& instruction) override {
    const tmcl::Telegram telegram = tmcl::encode(tmcl::Request{.address = options_.module_address,
                                                               .command = instruction.command,
                                                               .type = instruction.type,
                                                               .motor = instruction.motor,
                                                               .value = instruction.value});
    take_events();
    received_.clear();
    if (::write(file_.get(), telegram.data(), telegram.size()) !=
        static_cast<ssize_t>(telegram.size())) {
      return base::Unexpected{fmt::format("cannot send to {}: {}", name_, reason())};
    }
    if (!has_reply(instruction)) {
      return TmclReply{};
    }
    const Clock::time_point end =
        Clock::now() + std::chrono::nanoseconds(options_.timeout.nanoseconds());
    while (const auto reply = next_telegram(end)) {
      if (is_event(*reply)) {
        ++events_;
        continue;
      }
      const bool version_text =
          static_cast<tmcl::Command>(instruction.command) == tmcl::Command::get_firmware_version &&
          instruction.type == 0;
      if (!version_text && !tmcl::has_right_checksum(*reply)) {
        return base::Unexpected{std::string("the reply has a wrong checksum")};
      }
      return reply_in(std::span(*reply).subspan(1), instruction);
    }
    return base::Unexpected{fmt::format(
        "no reply came in {:g} s; is the module running, is its address {}, and is the rate right?",
        options_.timeout.seconds(), options_.module_address)};
  }

  bool pass(base::SimDuration duration) override {
    const Clock::time_point end = Clock::now() + std::chrono::nanoseconds(duration.nanoseconds());
    while (const auto telegram = next_telegram(end)) {
      events_ += is_event(*telegram) ? 1 : 0;
    }
    return std::exchange(events_, 0) != 0;
  }
  base::Expected<void, Error> set_input(const std::string& /*assignment*/) override {
    return base::Unexpected{
        std::string("what is around a module is out of reach over its line; a rack file's "
                    "[[event]] sets it")};
  }
  [[nodiscard]] std::string name() const override { return name_; }

 private:
  static bool is_event(const tmcl::Telegram& telegram) {
    return tmcl::has_right_checksum(telegram) &&
           tmcl::decode_reply(telegram).status == tmcl::Status::target_reached;
  }

  void take_events() {
    while (const auto telegram = next_telegram(Clock::now())) {
      events_ += is_event(*telegram) ? 1 : 0;
    }
  }

  /// Nothing: none was complete in time.
  std::optional<tmcl::Telegram> next_telegram(Clock::time_point end) {
    while (received_.size() < tmcl::kTelegramLength) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now());
      pollfd waiting{.fd = file_.get(), .events = POLLIN, .revents = 0};
      if (::poll(&waiting, 1, std::max(0, static_cast<int>(left.count()))) <= 0) {
        return std::nullopt;
      }
      std::array<std::byte, 256> buffer{};
      const ssize_t length = ::read(file_.get(), buffer.data(), buffer.size());
      if (length <= 0) {
        // The other end is closed; nothing will come.
        return std::nullopt;
      }
      received_.insert(received_.end(), buffer.begin(), buffer.begin() + length);
    }
    tmcl::Telegram telegram;
    std::copy_n(received_.begin(), telegram.size(), telegram.begin());
    received_.erase(received_.begin(), received_.begin() + tmcl::kTelegramLength);
    return telegram;
  }

  std::string name_;
  link::FileDescriptor file_;
  TmclHostOptions options_;
  std::deque<std::byte> received_;
  unsigned events_ = 0;
};

}  // namespace

std::unique_ptr<TmclConnection> connect_tmcl_serial(const std::string& port,
                                                    const TmclHostOptions& options) {
  constexpr std::string_view kTcp = "tcp:";
  constexpr std::string_view kPty = "pty:";
  if (port.starts_with(kTcp)) {
    return std::make_unique<SerialConnection>(port, open_tcp(port.substr(kTcp.size())), options);
  }
  const std::string path = port.starts_with(kPty) ? port.substr(kPty.size()) : port;
  if (!path.starts_with('/')) {
    throw Failure(fmt::format(
        "--port \"{}\" is no serial line; write pty:PATH, /dev/NAME or tcp:HOST:PORT", port));
  }
  return std::make_unique<SerialConnection>(port, open_terminal(path, options.baud_rate), options);
}

}  // namespace stator::tmcl_tools
