#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <vector>

#include "stator/master/frame_port.hpp"

namespace stator::master::test {

/// A port whose answers the test writes: each frame sent is handed to `answer`, which returns the
/// frames that come back.
class ScriptedPort final : public FramePort {
 public:
  using Frame = std::vector<std::byte>;
  using Answer = std::function<std::vector<Frame>(const Frame&)>;

  explicit ScriptedPort(Answer answer) : answer_(std::move(answer)) {}

  Result<std::size_t> exchange(std::span<const std::byte> frame, std::span<std::byte> reply,
                               base::SimDuration timeout) override {
    if (!frame.empty()) {
      sent.emplace_back(frame.begin(), frame.end());
      for (Frame& back : answer_(sent.back())) {
        arrived_.push_back(std::move(back));
      }
    }
    if (arrived_.empty()) {
      now_ += timeout;
      return std::size_t{0};
    }
    const Frame front = std::move(arrived_.front());
    arrived_.pop_front();
    const std::size_t length = std::min(front.size(), reply.size());
    std::copy_n(front.begin(), length, reply.begin());
    return length;
  }
  void wait(base::SimDuration duration) override { now_ += duration; }
  [[nodiscard]] base::SimTime now() override { return now_; }

  std::vector<Frame> sent;

 private:
  Answer answer_;
  std::deque<Frame> arrived_;
  base::SimTime now_;
};

}  // namespace stator::master::test
