#include "stator/devices/tmcm_142/module_io.hpp"

#include <algorithm>

namespace stator::devices::tmcm_142 {

std::uint32_t ModuleIo::inputs(bool home_contact) const {
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < kInputs; ++i) {
    bool on = i < kAnalogInputs ? voltages_[i] >= kTtlThreshold : levels_[i];
    if (i == kHomeInput) {
      on = on || home_contact;
    }
    if (i >= kFirstOptoInput) {
      on = on && opto_bias_;
    }
    bits |= on ? 1U << i : 0U;
  }
  return bits;
}

std::int32_t ModuleIo::converter(std::size_t channel) const {
  const double counts = voltages_[channel] / kReferenceVoltage * kConverterCounts;
  return noise_.disturb(std::min(static_cast<std::int32_t>(counts), kConverterCounts - 1),
                        kConverterCounts - 1);
}

void ModuleIo::append_signals(std::vector<product::Signal>& signals) const {
  using Read = base::SignalReader;
  signals.push_back({"output0", "", Read::bind<&ModuleIo::output<0>>(*this)});
  signals.push_back({"output1", "", Read::bind<&ModuleIo::output<1>>(*this)});
  signals.push_back({"output2", "", Read::bind<&ModuleIo::output<2>>(*this)});
  signals.push_back({"output7", "", Read::bind<&ModuleIo::output<7>>(*this)});
}

void ModuleIo::append_inputs(std::vector<product::Input>& inputs) {
  using Set = base::Delegate<void(double)>;
  const auto voltage = [&](const char* name, Set set) {
    inputs.emplace_back(name, "V", 0.0, kReferenceVoltage, set, product::InputGroup::lines);
  };
  const auto level = [&](const char* name, Set set,
                         product::InputGroup group = product::InputGroup::lines) {
    inputs.emplace_back(name, "", 0.0, 1.0, set, group);
  };
  voltage("input0", Set::bind<&ModuleIo::set_voltage<0>>(*this));
  voltage("input1", Set::bind<&ModuleIo::set_voltage<1>>(*this));
  voltage("input2", Set::bind<&ModuleIo::set_voltage<2>>(*this));
  level("input3", Set::bind<&ModuleIo::set_level<3>>(*this));
  level("input4", Set::bind<&ModuleIo::set_level<4>>(*this));
  level("input5", Set::bind<&ModuleIo::set_level<5>>(*this));
  level("input6", Set::bind<&ModuleIo::set_level<6>>(*this));
  level("input7", Set::bind<&ModuleIo::set_level<7>>(*this));
  level("input8", Set::bind<&ModuleIo::set_level<8>>(*this));
  level("shutdown", Set::bind<&ModuleIo::set_shutdown>(*this), product::InputGroup::switches);
  inputs.emplace_back("analog_noise", "count", 0.0, 1023.0,
                      Set::bind<&product::AnalogNoise::set_amplitude>(noise_),
                      product::InputGroup::lines);
}

}  // namespace stator::devices::tmcm_142
