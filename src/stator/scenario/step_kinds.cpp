#include "stator/scenario/step_kinds.hpp"

#include <array>

namespace stator::scenario {

namespace {

constexpr std::array kKinds{
    StepKind{"scan", "The master of a segment looks for its slaves and takes them to Init",
             read_scan},
    StepKind{"state", "The master requests a state of the EtherCAT state machine", read_state},
    StepKind{"nmt", "A network management command is sent on a CAN bus", read_nmt},
    StepKind{"write", "An object is written by SDO", read_write},
    StepKind{"enable", "An axis is taken to Operation enabled", read_enable},
    StepKind{"disable", "An axis is taken to Switch on disabled", read_disable},
    StepKind{"reset-fault", "The fault of an axis is acknowledged", read_reset_fault},
    StepKind{"move", "An axis moves in profile position mode", read_move},
    StepKind{"tmcl", "A direct command is sent to a TMCL module", read_tmcl},
    StepKind{"send", "A frame is sent on a CAN bus", read_send},
    StepKind{"wait", "Time passes", read_wait},
    StepKind{"inject", "A fault is put into the rack", read_inject},
    StepKind{"clear", "A fault is ended, or all are", read_clear},
    StepKind{"expect-signal", "A signal has a value", read_expect_signal, true},
    StepKind{"expect-object", "An object has a value, as an SDO reads it", read_expect_object,
             true},
    StepKind{"expect-state", "A device is in a state of its network", read_expect_state, true},
    StepKind{"expect-power-state", "An axis is in a state of the power drive system",
             read_expect_power_state, true},
    StepKind{"expect-register", "A register of a slave controller has a value",
             read_expect_register, true},
    StepKind{"expect-lost-cycles",
             "So many exchanges of process data have failed since the last step that did something",
             read_expect_lost_cycles, true},
    StepKind{"expect-frame",
             "A frame has come over a CAN bus since the last step that did something",
             read_expect_frame, true},
    StepKind{"expect-event", "The rack has told an event since the last step that did something",
             read_expect_event, true},
    StepKind{"expect-fault", "A fault is armed, active or done", read_expect_fault, true},
};

}  // namespace

std::span<const StepKind> step_kinds() {
  return kKinds;
}

}  // namespace stator::scenario
