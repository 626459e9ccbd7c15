#include "stator/board/lines/vcd.hpp"

namespace stator::board {

namespace {

/// Identifier codes are printable characters; one suffices for 26 channels.
char code_of(std::uint8_t channel) {
  return static_cast<char>('!' + channel);
}

void append_hexadecimal(std::string& text, std::uint64_t value, unsigned bits) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  for (unsigned digit = (bits + 3) / 4; digit-- > 0;) {
    text += kDigits[(value >> (4 * digit)) & 0xFU];
  }
}

void append_value(std::string& text, const TraceRecord& record) {
  using Kind = TraceRecord::Kind;
  switch (record.kind) {
    case Kind::low:
      text += '0';
      break;
    case Kind::high:
      text += '1';
      break;
    case Kind::unknown:
      text += 'x';
      break;
    case Kind::spi:
      text += 's';
      append_hexadecimal(text, record.value, record.bits);
      text += '>';
      append_hexadecimal(text, record.answer, record.bits);
      text += ' ';
      break;
    case Kind::i2c_start:
      text += "sstart ";
      break;
    case Kind::i2c_stop:
      text += "sstop ";
      break;
    case Kind::i2c_byte:
      text += 's';
      append_hexadecimal(text, record.value & 0xFFU, 8);
      text += (record.value & 0x100U) != 0 ? "+ack " : "+nack ";
      break;
  }
  text += code_of(record.channel);
  text += '\n';
}

}  // namespace

std::string line_name(Line line) {
  if (line >= 16) {
    return "MFC_HV" + std::to_string(line - 16);
  }
  return (line < 10 ? "MFCIO0" : "MFCIO") + std::to_string(line);
}

VcdFormat::VcdFormat(std::string_view scope, const LogicTrace& trace,
                     const std::array<std::string, kLines>& names) {
  header_ = "$timescale 1 ns $end\n$scope module " + std::string(scope) + " $end\n";
  for (Line line = 0; line < kLines; ++line) {
    if (trace.traces(line)) {
      header_ += "$var wire 1 " + std::string(1, code_of(line)) + " " + names[line] + " $end\n";
    }
  }
  const auto string_variable = [this](std::uint8_t channel, const char* name) {
    header_ += "$var string 1 " + std::string(1, code_of(channel)) + " " + name + " $end\n";
  };
  if (trace.decoded().spi_sck < kLines) {
    string_variable(kSpiChannel, "spi");
  }
  if (trace.decoded().i2c_scl < kLines) {
    string_variable(kI2cChannel, "i2c");
  }
  header_ += "$upscope $end\n$enddefinitions $end\n";
}

void VcdFormat::append_time(std::string& text, base::SimTime time) {
  if (!time_ || *time_ != time) {
    text += '#';
    text += std::to_string(time.nanoseconds());
    text += '\n';
    time_ = time;
  }
}

void VcdFormat::finish(std::string& text, base::SimTime time) {
  if (!time_ || *time_ < time) {
    append_time(text, time);
  }
}

void VcdFormat::append(std::string& text, std::span<const TraceRecord> records) {
  for (const TraceRecord& record : records) {
    append_time(text, record.time);
    append_value(text, record);
  }
}

}  // namespace stator::board
