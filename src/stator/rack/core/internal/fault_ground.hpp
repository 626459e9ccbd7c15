#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "stator/rack/core/view.hpp"
#include "stator/rack/faults/target.hpp"

namespace stator::rack {

/// The parts of a rack as its faults reach them.
class FaultGround final : public faults::Target {
 public:
  /// `view` is that of the rack that `parts` belong to.
  FaultGround(RackParts& parts, const View& view) : parts_(parts), view_(view) {}

  void apply(const RackEvent& event, base::SimTime now) override;
  void hold(const faults::Holdable& event, const void* owner, base::SimTime now) override;
  void release(const faults::Holdable& event, const void* owner, base::SimTime now) override;
  ethercat::Segment& segment(std::size_t index) override;
  CanNetwork& bus(std::size_t index) override;
  SerialLine* line(std::string_view link) override;
  product::EtherCatDevice& slave(DeviceAddress device) override;
  [[nodiscard]] const std::string& name_of(DeviceAddress device) const override {
    return view_.name_of(device);
  }
  [[nodiscard]] const product::Device& device(DeviceAddress device) const override {
    return view_.device(device);
  }
  [[nodiscard]] const std::vector<product::InputRange>& inputs(
      DeviceAddress device) const override {
    return view_.inputs(device);
  }
  [[nodiscard]] bool powered(DeviceAddress device) const override { return view_.powered(device); }
  [[nodiscard]] dictionary::NetworkState network_state(DeviceAddress device) const override {
    return view_.network_state(device);
  }
  [[nodiscard]] base::EventReporter reporter(const FaultConfiguration& fault) override;

 private:
  RackParts& parts_;
  const View& view_;
};

}  // namespace stator::rack
