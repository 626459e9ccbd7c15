#include "stator/link/can/socketcand_session.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <span>
#include <tuple>

#include "stator/link/can/hexadecimal.hpp"

namespace stator::link {

namespace {

using namespace std::chrono_literals;

constexpr auto kAnswerAlone = 50ms;
/// Longer than any message; what grows beyond without an end is noise.
constexpr std::size_t kMaximumMessage = 256;
constexpr std::size_t kMaximumJobs = 256;
constexpr std::uint32_t kMaximumStandard = 0x7FF;
constexpr std::uint32_t kMaximumExtended = 0x1FFFFFFF;
constexpr std::size_t kStandardDigits = 3;
/// The longest interval that is accepted, in s.
constexpr std::uint64_t kMaximumSeconds = 1'000'000;

constexpr std::string_view kBlanks = " \t\r\n";

std::vector<std::string_view> split(std::string_view text) {
  std::vector<std::string_view> words;
  std::size_t at = text.find_first_not_of(kBlanks);
  while (at != std::string_view::npos) {
    const std::size_t end = std::min(text.find_first_of(kBlanks, at), text.size());
    words.push_back(text.substr(at, end - at));
    at = text.find_first_not_of(kBlanks, end);
  }
  return words;
}

std::optional<std::uint64_t> parse_decimal(std::string_view text, std::uint64_t maximum) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || number > maximum) {
    return std::nullopt;
  }
  return number;
}

/// Seconds and microseconds, two words.
std::optional<std::chrono::microseconds> parse_interval(std::string_view seconds,
                                                        std::string_view microseconds) {
  const auto whole = parse_decimal(seconds, kMaximumSeconds);
  const auto part = parse_decimal(microseconds, 999'999);
  if (!whole || !part) {
    return std::nullopt;
  }
  return std::chrono::microseconds(*whole * 1'000'000 + *part);
}

struct Identifier {
  std::uint32_t number = 0;
  bool extended = false;
};

/// More than three digits, or more than 7FFh: an extended frame. Clients pad differently.
std::optional<Identifier> parse_identifier(std::string_view word) {
  const auto number = parse_hexadecimal(word);
  if (!number || *number > kMaximumExtended) {
    return std::nullopt;
  }
  return Identifier{*number, word.size() > kStandardDigits || *number > kMaximumStandard};
}

/// "ID LEN b0 b1 …".
std::optional<can::Frame> parse_frame(std::span<const std::string_view> words) {
  if (words.size() < 2) {
    return std::nullopt;
  }
  const auto identifier = parse_identifier(words[0]);
  const auto length = parse_hexadecimal(words[1]);
  const auto data = words.subspan(2);
  if (!identifier || !length || *length > can::kMaximumData ||
      (!data.empty() && data.size() != *length)) {
    return std::nullopt;
  }
  can::Frame frame{.identifier = identifier->number,
                   .extended = identifier->extended,
                   .remote = *length > 0 && data.empty(),
                   .length = static_cast<std::uint8_t>(*length)};
  for (std::size_t i = 0; i < data.size(); ++i) {
    const auto value = parse_hexadecimal(data[i]);
    if (!value || *value > 0xFF) {
      return std::nullopt;
    }
    frame.data[i] = static_cast<std::byte>(*value);
  }
  return frame;
}

void append_time(std::string& out, base::SimTime time) {
  const std::int64_t microseconds = std::max<std::int64_t>(time.nanoseconds(), 0) / 1'000;
  std::array<char, 40> text{};
  const int length = std::snprintf(text.data(), text.size(), "%lld.%06lld",
                                   static_cast<long long>(microseconds / 1'000'000),
                                   static_cast<long long>(microseconds % 1'000'000));
  out.append(text.data(), static_cast<std::size_t>(length));
}

void append_frame(std::string& out, const can::Frame& frame, base::SimTime time, bool blanks) {
  out += "\n< frame ";
  append_hexadecimal(out, frame.identifier, frame.extended ? 8 : 3);
  out += ' ';
  append_time(out, time);
  out += ' ';
  for (std::size_t i = 0; i < frame.payload().size(); ++i) {
    if (blanks && i != 0) {
      out += ' ';
    }
    append_hexadecimal(out, std::to_integer<unsigned>(frame.data[i]), 2);
  }
  out += " >";
}

}  // namespace

