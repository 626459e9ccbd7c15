#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <utility>

namespace stator::web {

/// Messages that wait for a client, a megabyte at most: the oldest give way.
class MessageQueue {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{1} << 20U;

  struct Message {
    std::string text;
    std::size_t rows = 0;  ///< samples or frames in it
  };

  /// Returns how many rows had to give way.
  std::size_t push(Message message) {
    bytes_ += message.text.size();
    messages_.push_back(std::move(message));
    std::size_t dropped = 0;
    while (bytes_ > kMostBytes && messages_.size() > 1) {
      dropped += messages_.front().rows;
      bytes_ -= messages_.front().text.size();
      messages_.pop_front();
    }
    return dropped;
  }
  [[nodiscard]] bool empty() const { return messages_.empty(); }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  /// The oldest message; there must be one.
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
