// The part of FocAxis for captures in every PWM period and for the objects it shows.

#include <cmath>

#include "stator/control/foc/fixed_point.hpp"
#include "stator/drive/foc/foc_axis.hpp"

namespace stator::drive {

namespace {

using control::foc::field;
using control::foc::wrap_s16;

constexpr std::int32_t kSecondEncoder = 10;  // POSITION_SELECTION

/// The registers of one encoder interface that concern N.
struct IndexFields {
  control::foc::Field event;
  control::foc::Field count;
  control::foc::Field latch;
  control::foc::Field resolution;
};

constexpr IndexFields kFirst{field("ENC_N"), field("ABN_DECODER_COUNT"),
                             field("ABN_DECODER_COUNT_N"), field("ABN_DECODER_PPR")};
constexpr IndexFields kSecond{field("ENC_2_N"), field("ABN_2_DECODER_COUNT"),
                              field("ABN_2_DECODER_COUNT_N"), field("ABN_2_DECODER_PPR")};

/// The encoder whose position counts.
const IndexFields& index_fields(const control::foc::FocBlock& block) {
  return block.get(field("POSITION_SELECTION")) == kSecondEncoder ? kSecond : kFirst;
}

}  // namespace

FocAxis::ShownObjects::ShownObjects(dictionary::Dictionary& dictionary,
                                    std::uint16_t index_offset) {
  const auto bind = [&]<typename T>(OptionalVariable<T>& variable, unsigned index,
                                    std::uint8_t subindex = 0) {
    const auto place = static_cast<std::uint16_t>(index + index_offset);
    if (dictionary.find(place, subindex) != nullptr) {
      variable.bind(dictionary.variable<T>(place, subindex));
    }
  };
  bind(torque_demand, 0x6074);
  bind(current_actual, 0x6078);
  bind(supply_voltage, 0x6079);
  bind(probe_function, 0x60B8);
  bind(probe_status, 0x60B9);
  for (unsigned k = 0; k < probe_position.size(); ++k) {
    bind(probe_position[k], 0x60BAU + k);
    bind(probe_time[k], 0x60D1U + k);
  }
  bind(probe_source[0], 0x60D0, 1);
  bind(probe_source[1], 0x60D0, 2);
}

void FocAxis::configure_probes() {
  const ProbeCommand command{
      .function = shown_.probe_function.get(),
      .source = {shown_.probe_source[0].get(), shown_.probe_source[1].get()}};
  if (command == probe_command_) {
    return;
  }
  probe_command_ = command;
  const bool waited = touch_probe_.waits_for_index();
  touch_probe_.configure(command.function, command.source);
  if (touch_probe_.waits_for_index() && !waited) {
    block_.set(index_fields(block_).event, 0);  // pulses of before do not count
  }
}

void FocAxis::capture(const FocObservation& seen) {
  const IndexFields& index = index_fields(block_);
  const std::int64_t count = count_at(block_.get(field("PID_POSITION_ACTUAL")));
  const bool passed = block_.get(index.event) != 0;
  if (passed) {
    block_.set(index.event, 0);
    ++index_passages_;
    const auto angle = [&](const control::foc::Field& f) {
      return block_.get(f) * kBlockCounts / std::max(block_.get(index.resolution), 1);
    };
    index_count_ = count - wrap_s16(angle(index.count) - angle(index.latch));
  }
  if (homing_capture_.armed()) {
    const ReferenceSignals signals{.switches = switch_levels_of_block(),
                                   .encoder_count = count,
                                   .encoder_index = count == index_count_,
                                   .encoder_index_passages = index_passages_,
                                   .encoder_index_count = index_count_};
    homing_capture_.observe(signals, reference(), true, count);
  }
  if (touch_probe_.armed()) {
    const auto object = [this](std::int64_t at) {
      return motion_.scaled(feedback_.position_at(at));
    };
    touch_probe_.observe({.input = seen.probe,
                          .index = passed,
                          .position = object(count),
                          .index_position = object(index_count_),
                          .now = seen.now});
  }
}

void FocAxis::show() {
  objects_.position_internal.set(static_cast<std::int32_t>(count_));
  shown_.supply_voltage.set(
      static_cast<std::uint32_t>(std::floor(std::max(supply_voltage_, 0.0) * 1e3 + 0.5)));
  shown_.current_actual.set(torque_object(current_));
  shown_.torque_demand.set(torque_object(demanded_torque()));
  shown_.probe_status.set(touch_probe_.status());
  for (unsigned k = 0; k < shown_.probe_position.size(); ++k) {
    const TouchProbe::Sample& sample =
        k % 2 == 0 ? touch_probe_.positive(k / 2) : touch_probe_.negative(k / 2);
    shown_.probe_position[k].set(sample.position);
    shown_.probe_time[k].set(sample.time);
  }
}

/// A: of the torque modes what they ask for, else what the velocity loop asked for last.
double FocAxis::demanded_torque() const {
  switch (written_.mode) {
    case MotionMode::stopped:
      return 0.0;
    case MotionMode::torque:
      return torque_demand_;
    default: {
      const double torque =
          block_.get(field("PIDOUT_TARGET_TORQUE")) * foc_settings_.current_per_step;
      return reversed_ ? -torque : torque;
    }
  }
}

std::int16_t FocAxis::torque_object(double amperes) const {
  return static_cast<std::int16_t>(control::foc::saturate_s16(
      static_cast<std::int64_t>(std::floor(amperes * settings_.torque_unit.per_ampere + 0.5))));
}

}  // namespace stator::drive