CanStreamSession::Taken SocketcandSession::take(std::string_view input, MachineTime now,
                                                std::string& out) {
  Taken taken;
  const std::size_t begin = input.find('<');
  if (begin == std::string_view::npos) {
    if (input.find_first_not_of(kBlanks) != std::string_view::npos) {
      count_malformed();
    }
    taken.consumed = input.size();
    return taken;
  }
  const std::size_t end = input.find('>', begin);
  if (end == std::string_view::npos) {
    if (input.size() - begin > kMaximumMessage) {
      count_malformed();
      taken.consumed = input.size();
    }
    return taken;
  }
  taken.consumed = end + 1;
  release(out);
  const Words words = split(input.substr(begin + 1, end - begin - 1));
  const std::string error = words.empty() ? "an empty message" : execute(words, now, taken, out);
  if (!error.empty()) {
    count_malformed();
    out += "< error " + error + " >";
  }
  return taken;
}

std::string SocketcandSession::execute(const Words& words, MachineTime now, Taken& taken,
                                       std::string& out) {
  const std::string_view command = words.front();
  if (command == "echo") {
    out += "< echo >";
    return {};
  }
  if (command == "open") {
    if (mode_ != Mode::no_bus) {
      return "the bus is open already";
    }
    if (words.size() != 2) {
      return "open needs the name of a bus";
    }
    enter(Mode::broadcast_manager, now, out);
    return {};
  }
  if (mode_ == Mode::no_bus) {
    return "no bus is open; < open can0 > comes first";
  }
  if (command == "rawmode" || command == "bcmmode" || command == "controlmode") {
    enter(command == "rawmode"   ? Mode::raw
          : command == "bcmmode" ? Mode::broadcast_manager
                                 : Mode::control,
          now, out);
    return {};
  }
  if (command == "send" && mode_ != Mode::control) {
    taken.frame = parse_frame(std::span(words).subspan(1));
    if (!taken.frame) {
      return "send needs an identifier, a length from 0 to 8 and as many bytes, in hexadecimal";
    }
    ++traffic_.sent_frames;
    traffic_.sent_bytes += taken.frame->payload().size();
    return {};
  }
  if (command == "statistics" && mode_ == Mode::control) {
    return set_statistics(words, now);
  }
  if (mode_ == Mode::broadcast_manager) {
    return execute_broadcast_manager(words, now);
  }
  return "unknown command in this mode";
}

std::string SocketcandSession::execute_broadcast_manager(const Words& words, MachineTime now) {
  const std::string_view command = words.front();
  if (command == "add") {
    return add(words, now);
  }
  if (command == "update") {
    return update(words);
  }
  if (command == "delete") {
    return remove(words);
  }
  if (command == "subscribe") {
    return subscribe(words);
  }
  if (command == "unsubscribe") {
    return unsubscribe(words);
  }
  return "unknown command in this mode; filter, muxfilter and isotpmode are not served, rawmode "
         "has every frame";
}

void SocketcandSession::enter(Mode mode, MachineTime now, std::string& out) {
  mode_ = mode;
  jobs_.clear();
  subscriptions_.clear();
  statistics_interval_.reset();
  out += "< ok >";
  if (mode == Mode::raw) {
    held_until_ = now + kAnswerAlone;
  }
}

std::string SocketcandSession::add(const Words& words, MachineTime now) {
  const auto interval = words.size() < 5 ? std::nullopt : parse_interval(words[1], words[2]);
  const auto frame =
      interval ? parse_frame(std::span(words).subspan(3)) : std::optional<can::Frame>();
  if (!frame || *interval <= Interval{}) {
    return "add needs seconds, microseconds, identifier, length and bytes";
  }
  if (jobs_.size() == kMaximumJobs) {
    return "too many frames are sent cyclically";
  }
  jobs_.push_back({.frame = *frame, .interval = *interval, .next = now});
  return {};
}

std::string SocketcandSession::update(const Words& words) {
  const auto frame = parse_frame(std::span(words).subspan(1));
  if (!frame) {
    return "update needs identifier, length and bytes";
  }
  for (Job& job : jobs_) {
    if (job.frame.identifier == frame->identifier && job.frame.extended == frame->extended) {
      job.frame = *frame;
      return {};
    }
  }
  return "update needs a frame that add has set up";
}

std::string SocketcandSession::remove(const Words& words) {
  const auto identifier = words.size() == 2 ? parse_identifier(words[1]) : std::nullopt;
  if (!identifier || std::erase_if(jobs_, [&](const Job& job) {
                       return job.frame.identifier == identifier->number &&
                              job.frame.extended == identifier->extended;
                     }) == 0) {
    return "delete needs the identifier of a frame that add has set up";
  }
  return {};
}

