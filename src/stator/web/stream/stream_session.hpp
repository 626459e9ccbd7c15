#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace stator::web {

/// What is said on a WebSocket: takes the client's messages, one after the other, and has messages
/// for it. In the server's thread.
class StreamSession {
 public:
  StreamSession() = default;
  StreamSession(const StreamSession&) = delete;
  StreamSession& operator=(const StreamSession&) = delete;
  virtual ~StreamSession() = default;

  /// Takes a message; only when it is ready() for one.
  virtual void take(std::string_view message) = 0;
  /// The last message has been dealt with, and the next one may be taken.
  [[nodiscard]] virtual bool ready() const = 0;

  /// Nothing waits for the client.
  [[nodiscard]] virtual bool empty() const = 0;
  /// The oldest message that waits, which is on its way then.
  [[nodiscard]] virtual std::string next() = 0;
  /// It is binary and no text.
  [[nodiscard]] virtual bool next_is_binary() const { return false; }

  /// The client is gone.
  virtual void end() = 0;

  /// `changed` is called when empty() or ready() may have become something else; `owner` owns the
  /// session.
  void watch(std::weak_ptr<void> owner, std::function<void()> changed) {
    owner_ = std::move(owner);
    changed_ = std::move(changed);
  }

 protected:
  void tell() const {
    if (changed_) {
      changed_();
    }
  }
  /// `self`, a part of this session, for somebody who is to keep it and its owner alive.
  template <typename Part>
  [[nodiscard]] std::shared_ptr<Part> shared(Part* self) const {
    return std::shared_ptr<Part>(owner_.lock(), self);
  }

 private:
  std::weak_ptr<void> owner_;
  std::function<void()> changed_;
};

}  // namespace stator::web
