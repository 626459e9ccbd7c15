#include "stator/tmcl/sessions/line_editor.hpp"

#include "stator/tmcl/module/global_parameter.hpp"
#include "stator/tmcl/sessions/ascii_command.hpp"

namespace stator::tmcl {

namespace {

constexpr char kBackspace = '\b';
constexpr char kDelete = '\x7F';
constexpr std::uint8_t kLetters = 26;

}  // namespace

EchoMode echo_mode_of(std::int32_t ascii_mode) {
  const std::uint32_t mode =
      static_cast<std::uint32_t>(ascii_mode) >> kEchoModeShift & kEchoModeMask;
  return mode == 0 ? EchoMode::characters : mode == 1 ? EchoMode::line : EchoMode::none;
}

char letter_of(std::uint8_t address) {
  return address >= 1 && address <= kLetters ? static_cast<char>('A' + address - 1) : '?';
}

void LineEditor::clear() {
  stored_ = 0;
  length_ = 0;
  addressed_ = false;
  complete_ = false;
}

// Characters beyond the capacity are counted, so that erasing them leads back to those that were
// kept.
bool LineEditor::erase() {
  if (length_ == 0) {
    return false;
  }
  --length_;
  if (stored_ > length_) {
    stored_ = length_;
  }
  const bool was_addressed = addressed_;
  addressed_ = addressed_ && length_ != 0;
  return was_addressed;
}

LineEditor::Event LineEditor::take(char character, std::uint8_t address, EchoMode echo) {
  if (complete_) {
    clear();
  }
  bool shown = false;
  if (character == '\n') {
    return {};
  }
  if (character == '\r') {
    complete_ = true;
    const bool addressed = addressed_;
    if (!addressed) {
      clear();
    }
    shown = addressed;
  } else if (character == kBackspace || character == kDelete) {
    shown = erase();
  } else {
    if (length_ == 0) {
      const char letter = letter_of(address);
      addressed_ = letter != '?' && upper_case(character) == letter;
    }
    if (addressed_ && stored_ < kCapacity) {
      characters_[stored_++] = character;
    }
    ++length_;
    shown = addressed_;
  }
  Event event;
  event.complete = complete_;
  if (shown && echo == EchoMode::characters) {
    event.echo = character;
  }
  return event;
}

}  // namespace stator::tmcl