std::string SocketcandSession::subscribe(const Words& words) {
  const auto interval = words.size() == 4 ? parse_interval(words[1], words[2]) : std::nullopt;
  const auto identifier = interval ? parse_identifier(words[3]) : std::nullopt;
  if (!identifier) {
    return "subscribe needs seconds, microseconds and identifier";
  }
  std::ignore = unsubscribe({words[0], words[3]});
  if (subscriptions_.size() == kMaximumJobs) {
    return "too many subscriptions";
  }
  subscriptions_.push_back({.identifier = identifier->number,
                            .extended = identifier->extended,
                            .interval = *interval,
                            .last = {}});
  return {};
}

std::string SocketcandSession::unsubscribe(const Words& words) {
  const auto identifier = words.size() == 2 ? parse_identifier(words[1]) : std::nullopt;
  if (!identifier || std::erase_if(subscriptions_, [&](const Subscription& each) {
                       return each.identifier == identifier->number &&
                              each.extended == identifier->extended;
                     }) == 0) {
    return "unsubscribe needs the identifier of a subscription";
  }
  return {};
}

std::string SocketcandSession::set_statistics(const Words& words, MachineTime now) {
  const auto milliseconds =
      words.size() == 2 ? parse_decimal(words[1], kMaximumSeconds * 1'000) : std::nullopt;
  if (!milliseconds) {
    return "statistics needs an interval in milliseconds, 0 for none";
  }
  statistics_interval_.reset();
  if (*milliseconds != 0) {
    statistics_interval_ = std::chrono::milliseconds(*milliseconds);
    next_statistics_ = now + *statistics_interval_;
  }
  return {};
}

bool SocketcandSession::put(const can::Frame& frame, base::SimTime time, std::string& out) {
  if (frame.remote) {
    return false;
  }
  ++traffic_.received_frames;
  traffic_.received_bytes += frame.payload().size();
  if (mode_ == Mode::broadcast_manager) {
    return put_subscribed(frame, time, out);
  }
  if (mode_ != Mode::raw) {
    return false;
  }
  append_frame(held_until_ ? held_ : out, frame, time, false);
  return true;
}

bool SocketcandSession::put_subscribed(const can::Frame& frame, base::SimTime time,
                                       std::string& out) {
  for (Subscription& each : subscriptions_) {
    if (each.identifier != frame.identifier || each.extended != frame.extended) {
      continue;
    }
    if (each.last &&
        (time - *each.last).nanoseconds() < std::chrono::nanoseconds(each.interval).count()) {
      return false;
    }
    each.last = time;
    append_frame(out, frame, time, true);
    return true;
  }
  return false;
}

bool SocketcandSession::put_error(const ErrorFrame& error, base::SimTime time, std::string& out) {
  if (mode_ != Mode::raw) {
    return false;
  }
  std::string& to = held_until_ ? held_ : out;
  to += "\n< error ";
  append_hexadecimal(to, error.classes, 3);
  to += ' ';
  append_time(to, time);
  to += " >";
  return true;
}

void SocketcandSession::release(std::string& out) {
  held_until_.reset();
  out += held_;
  held_.clear();
}

std::optional<MachineTime> SocketcandSession::deadline() const {
  std::optional<MachineTime> earliest = held_until_;
  const auto consider = [&](MachineTime time) {
    earliest = earliest ? std::min(*earliest, time) : time;
  };
  if (statistics_interval_) {
    consider(next_statistics_);
  }
  for (const Job& job : jobs_) {
    consider(job.next);
  }
  return earliest;
}

std::optional<can::Frame> SocketcandSession::advance(MachineTime now, std::string& out) {
  if (held_until_ && *held_until_ <= now) {
    release(out);
  }
  if (statistics_interval_ && next_statistics_ <= now) {
    next_statistics_ = now + *statistics_interval_;
    out += "< stat " + std::to_string(traffic_.received_bytes) + " " +
           std::to_string(traffic_.received_frames) + " " + std::to_string(traffic_.sent_bytes) +
           " " + std::to_string(traffic_.sent_frames) + " >";
  }
  for (Job& job : jobs_) {
    if (job.next <= now) {
      // After a pause of the machine the rhythm goes on; what was missed is not made up for.
      job.next += job.interval;
      if (job.next <= now) {
        job.next = now + job.interval;
      }
      ++traffic_.sent_frames;
      traffic_.sent_bytes += job.frame.payload().size();
      return job.frame;
    }
  }
  return std::nullopt;
}

}  // namespace stator::link
