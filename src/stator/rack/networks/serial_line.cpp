#include "stator/rack/networks/serial_line.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "stator/product/device/device.hpp"
#include "stator/rack/networks/can_network.hpp"
#include "stator/rack/observe/journal.hpp"

namespace stator::rack {

using base::SimDuration;
using base::SimTime;

/// The end of the line at one device.
class SerialLine::Member final : public tmcl::SerialPort {
 public:
  Member(SerialLine& line, std::size_t number, product::Device& device, std::string interface,
         CanNetwork* network, std::size_t position)
      : line_(line),
        number_(number),
        device_(device),
        interface_(std::move(interface)),
        network_(network),
        position_(position) {}
  ~Member() override { static_cast<void>(device_.connect_serial(interface_, nullptr)); }

  [[nodiscard]] bool connect() { return device_.connect_serial(interface_, this); }

  // The device's side.
  [[nodiscard]] std::size_t take(std::span<std::byte> buffer) override {
    return queue_.empty() ? 0 : queue_.pop(buffer);
  }
  void send(std::span<const std::byte> bytes, SimTime now) override {
    line_.send(*this, bytes, now);
  }

  // The line's side.
  /// Returns how many of the bytes it heard.
  std::size_t hear(std::span<const std::byte> bytes) {
    return powered_ ? queue_.push(bytes) : bytes.size();
  }
  void serve(SimTime now) {
    device_.handle_serial(now);
    if (network_ != nullptr) {
      network_->touched(position_);
    }
  }
  void set_power(bool on) {
    powered_ = on;
    queue_.clear();
  }
  [[nodiscard]] bool waits() const { return !queue_.empty(); }
  [[nodiscard]] const product::Device& device() const { return device_; }
  [[nodiscard]] std::optional<std::uint32_t> baud_rate() const {
    return device_.baud_rate(interface_);
  }
  [[nodiscard]] SimTime deadline() const {
    return network_ != nullptr ? network_->deadline_of(position_) : SimTime::never();
  }
  [[nodiscard]] SimTime next_reply() const { return device_.next_serial_reply(); }
  /// Its place among those of the line.
  [[nodiscard]] std::size_t number() const { return number_; }

