#include "stator/rack/networks/serial_faults.hpp"

#include <algorithm>
#include <utility>

namespace stator::rack {

namespace {

constexpr std::uint64_t kBitsOfByte = 8;

}  // namespace

std::uint64_t SerialFaults::add(const SerialFault& fault) {
  faults_.push_back({.number = ++newest_,
                     .fault = fault,
                     .recurrence = base::Recurrence(fault.count, fault.probability, fault.seed),
                     .bits = base::Random(~fault.seed)});
  return newest_;
}

void SerialFaults::withdraw(std::uint64_t number) {
  std::erase_if(faults_, [number](const Fault& fault) { return fault.number == number; });
}

std::optional<std::uint64_t> SerialFaults::hits(std::uint64_t number) const {
  const auto found = std::ranges::find(faults_, number, &Fault::number);
  return found == faults_.end() || (found->recurrence.over() && !found->hits_telegram)
             ? std::nullopt
             : std::optional(found->recurrence.times());
}

std::vector<std::byte> SerialFaults::spoil(std::span<const std::byte> bytes,
                                           SerialDirection direction, base::SimTime now,
                                           base::SimDuration pause) {
  std::vector<std::byte> left(bytes.begin(), bytes.end());
  for (Fault& fault : faults_) {
    if (fault.fault.direction == direction && !left.empty()) {
      spoil(fault, left, now, pause);
    }
  }
  return left;
}

void SerialFaults::spoil(Fault& fault, std::vector<std::byte>& bytes, base::SimTime now,
                         base::SimDuration pause) {
  if (fault.fault.kind == SerialFaultKind::noise) {
    for (std::byte& byte : bytes) {
      if (fault.recurrence.next()) {
        byte ^= std::byte{1} << static_cast<unsigned>(fault.bits.below(kBitsOfByte));
      }
    }
    return;
  }
  const bool begins = !fault.last || now - *fault.last > pause;
  fault.last = now;
  if (begins) {
    fault.passed = 0;
    fault.hits_telegram = fault.recurrence.next();
  }
  if (!fault.hits_telegram) {
    return;
  }
  if (fault.fault.kind == SerialFaultKind::cut) {
    const std::size_t room = fault.fault.bytes - std::min(fault.fault.bytes, fault.passed);
    fault.passed += bytes.size();
    bytes.resize(std::min(bytes.size(), room));
    return;
  }
  const auto later = std::ranges::upper_bound(delayed_, now + fault.fault.delay, {}, &Delayed::due);
  delayed_.insert(later, {now + fault.fault.delay, fault.fault.direction, std::move(bytes)});
  bytes.clear();
}

SerialFaults::Delayed SerialFaults::take_delayed() {
  Delayed first = std::move(delayed_.front());
  delayed_.pop_front();
  return first;
}

}  // namespace stator::rack
