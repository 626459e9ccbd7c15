// Round trips of a program that asks a running TMCM-142 for a parameter and waits for each reply,
// and the same with a bare echo of nine bytes instead of the module: what pseudo-terminals or TCP
// themselves cost, in many short batches of one and the other in turn. "of_limit" is the rate of
// the best batch in parts of 50,000 per second and "of_echo" in parts of the best bare echo, so
// that what else the machine does drops out; the medians say what a program sees. On a
// pseudo-terminal they are far below where the scheduler spreads program, module and the kernel's
// own thread between them over processors.

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <arpa/inet.h>
#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include "rack/text_log.hpp"
#include "stator/devices/tmcm_142/product.hpp"
#include "stator/devices/tmcm_142/tmcm_142.hpp"
#include "stator/link/serial/serial_link.hpp"
#include "stator/link/system/file_descriptor.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/observe/event_log.hpp"
#include "stator/rack/run/runner.hpp"
#include "stator/tmcl/telegram.hpp"

namespace {

using namespace stator;
using namespace stator::base::literals;

constexpr double kLimit = 50'000.0;  // round trips per second
constexpr int kBatch = 500;
constexpr int kBatches = 40;

const tmcl::Telegram kQuestion = tmcl::encode(tmcl::Request{.command = 6, .type = 1});
const tmcl::Telegram kAnswer = tmcl::encode(tmcl::Reply{.command = 6});

/// The program's end of a line, with plain calls of the system.
class Client {
 public:
  Client(const std::string& link, const std::string& name)
      : descriptor_(link.starts_with("pty:") ? ::open(name.c_str(), O_RDWR | O_NOCTTY)
                                             : connect(name)) {
    if (!descriptor_.is_open()) {
      throw std::runtime_error("cannot open " + name);
    }
  }

  /// False: another answer than `expected` came.
  [[nodiscard]] bool ask(const tmcl::Telegram& expected) const {
    tmcl::Telegram answer{};
    if (::write(descriptor_.get(), kQuestion.data(), kQuestion.size()) !=
        static_cast<ssize_t>(kQuestion.size())) {
      return false;
    }
    for (std::size_t length = 0; length < answer.size();) {
      const ssize_t got = ::read(descriptor_.get(), answer.data() + length, answer.size() - length);
      if (got <= 0) {
        return false;
      }
      length += static_cast<std::size_t>(got);
    }
    return answer == expected;
  }

  /// Round trips per second of one batch; 0: something is wrong.
  [[nodiscard]] double batch(const tmcl::Telegram& expected) const {
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < kBatch; ++i) {
      if (!ask(expected)) {
        return 0.0;
      }
    }
    return kBatch / std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }

 private:
  static int connect(const std::string& name) {
    const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
    const int on = 1;
    ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port =
        htons(static_cast<std::uint16_t>(std::stoi(name.substr(name.find(':') + 1))));
    return ::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0
               ? socket
               : -1;
  }

  link::FileDescriptor descriptor_;
};

std::string link_text(bool pty, const char* purpose) {
  return pty ? (std::filesystem::temp_directory_path() /
                ("stator-bench-" + std::to_string(::getpid()) + purpose))
                   .string()
                   .insert(0, "pty:")
             : "tcp:0";
}

/// A thread that sends back what comes: blocking, or looking again and again.
class Echo {
 public:
  Echo(const std::string& link, link::WaitMode wait)
      : link_(std::move(*link::open_serial_link(link, {.wait = wait}))) {
    thread_ = std::thread([this] {
      std::array<std::byte, 256> buffer{};
      while (!stopping_) {
        const auto got = link_->receive(buffer, 100_ms);
        if (got && *got != 0) {
          static_cast<void>(link_->send(std::span(buffer).first(*got)));
        }
      }
    });
  }
  ~Echo() {
    stopping_ = true;
    link_->wake();
    thread_.join();
  }
  Echo(const Echo&) = delete;
  Echo& operator=(const Echo&) = delete;

  [[nodiscard]] const std::string& name() const { return link_->name(); }

