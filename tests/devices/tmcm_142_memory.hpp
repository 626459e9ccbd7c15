#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "stator/canopen/storage/non_volatile_memory.hpp"

namespace stator::tests {

/// What a state directory is for a TMCM-142: a memory that is as slow, or as full, as a test wants.
/// It shows what is kept, so a second module begins with that.
class ModuleMemory final : public canopen::NonVolatileMemory {
 public:
  /// What becomes of orders at once, without finish().
  enum class Answer : std::uint8_t { kept, failed, later };

  explicit ModuleMemory(Answer wanted = Answer::kept) : answer(wanted) {}

  [[nodiscard]] std::span<const std::byte> image(std::uint8_t group) const override {
    const auto found = images.find(group);
    return found == images.end() ? std::span<const std::byte>() : found->second;
  }
  using NonVolatileMemory::store;
  void store(std::span<const GroupImage> wanted) override {
    ++orders;
    for (const GroupImage& each : wanted) {
      ordered_[each.group].assign(each.bytes.begin(), each.bytes.end());
    }
    status_ = Status::busy;
    if (answer != Answer::later) {
      finish(answer == Answer::kept);
    }
  }
  [[nodiscard]] Status status() const override { return status_; }
  /// All that was ordered is kept, or nothing of it.
  void finish(bool kept) {
    for (auto& [group, bytes] : ordered_) {
      if (kept) {
        images[group] = bytes;
      }
    }
    ordered_.clear();
    status_ = kept ? Status::ready : Status::failed;
  }

  Answer answer;
  std::map<std::uint8_t, std::vector<std::byte>> images;
  int orders = 0;

 private:
  std::map<std::uint8_t, std::vector<std::byte>> ordered_;
  Status status_ = Status::ready;
};

}  // namespace stator::tests
