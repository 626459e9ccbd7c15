#pragma once

#include <cstdint>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/devices/tmcc160/options.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/drive/servo/servo_axis.hpp"
#include "stator/product/device/signal.hpp"

namespace stator::devices::tmcc160 {

/// The manufacturer objects of the axis, 2005h to 2100h: parameters on their way into the axis,
/// its values on their way out.
///
/// Parameters are read when one was written, values when somebody asks for them: a drive that
/// nobody asks costs nothing here.
class ServoObjects {
 public:
  ServoObjects(dictionary::Dictionary& dictionary, const Options& options);
  ServoObjects(const ServoObjects&) = delete;
  ServoObjects& operator=(const ServoObjects&) = delete;
  ~ServoObjects() = default;

  /// The axis the objects belong to, after each start of the firmware.
  void attach(drive::ServoAxis& axis) {
    axis_ = &axis;
    changed_ = true;
  }
  /// Brings the axis' settings up to date if a parameter was written.
  void configure() {
    if (changed_) {
      take_over();
    }
  }
  /// Where the axis warns and switches off, which no object says.
  void set_limits(const drive::ServoLimits& limits) { limits_ = limits; }

  /// Appends "axis0.<name>" for everything worth recording of the drive.
  void append_signals(std::vector<product::Signal>& signals) const;

 private:
  using Entry = dictionary::Entry;
  using Verdict = dictionary::Verdict;

  void take_over();
  void note_change(const Entry& /*entry*/) { changed_ = true; }
  void mirror_encoder_steps(const Entry& entry);
  void place_position(const Entry& entry);
  void set_i2t_counter(const Entry& entry);
  void clear_i2t_exceeded(const Entry& entry);
  [[nodiscard]] Verdict check_poles(const Entry& entry, std::uint64_t bits);
  [[nodiscard]] Verdict check_encoder_steps(const Entry& entry, std::uint64_t bits);
  [[nodiscard]] Verdict check_commutation(const Entry& entry, std::uint64_t bits);
  [[nodiscard]] Verdict check_position(const Entry& entry, std::uint64_t bits);
  [[nodiscard]] Verdict check_switches(const Entry& entry, std::uint64_t bits);
  void show(Entry& entry);

  [[nodiscard]] double position_demand() const;
  [[nodiscard]] double position_actual() const;
  [[nodiscard]] double velocity_demand() const { return axis_->controller().velocity_demand(); }
  [[nodiscard]] double velocity_actual() const { return axis_->controller().velocity(); }
  [[nodiscard]] double current_demand() const;
  [[nodiscard]] double current_actual() const;
  [[nodiscard]] double i2t_sum() const { return axis_->controller().i2t_sum(); }
  [[nodiscard]] double status_flags() const { return axis_->flags().bits(); }
  [[nodiscard]] double brake_chopper() const;
  [[nodiscard]] double controlword() const { return axis_->objects().controlword.get(); }
  [[nodiscard]] double statusword() const { return axis_->objects().statusword.get(); }
  [[nodiscard]] double mode() const { return static_cast<double>(axis_->mode()); }

  [[nodiscard]] std::uint64_t value(std::uint16_t index, std::uint8_t subindex = 0) const;

  dictionary::Dictionary& dictionary_;
  Options options_;
  drive::ServoLimits limits_;
  drive::ServoAxis* axis_ = nullptr;
  bool changed_ = true;
};

}  // namespace stator::devices::tmcc160