 private:
  std::unique_ptr<link::SerialLink> link_;
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

/// A module as "stator run" runs it.
struct RunningModule {
  RunningModule(const std::string& link, link::WaitMode wait) {
    rack::BusConfiguration bus = rack::bus_without_wire();
    rack::DeviceConfiguration device;
    device.name = "module";
    device.setup = devices::tmcm_142_product()->defaults();
    device.serial = {{"usb", link}};
    bus.devices = {device};
    configuration.buses = {bus};
    rack::SerialLineConfiguration line;
    line.link = link;
    line.wait = wait;
    configuration.lines = {line};
    rack.emplace(configuration, log);
    runner.emplace(*rack, configuration, tests::no_log());
    runner->start();
  }
  ~RunningModule() { runner->stop(); }
  RunningModule(const RunningModule&) = delete;
  RunningModule& operator=(const RunningModule&) = delete;

  rack::RackConfiguration configuration;
  rack::EventLog log;
  std::optional<rack::Rack> rack;
  std::optional<rack::Runner> runner;
};

void Serial_RoundTrip(benchmark::State& bench, bool pty, link::WaitMode wait) {
  std::vector<double> echoes;
  std::vector<double> modules;
  const std::string echo_link = link_text(pty, "-echo");
  const std::string module_link = link_text(pty, "-module");
  for (auto _ : bench) {
    // One of the two at a time, because a thread that spins takes a processor.
    for (int batch = 0; batch < kBatches; ++batch) {
      {
        const Echo echo(echo_link, wait);
        echoes.push_back(Client(echo_link, echo.name()).batch(kQuestion));
      }
      RunningModule module(module_link, wait);
      const Client client(module_link, module.runner->line(0).link().name());
      const double rate = client.batch(kAnswer);
      if (rate == 0.0) {
        bench.SkipWithError("the module gave another answer than expected");
        return;
      }
      modules.push_back(rate);
    }
  }
  bench.SetItemsProcessed(bench.iterations() * kBatches * kBatch);
  std::ranges::sort(echoes);
  std::ranges::sort(modules);
  bench.counters["echo_best"] = echoes.back();
  bench.counters["echo_median"] = echoes[echoes.size() / 2];
  bench.counters["module_best"] = modules.back();
  bench.counters["module_median"] = modules[modules.size() / 2];
  bench.counters["of_echo"] = modules.back() / echoes.back();
  bench.counters["of_limit"] = modules.back() / kLimit;
}
BENCHMARK_CAPTURE(Serial_RoundTrip, pty_block, true, link::WaitMode::block)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(Serial_RoundTrip, pty_spin, true, link::WaitMode::spin)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(Serial_RoundTrip, tcp_block, false, link::WaitMode::block)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(Serial_RoundTrip, tcp_spin, false, link::WaitMode::spin)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

/// What the rack itself takes for a telegram: without a link, without a thread.
void Serial_InProcess(benchmark::State& bench) {
  rack::RackConfiguration configuration;
  rack::BusConfiguration bus = rack::bus_without_wire();
  for (std::int64_t i = 0; i < bench.range(0); ++i) {
    devices::Tmcm142Configuration module;
    module.tmcl.serial = static_cast<std::uint8_t>(i + 1);
    rack::DeviceConfiguration device;
    device.name = std::to_string(i);
    device.setup = {devices::tmcm_142_product(), module};
    device.serial = {{"rs485", "pty:line"}};
    bus.devices.push_back(device);
  }
  configuration.buses = {bus};
  rack::EventLog log;
  rack::Rack rack(configuration, log);
  base::SimTime now;
  for (auto _ : bench) {
    now += 20_us;
    rack.advance(now);
    rack.put(0, kQuestion, now);
  }
  if (rack.line(0).statistics().bytes_out != rack.line(0).statistics().bytes_in) {
    bench.SkipWithError("not every question was answered");
  }
  bench.SetItemsProcessed(bench.iterations());
}
BENCHMARK(Serial_InProcess)->Arg(1)->Arg(3)->Arg(10);

}  // namespace