 private:
  SerialLine& line_;
  std::size_t number_;
  product::Device& device_;
  std::string interface_;
  CanNetwork* network_;
  std::size_t position_;
  bool powered_ = true;
  Queue queue_;
};

SerialLine::SerialLine(SerialLineConfiguration configuration)
    : configuration_(std::move(configuration)) {}

SerialLine::~SerialLine() = default;

bool SerialLine::add(product::Device& device, const std::string& interface, CanNetwork* network,
                     std::size_t position) {
  auto member =
      std::make_unique<Member>(*this, members_.size(), device, interface, network, position);
  if (!member->connect()) {
    return false;
  }
  members_.push_back(std::move(member));
  return true;
}

std::size_t SerialLine::room() const {
  return speed() ? incoming_.room() : kQueuedBytes;
}

void SerialLine::put(std::span<const std::byte> bytes, SimTime now) {
  now_ = std::max(now_, now);
  statistics_.bytes_in += bytes.size();
  if (faults_ == nullptr) {
    put_unspoilt(bytes, now_);
    return;
  }
  const std::vector<std::byte> left =
      faults_->spoil(bytes, SerialDirection::to_devices, now_, longest_gap());
  next_delayed_ = faults_->next_delayed();
  put_unspoilt(left, now_);
}

void SerialLine::put_unspoilt(std::span<const std::byte> bytes, SimTime now) {
  if (!configuration_.pacing || !speed()) {
    // Byte by byte, so that devices answer in the order in which they were asked.
    const std::size_t piece = members_.size() > 1 ? 1 : bytes.size();
    for (; !bytes.empty(); bytes = bytes.subspan(piece)) {
      deliver(bytes.first(piece), now);
    }
    return;
  }
  statistics_.bytes_lost += bytes.size() - incoming_.push(bytes);
  if (next_arrival_ == SimTime::never() && !incoming_.empty()) {
    next_arrival_ = now + byte_time();
  }
}

std::uint64_t SerialLine::inject(const SerialFault& fault) {
  if (faults_ == nullptr) {
    faults_ = std::make_unique<SerialFaults>();
  }
  return faults_->add(fault);
}

void SerialLine::withdraw(std::uint64_t fault) {
  faults_->withdraw(fault);
}

std::optional<std::uint64_t> SerialLine::hits(std::uint64_t fault) const {
  return faults_->hits(fault);
}

void SerialLine::hand_over_delayed(SimTime now) {
  while (faults_->next_delayed() <= now) {
    const SerialFaults::Delayed delayed = faults_->take_delayed();
    if (delayed.direction == SerialDirection::to_devices) {
      put_unspoilt(delayed.bytes, now);
    } else {
      hand_out_unspoilt(delayed.bytes);
    }
  }
  next_delayed_ = faults_->next_delayed();
}

void SerialLine::advance(SimTime now) {
  while (next_deadline() <= now) {
    now_ = std::max(now_, next_deadline());
    while (next_sent() <= now_) {
      const Sent first = std::move(sent_.front());
      sent_.pop_front();
      pass_on(*members_[first.member], first.bytes);
    }
    if (next_departure_ <= now_) {
      depart(now_);
    }
    if (next_arrival_ <= now_) {
      arrive(now_);
    }
    if (next_delayed_ <= now_) {
      hand_over_delayed(now_);
    }
  }
  now_ = std::max(now_, now);
}

void SerialLine::arrive(SimTime now) {
  std::array<std::byte, 1> byte{};
  static_cast<void>(incoming_.pop(byte));
  deliver(byte, now);
  next_arrival_ = incoming_.empty() ? SimTime::never() : now + byte_time();
}

void SerialLine::depart(SimTime now) {
  std::array<std::byte, 1> byte{};
  static_cast<void>(outgoing_.pop(byte));
  hand_out(byte);
  next_departure_ = outgoing_.empty() ? SimTime::never() : now + byte_time();
}

void SerialLine::deliver(std::span<const std::byte> bytes, SimTime now) {
  const auto line_speed = configuration_.pacing ? speed() : std::nullopt;
  for (const auto& member : members_) {
    const auto rate = line_speed ? member->baud_rate() : std::nullopt;
    const std::size_t heard = !rate || rate == line_speed ? member->hear(bytes) : 0;
    statistics_.bytes_lost += bytes.size() - heard;
  }
  const bool before = std::exchange(serving_, true);
  for (const auto& member : members_) {
    member->serve(now);
  }
  serving_ = before;
}

// Bytes are sorted by time, since a device that is brought through time at once may be ahead of
// other devices that send on the line as well.
void SerialLine::send(const Member& member, std::span<const std::byte> bytes, SimTime now) {
  if (serving_ && sent_.empty()) {
    pass_on(member, bytes);
    return;
  }
  const auto later = std::ranges::find_if(sent_, [&](const Sent& other) {
    return std::pair(other.time, other.member) > std::pair(now, member.number());
  });
  sent_.insert(later, {now, member.number(), {bytes.begin(), bytes.end()}});
}

void SerialLine::pass_on(const Member& member, std::span<const std::byte> bytes) {
  const auto line_speed = configuration_.pacing ? speed() : std::nullopt;
  if (!line_speed) {
    hand_out(bytes);
    return;
  }
  const auto rate = member.baud_rate();
  if (rate && rate != line_speed) {
    statistics_.bytes_lost += bytes.size();
    return;
  }
  statistics_.bytes_lost += bytes.size() - outgoing_.push(bytes);
  if (next_departure_ == SimTime::never() && !outgoing_.empty()) {
    next_departure_ = now_ + byte_time();
  }
}

void SerialLine::hand_out(std::span<const std::byte> bytes) {
  if (faults_ == nullptr) {
    hand_out_unspoilt(bytes);
    return;
  }
  const std::vector<std::byte> left =
      faults_->spoil(bytes, SerialDirection::to_programs, now_, longest_gap());
  next_delayed_ = faults_->next_delayed();
  hand_out_unspoilt(left);
}

void SerialLine::hand_out_unspoilt(std::span<const std::byte> bytes) {
  statistics_.bytes_out += bytes.size();
  if (journal_ != nullptr) {
    journal_->bytes_leave(number_, bytes);
  }
  if (output_) {
    output_(bytes);
  }
}

SimTime SerialLine::next_device_deadline() const {
  SimTime next = SimTime::never();
  for (const auto& member : members_) {
    next = std::min(next, member->deadline());
  }
  return next;
}

SimTime SerialLine::next_reply() const {
  SimTime next = next_deadline();
  for (const auto& member : members_) {
    next = std::min(next, member->next_reply());
  }
  return next;
}

bool SerialLine::waits() const {
  return std::ranges::any_of(members_, [](const auto& member) { return member->waits(); });
}

void SerialLine::set_power(const product::Device& device, bool on) {
  for (const auto& member : members_) {
    if (&member->device() == &device) {
      member->set_power(on);
    }
  }
}

std::optional<std::uint32_t> SerialLine::speed() const {
  if (!configuration_.pacing) {
    return std::nullopt;
  }
  for (const auto& member : members_) {
    if (const auto rate = member->baud_rate()) {
      return rate;
    }
  }
  return std::nullopt;
}

/// Between two bytes of one telegram.
SimDuration SerialLine::longest_gap() const {
  return configuration_.pacing && speed() ? byte_time() * 2 : SimDuration();
}

// To the nearest nanosecond; called only while the line has a speed, or had one when bytes came.
SimDuration SerialLine::byte_time() const {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const auto rate = std::int64_t{speed().value_or(static_cast<std::uint32_t>(kSecond))};
  return SimDuration((kBitsPerByte * kSecond + rate / 2) / rate);
}

}  // namespace stator::rack
