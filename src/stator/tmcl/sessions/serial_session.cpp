#include "stator/tmcl/sessions/serial_session.hpp"

#include <algorithm>
#include <charconv>

#include "stator/tmcl/sessions/ascii_command.hpp"
#include "stator/tmcl/sessions/reply.hpp"

namespace stator::tmcl {

namespace {

using base::EventRule;
using base::Severity;

/// The unit of global parameter 75 (A9).
constexpr base::SimDuration kPauseUnit{1'000'000};

constexpr EventRule kWrongChecksum{
    "tmcl-checksum", Severity::refusal,
    "TMCL: telegram refused with status 1: its last byte is {0:x2}, the sum of the others is "
    "{1:x2}; after a pause of {2} ms the next byte begins a new telegram"};
constexpr EventRule kLost{
    "tmcl-telegram-lost", Severity::warning,
    "TMCL: telegram lost: two before it are not answered yet, since the telegram pause (global "
    "parameter 75) or a write to the EEPROM holds replies back; wait for each reply"};
constexpr EventRule kLineRefused{
    "tmcl-line", Severity::refusal,
    "TMCL: line of text refused with status {0}: 2 is a word that is no command, 4 an operand that "
    "is missing, too much or no number; write for example GAP 1, 0"};

/// Text of a limited length; what is too much is dropped.
template <std::size_t kCapacity>
class Text {
 public:
  void add(char character) {
    if (length_ < kCapacity) {
      characters_[length_++] = character;
    }
  }
  void add(std::string_view text) {
    for (const char character : text) {
      add(character);
    }
  }
  void add(std::int32_t number) {
    std::array<char, 12> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
    add(std::string_view(digits.data(), static_cast<std::size_t>(end - digits.data())));
  }
  [[nodiscard]] std::span<const std::byte> bytes() const {
    return std::as_bytes(std::span(characters_).first(length_));
  }

