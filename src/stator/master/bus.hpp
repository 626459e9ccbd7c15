#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/standard/frame.hpp"
#include "stator/master/error.hpp"
#include "stator/master/frame_port.hpp"
#include "stator/master/master_options.hpp"

namespace stator::master {

/// One datagram of a frame and what became of it.
struct Datagram {
  ethercat::Command command = ethercat::Command::nop;
  std::uint32_t address = 0;          ///< ethercat::physical_address() or a logical address
  std::span<std::byte> data;          ///< what is sent; replaced by what comes back
  std::uint16_t working_counter = 0;  ///< of the answer
};

/// A slave on the bus: where it is, for people, and how it is addressed.
struct Station {
  std::uint16_t position = 0;
  std::uint16_t address = 0;

  /// "slave 0 (station 1001h)"
  [[nodiscard]] std::string name() const;
};

/// A while in which no frame came back in time.
struct Silence {
  base::SimDuration duration;
  std::uint64_t frames = 0;  ///< that were sent meanwhile
  std::uint64_t late = 0;    ///< of these and earlier ones, answers that came after all
};

/// For people: how long it lasted, whose fault it is and what to do.
[[nodiscard]] std::string to_text(const Silence& silence);

/// Frames out, answers in: numbers the datagrams, waits for the matching answer, tells late and
/// duplicated frames from it, and repeats what got lost.
class Bus {
 public:
  Bus(FramePort& port, const MasterOptions& options) : port_(port), options_(options) {}

  /// Sends all datagrams in one frame, up to `retries` times again when no answer comes; with
  /// retries also for as long as MasterOptions::patience lasts. On failure the data are as before.
  /// ErrorCode::timeout when all attempts got lost.
  Result<void> exchange(std::span<Datagram> datagrams, int retries);

  /// One datagram with the usual number of retries; its working counter.
  Result<std::uint16_t> execute(ethercat::Command command, std::uint32_t address,
                                std::span<std::byte> data);

  /// Reads registers or memory of one slave; ErrorCode::working_counter if it does not answer.
  Result<void> read(const Station& station, std::uint16_t address, std::span<std::byte> out);
  /// Writes registers or memory of one slave; ErrorCode::working_counter if it does not answer.
  Result<void> write(const Station& station, std::uint16_t address,
                     std::span<const std::byte> data);
  /// Writes to all slaves; not all of them need to have the register.
  Result<void> broadcast(std::uint16_t address, std::span<const std::byte> data);

  template <typename T>
  Result<T> read_number(const Station& station, std::uint16_t address) {
    std::array<std::byte, sizeof(T)> data{};
    if (const auto done = read(station, address, data); !done) {
      return base::Unexpected{done.error()};
    }
    return base::load_le<T>(data.data());
  }
  template <typename T>
  Result<void> write_number(const Station& station, std::uint16_t address, T value) {
    std::array<std::byte, sizeof(T)> data{};
    base::store_le<T>(data.data(), value);
    return write(station, address, data);
  }

  /// Counts on from where `other` has come.
  void go_on_from(const Bus& other) { late_answers_ = other.late_answers_; }

  [[nodiscard]] FramePort& port() { return port_; }
  [[nodiscard]] const MasterOptions& options() const { return options_; }
  /// Answers so far that came when nobody waited for them any more.
  [[nodiscard]] std::uint64_t late_answers() const { return late_answers_; }

 private:
  Result<bool> attempt(std::span<Datagram> datagrams);
  bool take_answer(std::span<std::byte> frame, std::span<Datagram> datagrams) const;
  void count_if_late(std::span<std::byte> frame);

  FramePort& port_;
  const MasterOptions& options_;
  std::uint8_t index_ = 0;       ///< of the datagrams of the last frame
  std::bitset<256> unanswered_;  ///< frames that nobody waits for any more, by that index
  std::uint64_t late_answers_ = 0;
  std::array<std::byte, ethercat::kMaximumFrameLength> frame_{};
  std::array<std::byte, ethercat::kMaximumFrameLength + 4> answer_{};
};

}  // namespace stator::master
