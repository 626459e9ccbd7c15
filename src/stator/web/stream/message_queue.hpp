#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <utility>

namespace stator::web {

/// Messages that wait for a client, a megabyte at most. The oldest samples or frames give way
/// first: what a client must know beside them is short and rare.
class MessageQueue {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{1} << 20U;

  struct Message {
    std::string text;
    std::size_t rows = 0;  ///< samples or frames in it
    bool binary = false;
  };

  /// Returns how many rows had to give way.
  std::size_t push(Message message) {
    bytes_ += message.text.size();
    messages_.push_back(std::move(message));
    std::size_t dropped = 0;
    while (bytes_ > kMostBytes && messages_.size() > 1) {
      auto victim =
          std::ranges::find_if(messages_, [](const Message& each) { return each.rows > 0; });
      victim = victim == messages_.end() ? messages_.begin() : victim;
      dropped += victim->rows;
      bytes_ -= victim->text.size();
      messages_.erase(victim);
    }
    return dropped;
  }
  [[nodiscard]] bool empty() const { return messages_.empty(); }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  /// The oldest message; there must be one.
  [[nodiscard]] const Message& front() const { return messages_.front(); }
  [[nodiscard]] Message take() {
    Message message = std::move(messages_.front());
    messages_.pop_front();
    bytes_ -= message.text.size();
    return message;
  }

 private:
  std::deque<Message> messages_;
  std::size_t bytes_ = 0;
};

}  // namespace stator::web
