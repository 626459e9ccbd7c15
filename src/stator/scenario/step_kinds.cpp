#include "stator/scenario/step_kinds.hpp"

#include <array>

namespace stator::scenario {

std::span<const StepKind> step_kinds() {
  static const std::array kinds{kScan,
                                kState,
                                kNmt,
                                kWrite,
                                kEnable,
                                kDisable,
                                kResetFault,
                                kMove,
                                kTmcl,
                                kSend,
                                kWait,
                                kInject,
                                kClear,
                                kExpectSignal,
                                kExpectObject,
                                kExpectState,
                                kExpectPowerState,
                                kExpectRegister,
                                kExpectLostCycles,
                                kExpectFrame,
                                kExpectEmergency,
                                kExpectEvent,
                                kExpectFault};
  return kinds;
}

std::vector<std::string> step_names() {
  std::vector<std::string> names;
  for (const StepKind& kind : step_kinds()) {
    names.emplace_back(kind.name);
  }
  const auto& actions = rack::EventSectionReader::action_names();
  names.insert(names.end(), actions.begin(), actions.end());
  return names;
}

}  // namespace stator::scenario
