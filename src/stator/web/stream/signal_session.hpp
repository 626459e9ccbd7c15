#pragma once

#include <string>
#include <string_view>

#include "stator/web/state.hpp"
#include "stator/web/stream/rack_access.hpp"
#include "stator/web/stream/signal_stream.hpp"
#include "stator/web/stream/stream_session.hpp"

namespace stator::web {

/// A client that watches signals.
class SignalSession final : public StreamSession, public TapOwner {
 public:
  SignalSession(State& state, RackAccess& access);

  void take(std::string_view message) override;
  [[nodiscard]] bool ready() const override { return ready_; }
  [[nodiscard]] bool empty() const override { return queue_.empty(); }
  [[nodiscard]] std::string next() override { return queue_.take(); }
  [[nodiscard]] bool next_is_binary() const override { return queue_.front_is_binary(); }
  void end() override;

  void tapped() override;
  void collect(rack::SignalTap& tap) override;
  void collect_events() override;

 private:
  State& state_;
  RackAccess& access_;
  StreamQueue queue_;
  bool ready_ = true;
  bool ended_ = false;
};

}  // namespace stator::web
