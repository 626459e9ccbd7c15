#pragma once

#include <functional>
#include <optional>

#include "stator/link/can/can_stream_session.hpp"

namespace stator::link {

/// The adapter's end of the ASCII protocol that LAWICEL's CANUSB introduced and slcand, python-can
/// and many adapters speak: one command per line that ends in CR, answers CR (done) or BEL (not).
///
/// Commands: S s O L C t T r R F V N Z M m X U. Where clients differ, this end is the lenient one:
/// digits of either case, line feeds ignored, C and O in any state. Frames are not acknowledged
/// unless `acknowledge`: a client waits a millisecond for each answer it does not need. CAN FD
/// frames (d D b B) and polling (X0, P, A) are refused.
class SlcanSession final : public CanStreamSession {
 public:
  /// Is told the bit rate a client sets, in bit/s.
  using BitRateHook = std::function<void(unsigned)>;

  explicit SlcanSession(bool acknowledge, BitRateHook on_bit_rate = {})
      : acknowledge_(acknowledge), on_bit_rate_(std::move(on_bit_rate)) {}

  Taken take(std::string_view input, MachineTime now, std::string& out) override;
  bool put(const can::Frame& frame, base::SimTime time, std::string& out) override;
  /// Has no form here; it shows in the status flags that F reads.
  bool put_error(const ErrorFrame& error, base::SimTime time, std::string& out) override;
  void restart() override;
  void note_lost_frame() override;

 private:
  enum class Channel : std::uint8_t { closed, open, listen_only };
  /// Acceptance code and mask of the SJA1000 with two filters (its data sheet, §6.4.15.2).
  struct Acceptance {
    std::uint32_t code = 0;
    std::uint32_t mask = 0xFFFFFFFF;  ///< 1: any
  };

  bool execute(std::string_view line, Taken& taken, std::string& out);
  bool execute_setting(std::string_view line, std::string& out);
  bool open(Channel channel, Taken& taken);
  bool set_bit_rate(std::string_view line);
  bool set_acceptance(std::string_view line);
  bool answer_flags(std::string& out);
  bool transmit(std::string_view line, Taken& taken, std::string& out) const;
  [[nodiscard]] bool accepts(const can::Frame& frame) const;

  bool acknowledge_;
  BitRateHook on_bit_rate_;
  Channel channel_ = Channel::closed;
  bool time_stamps_ = false;
  std::uint8_t flags_ = 0;
  Acceptance acceptance_;
};

}  // namespace stator::link
