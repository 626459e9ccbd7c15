#include "stator/canopen/nmt_state.hpp"

namespace stator::canopen {

base::StaticText to_text(NmtState state) {
  switch (state) {
    case NmtState::initialisation:
      return "Initialisation";
    case NmtState::stopped:
      return "Stopped";
    case NmtState::operational:
      return "Operational";
    case NmtState::pre_operational:
      return "Pre-operational";
  }
  return "?";
}

}  // namespace stator::canopen
