#include "stator/plant/sensors/current_converter.hpp"

namespace stator::plant {

CurrentConverter::CurrentConverter(const ConverterParameters& parameters)
    : parameters_(parameters),
      step_(static_cast<double>(1U << static_cast<unsigned>(16 - parameters.bits))),
      inverse_step_(1.0 / step_) {}

}  // namespace stator::plant
