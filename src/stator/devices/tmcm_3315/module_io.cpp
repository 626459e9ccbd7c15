#include "stator/devices/tmcm_3315/module_io.hpp"

#include <string>

namespace stator::devices::tmcm_3315 {

namespace {

constexpr std::uint32_t bit_of(std::size_t channel) {
  return 1U << (16U + channel);  // of 2702h and 2703h
}

constexpr std::uint8_t kOff = 0;
constexpr std::uint8_t kFullyOn = 255;

}  // namespace

ModuleIo::ModuleIo(dictionary::Dictionary& dictionary)
    : digital_inputs_(dictionary.variable<std::uint32_t>(0x2702)),
      physical_outputs_(dictionary.variable<std::uint32_t>(0x2703, 1)),
      output_mask_(dictionary.variable<std::uint32_t>(0x2703, 2)) {
  for (std::size_t i = 0; i < kChannels; ++i) {
    analog_inputs_[i] =
        dictionary.variable<std::uint32_t>(0x270E, static_cast<std::uint8_t>(i + 1));
  }
}

void ModuleIo::restart() {
  for (Channel& channel : channels_) {
    channel.switched_on = false;
    channel.output = kOff;
  }
}

void ModuleIo::read_inputs() {
  digital_inputs_.set(input_bits());
  for (std::size_t i = 0; i < kChannels; ++i) {
    analog_inputs_[i].set(
        static_cast<std::uint32_t>(noise_.disturb(channels_[i].counts, kFullScale)));
  }
}

void ModuleIo::switch_outputs(bool operational, const BrakeFeeds& brakes) {
  for (std::size_t i = 0; i < kChannels; ++i) {
    Channel& channel = channels_[i];
    const bool serves_brake = i < brakes.size() && brakes[i];
    if (!operational || serves_brake) {
      channel.switched_on = false;
    } else if ((output_mask_.get() & bit_of(i)) != 0) {
      channel.switched_on = (physical_outputs_.get() & bit_of(i)) != 0;
    }
    channel.output = serves_brake ? *brakes[i] : channel.switched_on ? kFullyOn : kOff;
  }
}

std::uint32_t ModuleIo::input_bits() const {
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < kChannels; ++i) {
    bits |= channels_[i].level() ? bit_of(i) : 0U;
  }
  return bits;
}

std::uint32_t ModuleIo::output_bits() const {
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < kChannels; ++i) {
    bits |= channels_[i].output != 0 ? bit_of(i) : 0U;
  }
  return bits;
}

void ModuleIo::append_signals(std::vector<product::Signal>& signals) const {
  using Read = base::SignalReader;
  for (std::size_t i = 0; i < kChannels; ++i) {
    const std::string number = std::to_string(i);
    const Channel& channel = channels_[i];
    signals.push_back({"output" + number, "", Read::bind<&Channel::duty>(channel)});
    signals.push_back({"input" + number, "", Read::bind<&Channel::read_level>(channel)});
    signals.push_back(
        {"analog_input" + number, "count", Read::bind<&Channel::read_counts>(channel)});
  }
}

void ModuleIo::append_inputs(std::vector<product::Input>& inputs) {
  using Set = base::Delegate<void(double)>;
  for (std::size_t i = 0; i < kChannels; ++i) {
    const std::string number = std::to_string(i);
    Channel& channel = channels_[i];
    inputs.emplace_back("input" + number, "", 0.0, 1.0, Set::bind<&Channel::set_level>(channel),
                        product::InputGroup::lines);
    inputs.emplace_back("analog_input" + number, "count", 0.0, 65535.0,
                        Set::bind<&Channel::set_counts>(channel), product::InputGroup::lines);
  }
  inputs.emplace_back("analog_noise", "count", 0.0, 65535.0,
                      Set::bind<&product::AnalogNoise::set_amplitude>(noise_),
                      product::InputGroup::lines);
}

}  // namespace stator::devices::tmcm_3315
