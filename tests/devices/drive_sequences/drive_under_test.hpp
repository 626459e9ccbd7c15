#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "devices/drive_sequences/recording.hpp"
#include "devices/drive_sequences/sequence.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/product/device/device.hpp"

namespace stator::tests {

/// What the steps set of a drive's surroundings.
struct Surroundings {
  double load = 0.0;     ///< N m
  double source = 24.0;  ///< V
  double inertia = 0.0;  ///< kg m², added
  bool jammed = false;
};

/// One drive with its plant in simulated time, and whoever acts on it. A millisecond is the grain:
/// process data are exchanged and a sample is taken in each.
class DriveUnderTest {
 public:
  DriveUnderTest(const DriveUnderTest&) = delete;
  DriveUnderTest& operator=(const DriveUnderTest&) = delete;
  virtual ~DriveUnderTest() = default;

  [[nodiscard]] const DriveTraits& traits() const { return traits_; }
  /// Does a step, but lets no time pass: not for wait and travel.
  void perform(const DriveStep& step);
  /// A millisecond passes.
  void pass();
  /// What happened in it.
  [[nodiscard]] virtual Sample sample() = 0;
  /// rev/s of the true shaft, whatever the drive counts.
  [[nodiscard]] virtual double shaft_velocity() = 0;
  [[nodiscard]] virtual double shaft_position() = 0;
  /// Increments of 6064h, to count targets from.
  [[nodiscard]] virtual std::int64_t actual_position() = 0;

  /// Everything performed so far in steps that do not depend on the shaft.
  [[nodiscard]] const std::vector<DriveStep>& resolved() const { return resolved_; }

 protected:
  DriveUnderTest() = default;
  /// What can be set around `device`; once, before anything is performed.
  void surround(product::Device& device) { inputs_ = device.inputs(); }

  virtual void write(const DriveStep& step) = 0;
  virtual void go_to_network_state(int state) = 0;
  virtual void command(const DriveStep& step);
  /// Exchanges process data `times` times and lets the rest of the millisecond pass.
  virtual void pass_cycle(int times) = 0;
  virtual void set_input(std::string_view name, double level);
  [[nodiscard]] const Surroundings& surroundings() const { return surroundings_; }
  void note(const DriveStep& step) { resolved_.push_back(step); }

  DriveTraits traits_;

 private:
  struct Cam {
    std::string_view input;
    double at = 0.0;  ///< revolutions
    bool pressed = false;
  };
  void turn_cams();

  std::vector<base::Input> inputs_;
  std::vector<Cam> cams_;
  Surroundings surroundings_;
  std::vector<DriveStep> resolved_;
  std::int64_t lost_ = 0;
  bool doubled_ = false;
};

/// As the tests have it: what scenario_of() says in the words of a rack file.
[[nodiscard]] std::unique_ptr<DriveUnderTest> make_drive(Product product);

}  // namespace stator::tests
