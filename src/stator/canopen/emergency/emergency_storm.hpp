#pragma once

#include <array>
#include <cstdint>

#include "stator/base/byte_order.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/can/transmitter.hpp"
#include "stator/canopen/service.hpp"
#include "stator/dictionary/quirks.hpp"

namespace stator::canopen {

/// The quirk emergency-storm: emergencies without a cause, in a fixed rhythm, at the identifier of
/// the predefined connection set.
class EmergencyStorm final : public Service {
 public:
  EmergencyStorm(can::Transmitter& transmitter, unsigned per_second)
      : transmitter_(transmitter), period_(1'000'000'000 / std::int64_t{per_second}) {}

  void set_node_id(std::uint8_t node_id) { node_id_ = node_id; }

  void start(base::SimTime /*now*/) override { due_ = base::SimTime::never(); }
  void on_state(NmtState state, base::SimTime now) override {
    const bool talks = state == NmtState::pre_operational || state == NmtState::operational;
    if (!talks) {
      due_ = base::SimTime::never();
    } else if (due_ == base::SimTime::never()) {
      due_ = now + period_;
    }
  }
  void advance(base::SimTime now) override {
    if (now < due_) {
      return;
    }
    constexpr std::uint32_t kEmergencyBase = 0x80;
    constexpr std::byte kManufacturerError{0x80};
    std::array<std::byte, can::kMaximumData> data{};
    base::store_le(data, 0, dictionary::kStormEmergency);
    data[2] = kManufacturerError;
    transmitter_.send(can::data_frame(kEmergencyBase + node_id_, data));
    due_ += period_;
  }
  [[nodiscard]] base::SimTime next_deadline() const override { return due_; }

 private:
  can::Transmitter& transmitter_;
  base::SimDuration period_;
  std::uint8_t node_id_ = 0;
  base::SimTime due_ = base::SimTime::never();
};

}  // namespace stator::canopen
