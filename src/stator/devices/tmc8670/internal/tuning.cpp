#include "stator/devices/tmc8670/internal/tuning.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "stator/devices/tmc8670/configuration.hpp"
#include "stator/devices/tmc8670/keys.hpp"
#include "stator/devices/tmc8670/servo_stage.hpp"
#include "stator/product/catalogue/setup.hpp"

namespace stator::devices::tmc8670 {

namespace {

/// Three digits, as %.3g.
std::string in_short(double value) {
  std::array<char, 32> text{};
  const auto [end, error] =
      std::to_chars(text.begin(), text.end(), value, std::chars_format::general, 3);
  return error == std::errc() ? std::string(text.begin(), end) : std::string();
}

}  // namespace

std::unique_ptr<product::TuningStage> Tuning::stage(const product::Setup& setup) const {
  return std::make_unique<TunableStage>(setup.as<Tmc8670Configuration>().axis);
}

product::TuningBoard Tuning::board(const product::Setup& setup) const {
  const auto& configuration = setup.as<Tmc8670Configuration>();
  const plant::PwmAxisParameters& axis = configuration.axis;
  product::TuningBoard board{.counts_per_ampere = std::fabs(axis.converter.currents[0].gain),
                             .counts_per_volt = axis.converter.voltage.gain};
  for (const ObjectValue& object : configuration.objects) {
    if (object.index == 0x2001 && object.subindex == 1) {
      board.pwm_maximum = static_cast<std::int32_t>(object.bits);
    }
  }
  return board;
}

std::vector<product::TunedObject> Tuning::objects_of(const product::TunedDrive& drive) const {
  constexpr std::int64_t kAbn = 3;
  constexpr std::int64_t kAbnMechanical = 9;
  std::vector<product::TunedObject> objects;
  const auto add = [&](std::uint16_t index, int subindex, std::int64_t value, std::string meaning) {
    objects.push_back({.index = index,
                       .subindex = static_cast<std::uint8_t>(subindex),
                       .value = value,
                       .meaning = std::move(meaning)});
  };
  add(0x2000, 1, static_cast<std::int64_t>(drive.motor), "motor type");
  add(0x2000, 2, drive.pole_pairs, "pole pairs");
  add(0x2000, 3, drive.current_scale, "current scale");
  add(0x2000, 4, std::lround(drive.current_offsets[0]), "current offset 0");
  add(0x2000, 5, std::lround(drive.current_offsets[1]), "current offset 1");
  add(0x2001, 1, drive.pwm_maximum, "PWM maximum count, which the gains hold for");
  add(0x2001, 5, 1, "space vectors");
  add(0x2010, 1, drive.encoder_resolution, "encoder positions per revolution");
  add(0x2010, 7, drive.encoder_reversed ? 1 : 0, "encoder direction");
  add(0x2010, 8, std::lround(drive.encoder_offset), "encoder electrical offset");
  add(0x2020, 1, kAbn, "commutation by the encoder");
  add(0x2020, 2, kAbnMechanical, "velocity of the shaft, rpm");
  add(0x2020, 3, kAbnMechanical, "position of the shaft");
  int subindex = 0;  // gains stand in the order of 2030h
  for (const product::TunedGain& gain : drive.gains) {
    add(0x2030, ++subindex, gain.value, std::string(gain.name) + ", " + std::string(gain.format));
  }
  add(0x2030, 8, 1, "advanced structure");
  add(0x2030, 9, 0, "velocity in every PWM period");
  add(0x2030, 10, 0, "position in every PWM period");
  add(0x2031, 1, std::lround(drive.torque_counts),
      "torque and flux limit, " + in_short(drive.torque_limit) + " A");
  add(0x2031, 3, std::lround(drive.velocity_limit), "velocity limit, rpm");
  return objects;
}

bool Tuning::same_object(std::string_view left, std::string_view right) const {
  const auto a = object_named(left);
  const auto b = object_named(right);
  return a && b && a->index == b->index && a->subindex == b->subindex;
}

}  // namespace stator::devices::tmc8670
