#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ethercat/hex.hpp"
#include "stator/base/byte_order.hpp"
#include "stator/base/event.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/ethercat/stack/slave_stack.hpp"

// A slave stack on a fake controller, with a small dictionary and the master's view of both: what
// the tests of the host side are written with.
namespace stator::ethercat::test {

/// A controller reduced to memory: mailboxes with the full flag, a plain buffer per process-data
/// channel, the events that the stack handles. Counts what a host must not do.
class FakeController final : public ProcessDataInterface {
 public:
  FakeController() : memory_(0x10000) {}

  void read(std::uint16_t address, std::span<std::byte> out) override;
  void write(std::uint16_t address, std::span<const std::byte> data) override;
  [[nodiscard]] std::uint32_t al_event_request() const override { return events_; }

  // The master's side.
  void request_state(unsigned al_control);
  [[nodiscard]] unsigned al_status() const { return word(0x0130); }
  [[nodiscard]] unsigned al_status_code() const { return word(0x0134); }
  void set_sync_manager(unsigned channel, std::uint16_t start, std::uint16_t length,
                        std::uint8_t control, bool enable);
  /// False if the mailbox is still full, as a working counter of 0 would tell.
  bool write_mailbox(std::span<const std::byte> message);
  [[nodiscard]] bool mailbox_full(unsigned channel) const {
    return (std::to_integer<unsigned>(memory_[0x0805 + channel * 8]) & 8) != 0;
  }
  /// The message in SM1 trimmed to its length, or empty if there is none.
  Bytes read_mailbox();
  void toggle_repeat_request();
  [[nodiscard]] bool repeat_acknowledged() const {
    return ((memory_[0x080E] ^ memory_[0x080F]) & std::byte{2}) == std::byte{0};
  }
  void write_outputs(std::span<const std::byte> data);
  [[nodiscard]] Bytes read_inputs() const;
  void expire_watchdog();

  [[nodiscard]] std::uint16_t word(std::uint16_t address) const {
    return base::load_le<std::uint16_t>(memory_, address);
  }
  void set_word(std::uint16_t address, std::uint16_t value) {
    base::store_le(memory_, address, value);
  }
  [[nodiscard]] unsigned violations() const { return violations_; }

 private:
  [[nodiscard]] std::uint16_t start_of(unsigned channel) const {
    return word(static_cast<std::uint16_t>(0x0800 + channel * 8));
  }
  [[nodiscard]] std::uint16_t length_of(unsigned channel) const {
    return word(static_cast<std::uint16_t>(0x0802 + channel * 8));
  }
  void set_full(unsigned channel, bool full);
  void raise(std::uint32_t event, unsigned channel);

  Bytes memory_;
  std::uint32_t events_ = 0;
  unsigned violations_ = 0;
};

/// Keeps what was reported.
class EventLog final : public base::EventSink {
 public:
  void on_event(const base::Event& event) override { events.push_back(event); }
  [[nodiscard]] std::vector<std::string> sentences() const;
  /// The sentence of the last event with that rule; empty if there was none.
  [[nodiscard]] std::string last(std::string_view rule_id) const;

  std::vector<base::Event> events;
};

/// Writes down what the stack tells.
class RecordingApplication final : public SlaveApplication {
 public:
  AlStatusCode permit_state(AlState, AlState to, base::SimTime) override {
    return to == refused_state ? AlStatusCode::dc_invalid_sync_cycle_time : AlStatusCode::no_error;
  }
  void on_state(AlState from, AlState to, base::SimTime) override {
    steps.push_back(std::string(to_text(from)) + "->" + std::string(to_text(to)));
  }
  void on_outputs(base::SimTime) override { ++outputs; }
  void before_inputs(base::SimTime) override { ++inputs; }
  void on_output_refused(const dictionary::Entry& entry, const dictionary::Refusal&,
                         base::SimTime) override {
    refused.push_back(entry.index());
  }

  std::optional<AlState> refused_state;
  std::vector<std::string> steps;
  int outputs = 0;
  int inputs = 0;
  std::vector<std::uint16_t> refused;
};

/// Mailboxes of 128 bytes, outputs at 1100h, inputs at 1400h, everything supported.
DeviceDescription test_description();
/// Fills `dictionary` with the objects that the tests use.
void fill_test_dictionary(dictionary::Dictionary& dictionary);

/// The stack in Init, and a master's moves.
class StackFixture : public ::testing::Test {
 protected:
  static constexpr std::uint16_t kReceiveStart = 0x1000;
  static constexpr std::uint16_t kTransmitStart = 0x1080;

  StackFixture() : StackFixture(test_description()) {}
  explicit StackFixture(const DeviceDescription& device, const SlaveStackOptions& options = {});
  ~StackFixture() override { EXPECT_EQ(controller.violations(), 0U); }

  void process() { stack.process(now); }
  /// Requests a state and lets the slave answer.
  void request(unsigned al_control) {
    controller.request_state(al_control);
    process();
  }
  void configure_mailbox();
  void configure_process_data(std::uint16_t outputs = 30, std::uint16_t inputs = 30);
  void go_pre_operational();
  void go_safe_operational();
  void go_operational();

  /// A complete mailbox message.
  Bytes message(unsigned type, const Bytes& payload, unsigned counter = 0);
  /// Sends `sdo` as an SDO request and returns the SDO part of the reply; empty if none came.
  Bytes sdo(const Bytes& request);
  Bytes sdo(std::string_view request) { return sdo(hex(request)); }
  /// Sends an SDO information request (opcode first) and collects all fragments' bodies.
  Bytes information(std::uint8_t opcode, const Bytes& body);
  /// Sends any message, returns the reply with its mailbox header.
  Bytes exchange(const Bytes& request);
  /// Abort code of an SDO reply; 0 if it is none.
  static std::uint32_t abort_code(const Bytes& reply);
  std::uint64_t value(std::uint16_t index, std::uint8_t subindex = 0) const {
    return dictionary.find(index, subindex)->value();
  }

  base::SimTime now;
  EventLog log;
  DeviceDescription description;
  dictionary::Dictionary dictionary;
  FakeController controller;
  RecordingApplication application;
  SlaveStack stack;
  unsigned counter_ = 0;
  std::vector<unsigned> fragments_left;  ///< of the last information()
};

}  // namespace stator::ethercat::test
