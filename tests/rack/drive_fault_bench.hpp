#pragma once

#include <algorithm>
#include <cstdint>
#include <ostream>
#include <string>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include "rack/fault_bench.hpp"
#include "stator/base/byte_order.hpp"
#include "stator/can/frame.hpp"
#include "stator/tmcl/command.hpp"
#include "stator/tmcl/telegram.hpp"

namespace stator::tests {

/// An emergency: its code and the first byte the manufacturer adds.
struct Told {
  unsigned code = 0;
  unsigned detail = 0;

  friend bool operator==(const Told&, const Told&) = default;
};

inline void PrintTo(const Told& told, std::ostream* out) {
  *out << std::hex << told.code << "h/" << told.detail;
}

/// Statusword of a drive that is in Operation enabled (CiA 402-2 table 29).
constexpr bool is_enabled(unsigned statusword) {
  return (statusword & 0x006FU) == 0x0027U;
}

/// An EtherCAT drive alone on a segment, named "drive", moved by SDOs.
class CoeDriveBench : public SegmentFaultBench {
 public:
  static constexpr const char* kDevice = "drive";

  explicit CoeDriveBench(const std::string& file) : SegmentFaultBench(file) {}

  /// Operational without process data watchdog.
  void start() {
    constexpr std::uint16_t kProcessDataWatchdog = 0x0420;
    bring_to_operational(1);
    ASSERT_TRUE(send(ethercat::Command::apwr, 0, kProcessDataWatchdog));
  }
  void pass(base::SimDuration duration) { port.wait(duration); }
  template <typename T>
  void write(std::uint16_t index, T value, std::uint8_t subindex = 0) {
    const auto done = master.download_number<T>(0, {index, subindex}, value);
    EXPECT_TRUE(done) << done.error().text;
  }
  template <typename T>
  T read(std::uint16_t index, std::uint8_t subindex = 0) {
    const auto value = master.upload_number<T>(0, {index, subindex});
    EXPECT_TRUE(value) << value.error().text;
    return value ? *value : T{};
  }
  /// Emergencies since the last call.
  std::vector<Told> told() {
    std::vector<Told> all;
    const auto emergencies = master.take_emergencies(0);
    EXPECT_TRUE(emergencies);
    for (const master::Emergency& emergency : *emergencies) {
      all.push_back({emergency.error_code, std::to_integer<unsigned>(emergency.data.at(0))});
    }
    return all;
  }
  unsigned statusword() { return read<std::uint16_t>(0x6041); }
  void control(unsigned controlword) {
    write<std::uint16_t>(0x6040, static_cast<std::uint16_t>(controlword));
  }
};

/// A CANopen drive alone on a bus, node 1 and named "drive", moved by SDOs.
class CanopenDriveBench : public WithFaults<BusBench> {
 public:
  static constexpr const char* kDevice = "drive";

  explicit CanopenDriveBench(const std::string& file) : WithFaults(file) {}

  /// After boot-up, in Operational.
  void start() {
    pass(base::SimDuration(600'000'000));
    port.send(can::data_frame(0x000, {1, 1}));
  }
  void pass(base::SimDuration duration) {
    port.wait(duration);
    collect();
  }
  /// One SDO request and its answer's eight bytes; empty: none came within 50 ms.
  std::vector<std::byte> sdo(const can::Frame& request) {
    answers_.clear();
    port.send(request);
    collect();
    for (int n = 0; n < 50 && answers_.empty(); ++n) {
      pass(base::SimDuration(1'000'000));
    }
    const can::Frame answer = answers_.empty() ? can::Frame{} : answers_.front();
    return {answer.payload().begin(), answer.payload().end()};
  }
  template <typename T>
  void write(std::uint16_t index, T value, std::uint8_t subindex = 0) {
    can::Frame request = header(0x23U | (4U - sizeof(T)) << 2U, index, subindex);
    base::store_le<T>(std::span(request.data), 4, value);
    const auto answer = sdo(request);
    ASSERT_EQ(answer.size(), 8U) << std::hex << index;
    EXPECT_EQ(answer[0], std::byte{0x60})
        << std::hex << index << " " << base::load_le<std::uint32_t>(answer, 4);
  }
  template <typename T>
  T read(std::uint16_t index, std::uint8_t subindex = 0) {
    const auto answer = sdo(header(0x40, index, subindex));
    EXPECT_EQ(answer.size(), 8U) << std::hex << index;
    if (answer.size() != 8 || answer[0] == std::byte{0x80}) {
      ADD_FAILURE() << std::hex << index << " cannot be read";
      return T{};
    }
    return base::load_le<T>(answer, 4);
  }
  std::vector<Told> told() {
    collect();
    return std::exchange(told_, {});
  }
  unsigned statusword() { return read<std::uint16_t>(0x6041); }
  void control(unsigned controlword) {
    write<std::uint16_t>(0x6040, static_cast<std::uint16_t>(controlword));
  }

 private:
  static can::Frame header(unsigned command, unsigned index, unsigned subindex) {
    return can::data_frame(0x601, {command, index & 0xFFU, index >> 8U, subindex, 0, 0, 0, 0});
  }
  void collect() {
    for (const can::Frame& frame : received_frames()) {
      if (frame.identifier == 0x581) {
        answers_.push_back(frame);
      } else if (frame.identifier == 0x081) {
        const unsigned code = base::load_le<std::uint16_t>(frame.payload(), 0);
        if (code != 0) {  // 0000h: an error has gone
          told_.push_back({code, std::to_integer<unsigned>(frame.data[3])});
        }
      }
    }
  }

  std::vector<can::Frame> answers_;
  std::vector<Told> told_;
};

/// A TMCL module alone on a serial line, with address 1 and named "drive".
class TmclModuleBench : public WithFaults<LineBench> {
 public:
  static constexpr const char* kDevice = "drive";

  explicit TmclModuleBench(const std::string& file) : WithFaults(file) {}

  void pass(base::SimDuration duration) { wait(duration); }
  tmcl::Reply execute(tmcl::Command command, int type, std::int64_t value = 0, int motor = 0) {
    const tmcl::Telegram request =
        tmcl::encode(tmcl::Request{.command = static_cast<std::uint8_t>(command),
                                   .type = static_cast<std::uint8_t>(type),
                                   .motor = static_cast<std::uint8_t>(motor),
                                   .value = static_cast<std::int32_t>(value)});
    const Bytes answer = ask(request, base::SimDuration(30'000'000));
    tmcl::Telegram telegram{};
    EXPECT_EQ(answer.size(), telegram.size());
    std::copy_n(answer.begin(), std::min(answer.size(), telegram.size()), telegram.begin());
    EXPECT_TRUE(tmcl::has_right_checksum(telegram));
    return tmcl::decode_reply(telegram);
  }
  void set_parameter(int parameter, std::int64_t value) {
    EXPECT_EQ(execute(tmcl::Command::set_axis_parameter, parameter, value).status,
              tmcl::Status::success)
        << parameter;
  }
  std::int32_t parameter(int parameter) {
    const tmcl::Reply reply = execute(tmcl::Command::get_axis_parameter, parameter);
    EXPECT_EQ(reply.status, tmcl::Status::success) << parameter;
    return reply.value;
  }
};

}  // namespace stator::tests
