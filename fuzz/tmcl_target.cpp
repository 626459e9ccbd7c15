// The core of a TMCL module: any bytes on two serial lines, any CAN frames, in any mode, with
// programs that were put together by chance, while time passes and the module changes. Every whole
// telegram and every line for the module is answered once; commands 137, 205 and 242 alone are not,
// and 138 twice when the target is reached. Whatever came, switching on brings back a module that
// answers.

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "input.hpp"
#include "stator/tmcl/command.hpp"
#include "stator/tmcl/interpreter/firmware.hpp"
#include "stator/tmcl/sessions/can_session.hpp"
#include "stator/tmcl/sessions/serial_session.hpp"
#include "stator/tmcl/telegram.hpp"
#include "tmcl/fake_module.hpp"
#include "tmcl/serial_line.hpp"

namespace {

using namespace stator;
using namespace stator::base::literals;
using namespace stator::tmcl;
using stator::fuzz::Input;
using stator::fuzz::require;

constexpr std::int32_t kFactorySettings = 1234;
/// Longer than any telegram pause and than the gap that ends a telegram.
constexpr base::SimDuration kLongPause = 256_ms;

bool is_without_reply(const Instruction& instruction) {
  switch (static_cast<Command>(instruction.command)) {
    case Command::restore_factory_settings:
      return instruction.value == kFactorySettings;
    case Command::boot:
    case Command::boot_start_application:
      return true;
    default:
      return false;
  }
}

class Rig {
 public:
  Rig() {
    module_.remember = false;
    for (std::size_t i = 0; i < sessions_.size(); ++i) {
      sessions_[i].connect(&lines_[i]);
    }
    power_on();
  }

  void power_on() {
    module_.power_on();
    firmware_.power_on(now_);
    for (SerialSession& session : sessions_) {
      session.power_on();
    }
    can_.power_on();
  }
  void wait(base::SimDuration duration) {
    now_ += duration;
    firmware_.advance(now_);
    require(firmware_.state().program_counter < firmware_.memory().size());
    require(firmware_.next_deadline() > now_);
    serve();
  }
  void serve() {
    for (SerialSession& session : sessions_) {
      session.serve(now_);
    }
    static_cast<void>(can_.take_event());
  }
  void write(std::size_t line, std::span<const std::byte> bytes) { lines_[line].write(bytes); }
  void change(Input& in);
  void check_telegram(std::size_t line, const Instruction& instruction, bool right_checksum);
  void check_line(std::size_t line);
  void check_frame(const Instruction& instruction, std::size_t length);
  void erase_settings() {
    module_.restore_factory_settings();
    power_on();
  }

 private:
  std::int32_t configured(GlobalParameter parameter) const {
    return firmware_.configuration(parameter);
  }
  /// Everything that was under way has come to its end.
  void settle() {
    for (int i = 0; i < 3; ++i) {
      wait(kLongPause);
    }
    module_.reached = true;
    serve();
    for (tests::SerialLine& line : lines_) {
      static_cast<void>(line.read());
    }
  }

