#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/link/serial/chip_message.hpp"
#include "stator/product/device/host_port.hpp"

namespace stator::rack {

/// Answers the requests of a program (link::chip_protocol) at the pins of a chip and tells it of
/// their changes. Without sockets, threads and clocks: those are its owner's, who brings the chip
/// to the present before each call.
class ChipSession final : public product::HostLineSink {
 public:
  /// Where answers and events go.
  struct Output {
    std::function<void(const link::ChipMessage&)> reply;
    std::function<bool(const link::ChipMessage&)> event;  ///< false: it was lost
    std::function<void(std::uint8_t tag, link::chip_protocol::Refusal, std::string_view)> refuse;
    std::function<void()> greeted;
    std::function<void(bool on)> power;  ///< switches the device's supply
  };

  /// `name` is the device's, for the program. `port` and what `output` refers to outlive the
  /// session.
  ChipSession(product::HostPort& port, std::string name, Output output);
  ~ChipSession() override { leave(); }

  /// A program has connected.
  void begin();
  /// It has left: chip select ends, nothing is watched.
  void leave();
  /// One message came at `now`.
  void take(const link::ChipMessage& message, base::SimTime now);

  void on_lines(const product::HostLineChange& change) override;

 private:
  using Body = std::span<const std::byte>;

  void greet(const link::ChipMessage& message);
  void transfer(const link::ChipMessage& message);
  void watch(const link::ChipMessage& message);
  void set_pin(const link::ChipMessage& message);
  void switch_power(const link::ChipMessage& message);
  void reply(const link::ChipMessage& request, Body content = {});
  void malformed(const link::ChipMessage& message, std::string_view form) const;

  product::HostPort& port_;
  std::string name_;
  Output output_;
  bool greeted_ = false;
  std::array<bool, product::kHostSpis> selected_{};
  std::uint16_t lost_ = 0;  ///< events since the last one that went out
  base::SimTime now_;
  std::vector<std::byte> miso_;
  std::vector<std::byte> body_;
};

}  // namespace stator::rack
