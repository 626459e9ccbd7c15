#pragma once

#include <string>
#include <string_view>

#include "web/rack_access.hpp"
#include "web/signal_stream.hpp"
#include "web/state.hpp"
#include "web/stream_session.hpp"

namespace stator::web {

/// A client that watches signals.
class SignalSession final : public StreamSession, public TapOwner {
 public:
  SignalSession(State& state, RackAccess& access);

  void take(std::string_view message) override;
  [[nodiscard]] bool ready() const override { return ready_; }
  [[nodiscard]] bool empty() const override { return queue_.empty(); }
  [[nodiscard]] std::string next() override { return queue_.take(); }
  void end() override;

  void tapped() override;
  void collect(rack::SignalTap& tap) override;

 private:
  State& state_;
  RackAccess& access_;
  StreamQueue queue_;
  bool ready_ = true;
  bool ended_ = false;
};

}  // namespace stator::web