  tests::FakeModule module_;
  base::SimTime now_;
  Firmware firmware_{tests::FakeModule::description(), module_};
  std::array<tests::SerialLine, 2> lines_;
  std::array<SerialSession, 2> sessions_{SerialSession(firmware_), SerialSession(firmware_)};
  CanSession can_{firmware_};
};

void Rig::change(Input& in) {
  const unsigned bits = in.byte();
  module_.reached = (bits & 1U) != 0;
  module_.reference_switch = (bits & 2U) != 0;
  module_.limit_switch = (bits & 4U) != 0;
  module_.search = (bits & 8U) != 0 ? 1 : 0;
  if ((bits & 16U) != 0) {
    firmware_.raise(static_cast<ErrorFlag>(1 + bits % kErrorFlagCount));
  }
  module_.inputs = in.byte();
  module_.position = static_cast<std::int32_t>(in.double_word());
}

void Rig::check_telegram(std::size_t line, const Instruction& instruction, bool right_checksum) {
  settle();
  if (sessions_[line].in_ascii_mode()) {
    check_line(line);
    return;
  }
  Telegram telegram = encode(
      Request{.address = static_cast<std::uint8_t>(configured(GlobalParameter::serial_address)),
              .command = instruction.command,
              .type = instruction.type,
              .motor = instruction.motor,
              .value = instruction.value});
  if (!right_checksum) {
    telegram.back() ^= std::byte{1};
  }
  const bool stored = firmware_.state().download;
  lines_[line].write(telegram);
  sessions_[line].serve(now_);
  now_ += kLongPause;  // the program does not run on: it could change what is expected
  sessions_[line].serve(now_);
  const std::size_t length = lines_[line].read().size();
  if (right_checksum && is_without_reply(instruction)) {
    require(length == 0);
    return;
  }
  const bool event =
      right_checksum && !stored && (instruction.value & 1) != 0 &&
      static_cast<Command>(instruction.command) == Command::request_target_reached_event;
  require(length == kTelegramLength * (event ? 2 : 1));
}

/// Where a telegram would not be understood, a line of text is.
void Rig::check_line(std::size_t line) {
  lines_[line].write("\r");
  settle();
  const auto address = static_cast<std::uint8_t>(configured(GlobalParameter::serial_address));
  if (!sessions_[line].in_ascii_mode() || letter_of(address) == '?') {
    return;
  }
  const bool echo = echo_mode_of(configured(GlobalParameter::ascii_mode)) != EchoMode::none;
  lines_[line].write(letter_of(address) + std::string(" GAP 1, 0\r"));
  sessions_[line].serve(now_);
  now_ += kLongPause;
  sessions_[line].serve(now_);
  require(std::ranges::count(lines_[line].read_text(), '\r') == (echo ? 2 : 1));
}

void Rig::check_frame(const Instruction& instruction, std::size_t length) {
  const Telegram telegram = encode(Request{.command = instruction.command,
                                           .type = instruction.type,
                                           .motor = instruction.motor,
                                           .value = instruction.value});
  const auto identifier = static_cast<std::uint32_t>(configured(GlobalParameter::can_identifier));
  const auto reply = can_.take(identifier, std::span(telegram).subspan(1, length), now_);
  if (length != 7 && length != 8) {
    require(!reply.has_value());
  } else {
    require(reply.has_value() != is_without_reply(instruction));
    require(!reply || (reply->length == length && reply->identifier <= 0x7FF));
  }
}

Instruction instruction_in(Input& in) {
  Instruction instruction;
  instruction.command = in.byte();
  instruction.type = in.byte();
  instruction.motor = in.byte();
  // Small values are the ones that mean something; the rest of the range comes too.
  const std::uint8_t size = in.byte();
  instruction.value = size < 160   ? static_cast<std::int8_t>(in.byte())
                      : size < 230 ? static_cast<std::int16_t>(in.word())
                                   : static_cast<std::int32_t>(in.double_word());
  return instruction;
}

void act(Rig& rig, Input& in) {
  const std::size_t line = in.below(2);
  switch (in.below(7)) {
    case 0: {
      std::vector<std::byte> bytes(in.below(64));
      in.fill(bytes);
      rig.write(line, bytes);
      rig.serve();
      break;
    }
    case 1:
      rig.check_telegram(line, instruction_in(in), true);
      break;
    case 2: {
      // In this order: compilers evaluate arguments in theirs, and an input has one meaning.
      const Instruction instruction = instruction_in(in);
      rig.check_telegram(line, instruction, in.below(2) == 0);
      break;
    }
    case 3: {
      const Instruction instruction = instruction_in(in);
      rig.check_frame(instruction, in.below(9));
      break;
    }
    case 4:
      rig.wait(base::SimDuration(1'000) * (in.word() + 1));
      break;
    case 5:
      rig.change(in);
      break;
    default:
      rig.power_on();
      break;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input in({data, size});
  Rig rig;
  while (!in.empty()) {
    act(rig, in);
  }
  rig.erase_settings();
  rig.check_telegram(0, {.command = static_cast<std::uint8_t>(Command::get_axis_parameter)}, true);
  rig.check_telegram(1, {.command = static_cast<std::uint8_t>(Command::get_axis_parameter)}, true);
  return 0;
}