 private:
  std::array<char, kCapacity> characters_{};
  std::size_t length_ = 0;
};

Instruction instruction_of(const Request& request) {
  return {.command = request.command,
          .type = request.type,
          .motor = request.motor,
          .value = request.value};
}

}  // namespace

SerialSession::SerialSession(Firmware& firmware, const SerialSessionSettings& settings,
                             base::EventReporter reporter)
    : firmware_(firmware), settings_(settings), reporter_(reporter), receiver_(settings.gap) {}

void SerialSession::power_on() {
  receiver_.reset();
  editor_.clear();
  const auto mode =
      static_cast<std::uint32_t>(firmware_.configuration(GlobalParameter::ascii_mode));
  ascii_ = (mode & kStartInAsciiMode) != 0;
  line_waits_ = false;
  waiting_.reset();
  asked_.reset();
  reply_length_ = 0;
  event_mask_ = 0;
}

SerialSession::Addresses SerialSession::addresses() const {
  return {.module = static_cast<std::uint8_t>(
              firmware_.configuration(GlobalParameter::serial_address) + settings_.address_offset),
          .host = static_cast<std::uint8_t>(
              firmware_.configuration(GlobalParameter::serial_host_address))};
}

void SerialSession::serve(base::SimTime now) {
  if (port_ == nullptr) {
    return;
  }
  flush(now);
  std::array<std::byte, 64> buffer{};
  while (const std::size_t length = port_->take(buffer)) {
    for (const std::byte byte : std::span(buffer).first(length)) {
      take(byte, now);
    }
  }
  send_event(now);
}

void SerialSession::take(std::byte byte, base::SimTime now) {
  if (!ascii_) {
    if (const auto telegram = receiver_.take(byte, now)) {
      take_telegram(*telegram, now);
    }
    return;
  }
  if (line_waits_) {
    return;
  }
  const LineEditor::Event event =
      editor_.take(static_cast<char>(byte), addresses().module,
                   echo_mode_of(firmware_.configuration(GlobalParameter::ascii_mode)));
  if (event.echo) {
    port_->send(std::array{static_cast<std::byte>(*event.echo)}, now);
  }
  if (event.complete && !answers()) {
    line_waits_ = true;
  } else if (event.complete) {
    answer_line(now);
  }
}

void SerialSession::take_telegram(const Telegram& telegram, base::SimTime now) {
  if (decode_request(telegram).address != addresses().module) {
    return;  // A5
  }
  if (answers()) {
    answer(telegram, now);
  } else if (!waiting_) {
    waiting_ = telegram;
  } else {
    reporter_.report(now, kLost);
  }
}

// The reply goes out under the addresses the command came with, also of a command that changes them
// (A59).
void SerialSession::answer(const Telegram& telegram, base::SimTime now) {
  const Request request = decode_request(telegram);
  const Addresses addresses{.module = request.address, .host = this->addresses().host};
  if (!has_right_checksum(telegram)) {
    reporter_.report(now, kWrongChecksum,
                     {std::to_integer<int>(telegram.back()), int{checksum(telegram)},
                      settings_.gap.nanoseconds() / 1'000'000});
    send_telegram({.status = Status::wrong_checksum}, request, addresses, now);  // A4
    return;
  }
  const HostAnswer answer = firmware_.execute(instruction_of(request), Origin::serial, now);
  if (answer.waits) {
    asked_ = {request, {}, addresses};
    return;
  }
  answer_telegram(answer, request, addresses, now);
}

void SerialSession::answer_telegram(const HostAnswer& answer, const Request& request,
                                    const Addresses& addresses, base::SimTime now) {
  if (answer.form != ReplyForm::none) {
    send_telegram(answer, request, addresses, now);
  }
  if (answer.enter_ascii) {
    ascii_ = true;
    event_mask_ = 0;
    editor_.clear();
  }
  if (answer.event_mask != 0) {
    event_mask_ = answer.event_mask;
    event_ = {.host_address = addresses.host,
              .module_address = addresses.module,
              .status = Status::target_reached,
              .command = request.command,
              .value = answer.value};
  }
}

void SerialSession::answer_line(base::SimTime now) {
  const Addresses addresses = this->addresses();
  const std::string_view line = editor_.line();
  const AsciiCommand command =
      parse_ascii_command(line.substr(1), firmware_.description().commands);
  if (editor_.too_long()) {
    reporter_.report(now, kLineRefused, {static_cast<int>(Status::invalid_value)});
    send_line(Status::invalid_value, 0, line, addresses, now);
    return;
  }
  HostAnswer answer;
  switch (command.kind) {
    case LineKind::command:
      answer = firmware_.execute(command.instruction, Origin::ascii, now);
      if (answer.waits) {
        asked_ = {std::nullopt, editor_, addresses};
        return;
      }
      break;
    case LineKind::binary_mode:
      ascii_ = false;
      receiver_.reset();
      break;
    case LineKind::run:
      firmware_.start_program(now);
      break;
    case LineKind::stop:
      firmware_.stop_program();
      break;
    case LineKind::nothing:
      return;
    case LineKind::refused:
      answer.status = command.status;
      reporter_.report(now, kLineRefused, {static_cast<int>(command.status)});
      break;
  }
  send_line(answer.status, answer.value, line, addresses, now);
}

void SerialSession::send_telegram(const HostAnswer& answer, const Request& request,
                                  const Addresses& addresses, base::SimTime now) {
  send(encode_reply(answer, request, addresses.host, firmware_.description().version_text), now);
}

void SerialSession::send_line(Status status, std::int32_t value, std::string_view line,
                              const Addresses& addresses, base::SimTime now) {
  Text<kReplyCapacity> text;
  if (echo_mode_of(firmware_.configuration(GlobalParameter::ascii_mode)) == EchoMode::line) {
    text.add(line);
    text.add('\r');
  }
  text.add(letter_of(addresses.host));
  text.add(letter_of(addresses.module));
  text.add(' ');
  text.add(static_cast<std::int32_t>(status));
  text.add(' ');
  text.add(value);
  text.add('\r');
  send(text.bytes(), now);
}

void SerialSession::send(std::span<const std::byte> bytes, base::SimTime now) {
  const std::int32_t pause =
      settings_.telegram_pause ? firmware_.configuration(GlobalParameter::telegram_pause) : 0;
  if (pause <= 0) {
    port_->send(bytes, now);
    return;
  }
  std::ranges::copy(bytes, reply_.begin());
  reply_length_ = bytes.size();
  reply_due_ = now + kPauseUnit * pause;
}

void SerialSession::flush(base::SimTime now) {
  finish(now);
  while (true) {
    if (holds_reply() && reply_due_ <= now) {
      port_->send(std::span(reply_).first(reply_length_), now);
      reply_length_ = 0;
    }
    if ((!waiting_ && !line_waits_) || !answers()) {
      return;
    }
    if (waiting_) {
      const Telegram telegram = *waiting_;
      waiting_.reset();
      answer(telegram, now);
    } else {
      line_waits_ = false;
      answer_line(now);
    }
  }
}

void SerialSession::finish(base::SimTime now) {
  if (!asked_) {
    return;
  }
  const std::optional<HostAnswer> answer = firmware_.take_answer(now);
  if (!answer) {
    return;
  }
  const Asked asked = *asked_;
  asked_.reset();
  if (port_ == nullptr) {
    return;
  }
  if (asked.request) {
    answer_telegram(*answer, *asked.request, asked.addresses, now);
  } else {
    send_line(answer->status, answer->value, asked.editor.line(), asked.addresses, now);
  }
}

void SerialSession::send_event(base::SimTime now) {
  if (event_mask_ != 0 && !holds_reply() && firmware_.targets_reached(event_mask_)) {
    event_mask_ = 0;
    port_->send(encode(event_), now);
  }
}

}  // namespace stator::tmcl
