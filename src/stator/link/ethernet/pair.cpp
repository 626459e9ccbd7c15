#include "stator/link/ethernet/pair.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <vector>

#include "stator/link/ethernet/link_counters.hpp"

namespace stator::link {

/// One direction of the cable: a ring of frames with all its memory taken at construction.
class Pair::Queue {
 public:
  explicit Queue(std::size_t capacity) : frames_(capacity) {}

  bool push(std::span<const std::byte> frame) {
    const std::lock_guard lock(mutex_);
    if (count_ == frames_.size()) {
      ++dropped_;
      return false;
    }
    Frame& slot = frames_[(oldest_ + count_) % frames_.size()];
    std::memcpy(slot.bytes.data(), frame.data(), frame.size());
    slot.length = frame.size();
    ++count_;
    changed_.notify_one();
    return true;
  }

  std::size_t pop(std::span<std::byte> buffer, base::SimDuration timeout) {
    std::unique_lock lock(mutex_);
    const auto ready = [this] { return count_ != 0 || woken_; };
    if (!ready() && timeout > base::SimDuration(0)) {
      // Limited to a year, since longer waits would overflow the range of the clock.
      const auto longest = std::chrono::nanoseconds(std::chrono::hours(24 * 365));
      changed_.wait_for(lock, std::min(std::chrono::nanoseconds(timeout.nanoseconds()), longest),
                        ready);
    }
    if (woken_ || count_ == 0) {
      woken_ = false;
      return 0;
    }
    const Frame& frame = frames_[oldest_];
    const std::size_t length = std::min(frame.length, buffer.size());
    std::memcpy(buffer.data(), frame.bytes.data(), length);
    oldest_ = (oldest_ + 1) % frames_.size();
    --count_;
    return length;
  }

  void wake() noexcept {
    const std::lock_guard lock(mutex_);
    woken_ = true;
    changed_.notify_one();
  }

  [[nodiscard]] std::uint64_t dropped() const {
    const std::lock_guard lock(mutex_);
    return dropped_;
  }

 private:
  struct Frame {
    std::array<std::byte, kMaximumFrameLength> bytes{};
    std::size_t length = 0;
  };

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Frame> frames_;
  std::size_t oldest_ = 0;
  std::size_t count_ = 0;
  std::uint64_t dropped_ = 0;
  bool woken_ = false;
};

class Pair::End final : public EthernetLink {
 public:
  End(std::string name, Queue& incoming, Queue& outgoing)
      : name_(std::move(name)), incoming_(incoming), outgoing_(outgoing) {}

  base::Expected<std::size_t, LinkError> receive(std::span<std::byte> buffer,
                                                 base::SimDuration timeout) override {
    const std::size_t length = incoming_.pop(buffer, timeout);
    if (length != 0) {
      counters_.count_received(length);
    }
    return length;
  }

  base::Expected<void, LinkError> send(std::span<const std::byte> frame) override {
    if (frame.size() < kEthernetHeaderLength || frame.size() > kMaximumFrameLength) {
      counters_.count_send_error();
      return base::Unexpected{
          LinkError{LinkErrorCode::frame_length, "\"" + name_ + "\" does not carry a frame of " +
                                                     std::to_string(frame.size()) + " bytes"}};
    }
    if (!outgoing_.push(frame)) {
      counters_.count_send_error();
      return base::Unexpected{LinkError{
          LinkErrorCode::queue_full,
          "the other end of \"" + name_ + "\" does not take its frames; one was dropped"}};
    }
    counters_.count_sent(frame.size());
    return {};
  }

  void wake() noexcept override { incoming_.wake(); }

  [[nodiscard]] LinkStatistics statistics() const override {
    LinkStatistics statistics = counters_.snapshot();
    statistics.frames_dropped = incoming_.dropped();
    return statistics;
  }

  [[nodiscard]] const std::string& name() const override { return name_; }

 private:
  std::string name_;
  Queue& incoming_;
  Queue& outgoing_;
  LinkCounters counters_;
};

Pair::Pair(std::size_t capacity)
    : queues_{std::make_unique<Queue>(capacity), std::make_unique<Queue>(capacity)},
      ends_{std::make_unique<End>("pair, first end", *queues_[0], *queues_[1]),
            std::make_unique<End>("pair, second end", *queues_[1], *queues_[0])} {}

Pair::~Pair() = default;

EthernetLink& Pair::first() {
  return *ends_[0];
}

EthernetLink& Pair::second() {
  return *ends_[1];
}

}  // namespace stator::link
