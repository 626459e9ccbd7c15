#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "master/simulated_drive.hpp"
#include "stator/base/random.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/ethercat/controller/slave_controller.hpp"
#include "stator/ethercat/segment/segment.hpp"
#include "stator/ethercat/stack/slave_stack.hpp"
#include "stator/master/frame_port.hpp"

namespace stator::master::test {

/// A slave with the project's own controller and stack and a two-axis drive on top. Axis 0 is
/// mapped into process data (6040h, 607Ah; 6041h, 6064h), axis 1 is reached by SDO only.
class SimulatedSlave final : public ethercat::SlaveApplication {
 public:
  explicit SimulatedSlave(std::uint32_t serial_number);

  void advance(base::SimTime now);
  void handle_bus_events(base::SimTime now) { stack.process(now); }

  void on_state(ethercat::AlState, ethercat::AlState, base::SimTime) override {}
  void on_outputs(base::SimTime) override {}
  void before_inputs(base::SimTime) override {}

  dictionary::Dictionary dictionary;
  ethercat::DeviceDescription description;
  ethercat::SlaveController controller;
  ethercat::SlaveStack stack;
  std::vector<SimulatedDrive> drives;

 private:
  base::SimTime next_tick_;
};

/// A segment of simulated slaves at the other end of the master's port, and a line that loses,
/// doubles and delays frames. Time passes by waiting only, and a little with each frame.
class SimulatedSegment final : public FramePort {
 public:
  explicit SimulatedSegment(std::size_t slaves = 1);

  Result<std::size_t> exchange(std::span<const std::byte> frame, std::span<std::byte> reply,
                               base::SimDuration timeout) override;
  void wait(base::SimDuration duration) override;
  [[nodiscard]] base::SimTime now() override { return now_; }

  [[nodiscard]] SimulatedSlave& slave(std::size_t position) { return *slaves_[position]; }
  [[nodiscard]] ethercat::Segment& segment() { return segment_; }

  int lose_requests = 0;  ///< so many of the next frames do not reach the slaves
  int lose_answers = 0;   ///< so many of the next frames reach them but do not come back
  int delay_answers = 0;  ///< so many of the next answers come with the next frame
  bool double_answers = false;
  unsigned loss_per_mille = 0;  ///< at random, half of it on either way
  std::size_t frames = 0;       ///< sent by the master

 private:
  bool lost(int& planned);
  void deliver(std::vector<std::byte> frame);

  std::vector<std::unique_ptr<SimulatedSlave>> slaves_;
  ethercat::Segment segment_;
  base::SimTime now_;
  base::Random random_{1};
  std::deque<std::vector<std::byte>> arrived_;
  std::vector<std::byte> delayed_;
};

}  // namespace stator::master::test
