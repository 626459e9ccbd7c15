#include "stator/link/can/slcan_session.hpp"

#include <array>

#include "stator/link/can/hexadecimal.hpp"

namespace stator::link {

namespace {

constexpr char kDone = '\r';
constexpr char kRefused = '\a';
/// Longer than any command; a line that grows beyond is noise.
constexpr std::size_t kMaximumLine = 64;
/// S0 to S8, and S9 as python-can has it.
constexpr std::array<unsigned, 10> kBitRates{10'000,  20'000,  50'000,  100'000,   125'000,
                                             250'000, 500'000, 800'000, 1'000'000, 83'300};
constexpr std::int64_t kNanosecondsPerMillisecond = 1'000'000;
constexpr std::int64_t kTimeStampPeriod = 60'000;

// Status flags as F reads them (LAWICEL CANUSB, SJA1000's registers behind it).
constexpr std::uint8_t kDataOverrun = 0x08;
constexpr std::uint8_t kBusErrorFlag = 0x80;

constexpr unsigned kStandardDigits = 3;
constexpr unsigned kExtendedDigits = 8;
constexpr std::uint32_t kMaximumStandard = 0x7FF;
constexpr std::uint32_t kMaximumExtended = 0x1FFFFFFF;

/// The frame of a line beginning with t, T, r or R.
std::optional<can::Frame> parse_frame(std::string_view line) {
  can::Frame frame;
  frame.extended = line[0] == 'T' || line[0] == 'R';
  frame.remote = line[0] == 'r' || line[0] == 'R';
  const std::size_t digits = frame.extended ? kExtendedDigits : kStandardDigits;
  if (line.size() < 1 + digits + 1) {
    return std::nullopt;
  }
  const auto identifier = parse_hexadecimal(line.substr(1, digits));
  const auto length = parse_hexadecimal(line.substr(1 + digits, 1));
  if (!identifier || *identifier > (frame.extended ? kMaximumExtended : kMaximumStandard) ||
      !length || *length > can::kMaximumData) {
    return std::nullopt;
  }
  frame.identifier = *identifier;
  frame.length = static_cast<std::uint8_t>(*length);
  const std::string_view data = line.substr(1 + digits + 1);
  if (data.size() != 2 * frame.payload().size()) {
    return std::nullopt;
  }
  for (std::size_t i = 0; i < frame.payload().size(); ++i) {
    const auto value = parse_hexadecimal(data.substr(2 * i, 2));
    if (!value) {
      return std::nullopt;
    }
    frame.data[i] = static_cast<std::byte>(*value);
  }
  return frame;
}

/// One of the two filters: `bits` must equal `code` where `mask` has a 0.
bool passes(std::uint32_t bits, std::uint32_t code, std::uint32_t mask) {
  return ((bits ^ code) & ~mask) == 0;
}

}  // namespace

CanStreamSession::Taken SlcanSession::take(std::string_view input, MachineTime /*now*/,
                                           std::string& out) {
  Taken taken;
  const std::size_t end = input.find('\r');
  if (end == std::string_view::npos) {
    if (input.size() > kMaximumLine) {
      taken.consumed = input.size();
      count_malformed();
      out += kRefused;
    }
    return taken;
  }
  taken.consumed = end + 1;
  std::string_view line = input.substr(0, end);
  while (!line.empty() && line.front() == '\n') {
    line.remove_prefix(1);
  }
  if (line.empty()) {
    return taken;
  }
  if (line.size() > kMaximumLine || !execute(line, taken, out)) {
    count_malformed();
    out += kRefused;
  }
  return taken;
}

bool SlcanSession::execute(std::string_view line, Taken& taken, std::string& out) {
  switch (line[0]) {
    case 't':
    case 'T':
    case 'r':
    case 'R':
      return transmit(line, taken, out);
    case 'F':
      return line.size() == 1 && answer_flags(out);
    case 'O':
    case 'L':
      if (line.size() != 1 || !open(line[0] == 'O' ? Channel::open : Channel::listen_only, taken)) {
        return false;
      }
      break;
    case 'C':
      if (line.size() != 1) {
        return false;
      }
      channel_ = Channel::closed;
      taken.restart = true;
      break;
    default:
      return execute_setting(line, out);
  }
  out += kDone;
  return true;
}

bool SlcanSession::execute_setting(std::string_view line, std::string& out) {
  switch (line[0]) {
    case 'V':
    case 'N':
      if (line.size() != 1) {
        return false;
      }
      out += line[0] == 'V' ? "V1013" : "NSTAT";
      break;
    case 'S':
    case 's':
      if (!set_bit_rate(line)) {
        return false;
      }
      break;
    case 'M':
    case 'm':
      if (!set_acceptance(line)) {
        return false;
      }
      break;
    case 'Z':
      if (line != "Z0" && line != "Z1") {
        return false;
      }
      time_stamps_ = line == "Z1";
      break;
    case 'X':
      if (line != "X1") {
        return false;
      }
      break;
    case 'U':  // the line's speed, which a pseudo-terminal does not have
      if (line.size() != 2 || line[1] < '0' || line[1] > '6') {
        return false;
      }
      break;
    default:
      return false;
  }
  out += kDone;
  return true;
}

bool SlcanSession::open(Channel channel, Taken& taken) {
  taken.restart = channel_ == Channel::closed;
  channel_ = channel;
  return true;
}

bool SlcanSession::set_bit_rate(std::string_view line) {
  if (channel_ != Channel::closed) {
    return false;
  }
  if (line[0] == 's') {  // registers of a chip whose clock says what they mean: taken, not compared
    return (line.size() == 5 || line.size() == 7) && parse_hexadecimal(line.substr(1)).has_value();
  }
  if (line.size() != 2 || line[1] < '0' || line[1] > '9') {
    return false;
  }
  if (on_bit_rate_) {
    on_bit_rate_(kBitRates[static_cast<std::size_t>(line[1] - '0')]);
  }
  return true;
}

bool SlcanSession::set_acceptance(std::string_view line) {
  const auto value = parse_hexadecimal(line.substr(1));
  if (channel_ != Channel::closed || line.size() != 9 || !value) {
    return false;
  }
  (line[0] == 'M' ? acceptance_.code : acceptance_.mask) = *value;
  return true;
}

bool SlcanSession::answer_flags(std::string& out) {
  if (channel_ == Channel::closed) {
    return false;
  }
  out += 'F';
  append_hexadecimal(out, flags_, 2);
  out += kDone;
  flags_ = 0;
  return true;
}

bool SlcanSession::transmit(std::string_view line, Taken& taken, std::string& out) const {
  if (channel_ != Channel::open) {
    return false;
  }
  taken.frame = parse_frame(line);
  if (!taken.frame) {
    return false;
  }
  if (acknowledge_) {
    out += taken.frame->extended ? 'Z' : 'z';
    out += kDone;
  }
  return true;
}

bool SlcanSession::accepts(const can::Frame& frame) const {
  const std::uint32_t code = acceptance_.code;
  const std::uint32_t mask = acceptance_.mask;
  if (mask == 0xFFFFFFFF) {
    return true;
  }
  if (frame.extended) {  // the upper 16 bits of the identifier, in both filters
    const std::uint32_t upper = frame.identifier >> 13;
    return passes(upper, code >> 16, mask >> 16 | 0xFFFF0000) ||
           passes(upper, code & 0xFFFF, mask | 0xFFFF0000);
  }
  const std::uint32_t header = frame.identifier << 5 | (frame.remote ? 0x10U : 0U);
  const std::uint32_t first =
      frame.payload().empty() ? 0 : std::to_integer<unsigned>(frame.data[0]);
  // Filter 1 also looks at the first data byte: its halves stand in the second and fourth register.
  const std::uint32_t bits = header << 16 | (first >> 4) << 16 | (first & 0xF);
  const std::uint32_t absent = frame.payload().empty() ? 0x000F000FU : 0U;
  return passes(bits, code, mask | 0xFFF0 | absent) ||
         passes(header, code & 0xFFF0, mask | 0xFFFF000F);
}

bool SlcanSession::put(const can::Frame& frame, base::SimTime time, std::string& out) {
  if (channel_ == Channel::closed || !accepts(frame)) {
    return false;
  }
  out += frame.extended ? (frame.remote ? 'R' : 'T') : (frame.remote ? 'r' : 't');
  append_hexadecimal(out, frame.identifier, frame.extended ? kExtendedDigits : kStandardDigits);
  append_hexadecimal(out, frame.length, 1);
  for (const std::byte each : frame.payload()) {
    append_hexadecimal(out, std::to_integer<unsigned>(each), 2);
  }
  if (time_stamps_) {
    const std::int64_t milliseconds =
        time.nanoseconds() / kNanosecondsPerMillisecond % kTimeStampPeriod;
    append_hexadecimal(out, static_cast<std::uint32_t>(milliseconds), 4);
  }
  out += kDone;
  return true;
}

// The protocol has no error frames; a program asks for the flag with "F".
bool SlcanSession::put_error(const ErrorFrame& error, base::SimTime /*time*/,
                             std::string& /*out*/) {
  if ((error.classes & kBusError) != 0) {
    flags_ |= kBusErrorFlag;
  }
  return false;
}

void SlcanSession::note_lost_frame() {
  flags_ |= kDataOverrun;
}

void SlcanSession::restart() {
  channel_ = Channel::closed;
  time_stamps_ = false;
  flags_ = 0;
  acceptance_ = {};
}

}  // namespace stator::link
