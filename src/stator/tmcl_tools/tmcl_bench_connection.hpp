#pragma once

#include <chrono>
#include <string>

#include "stator/tmcl_tools/tmcl_bench.hpp"
#include "stator/tmcl_tools/tmcl_connection.hpp"

namespace stator::tmcl_tools {

/// How the time of a module in this process goes.
enum class BenchClock : std::uint8_t {
  machine,    ///< with the machine's clock
  simulated,  ///< by pass(), and kCommandTime for each command
};

/// A module in this process, without interface.
class TmclBenchConnection final : public TmclConnection {
 public:
  /// What a command takes over a line of 9600 bit/s: nine bytes there and nine back.
  static constexpr base::SimDuration kCommandTime{18'750'000};

  /// `bench` must outlive the connection.
  TmclBenchConnection(TmclBench& bench, std::string name, BenchClock clock)
      : bench_(bench), name_(std::move(name)), clock_(clock) {}

  base::Expected<TmclReply, Error> execute(const tmcl::Instruction& instruction) override;
  bool pass(base::SimDuration duration) override;
  base::Expected<void, Error> set_input(const std::string& assignment) override;
  [[nodiscard]] std::string name() const override { return name_; }

 private:
  void catch_up();
  [[nodiscard]] bool take_event();

  TmclBench& bench_;
  std::string name_;
  BenchClock clock_;
  std::uint8_t event_mask_ = 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace stator::tmcl_tools
