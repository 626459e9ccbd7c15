#include "stator/devices/catalogue/fault_consequences.hpp"

#include <array>

namespace stator::devices {

namespace {

// Numbers behind a slash are the first additional byte of the emergency; those in brackets are
// decisions of docs/devices/.
constexpr auto kConsequences = std::to_array<product::FaultConsequence>({
    {"motor-stall", "tmcm-3315",
     "8611h where an encoder and 6065h watch the axis, with a stop on stall 3230h; without either "
     "nothing is told, and steps are lost in fours"},
    {"motor-stall", "tmc8670",
     "8611h in modes that move to positions; in velocity and torque modes full current, and "
     "nothing is told"},
    {"motor-stall", "tmcc160",
     "nothing is told in any mode, as its document has no following error window (6065h): full "
     "current, the shaft stands, the velocity actual value is 0"},
    {"motor-stall", "tmcm-142",
     "parameter 212 watches it where an encoder is there: it stops, with the error flag 207 bit 1 "
     "and the deviation event; without an encoder nothing is told"},
    {"axis-jammed", "tmcm-3315",
     "8611h where an encoder and 6065h watch the axis, with a stop on stall 3230h; without either "
     "nothing is told, and steps are lost in fours"},
    {"axis-jammed", "tmc8670",
     "8611h in modes that move to positions; in velocity and torque modes full current, and "
     "nothing is told"},
    {"axis-jammed", "tmcc160",
     "nothing is told in any mode, as its document has no following error window (6065h): full "
     "current, the shaft stands, the velocity actual value is 0"},
    {"axis-jammed", "tmcm-142",
     "parameter 212 watches it where an encoder is there: it stops, with the error flag 207 bit 1 "
     "and the deviation event; without an encoder nothing is told"},
    {"friction-rise", "tmcm-3315",
     "if it is more than the motor has, as motor-stall: 8611h where an encoder and 6065h watch the "
     "axis, with a stop on stall 3230h; without either nothing is told, and steps are lost in "
     "fours"},
    {"friction-rise", "tmc8670",
     "if it is more than the motor has, as motor-stall: 8611h in modes that move to positions; in "
     "velocity and torque modes full current, and nothing is told"},
    {"friction-rise", "tmcc160",
     "if it is more than the motor has, as motor-stall: nothing is told in any mode, as its "
     "document has no following error window (6065h): full current, the shaft stands, the velocity "
     "actual value is 0"},
    {"friction-rise", "tmcm-142",
     "if it is more than the motor has, as motor-stall: parameter 212 watches it where an encoder "
     "is there: it stops, with the error flag 207 bit 1 and the deviation event; without an "
     "encoder nothing is told"},
    {"load-step", "tmcm-3315",
     "if it is more than the motor has, as motor-stall: 8611h where an encoder and 6065h watch the "
     "axis, with a stop on stall 3230h; without either nothing is told, and steps are lost in "
     "fours"},
    {"load-step", "tmc8670",
     "if it is more than the motor has, as motor-stall: 8611h in modes that move to positions; in "
     "velocity and torque modes full current, and nothing is told"},
    {"load-step", "tmcc160",
     "if it is more than the motor has, as motor-stall: nothing is told in any mode, as its "
     "document has no following error window (6065h): full current, the shaft stands, the velocity "
     "actual value is 0"},
    {"load-step", "tmcm-142",
     "if it is more than the motor has, as motor-stall: parameter 212 watches it where an encoder "
     "is there: it stops, with the error flag 207 bit 1 and the deviation event; without an "
     "encoder nothing is told"},
    {"phase-loss", "tmcm-3315", "1000h, then 8611h when it stalls"},
    {"phase-loss", "tmc8670", "no code; the phase has no current"},
    {"phase-loss", "tmcc160", "no code (A-74)"},
    {"phase-loss", "tmcm-142", "no flag; too little torque"},
    {"phase-short", "tmcm-3315", "2310h to 2312h"},
    {"phase-short", "tmc8670", "8611h; the chip has no protection of its own"},
    {"phase-short", "tmcc160", "2310h to 2312h"},
    {"phase-short", "tmcm-142", "parameter 26 bit 0, ALARM"},
    {"encoder-glitch", "tmcm-3315", "8611h when it is larger than 6065h"},
    {"encoder-glitch", "tmc8670", "8611h when it is larger than 6065h"},
    {"encoder-glitch", "tmcc160", "nothing is told; the position is off"},
    {"encoder-glitch", "tmcm-142", "deviation event when it is larger than parameter 212"},
    {"encoder-loss", "tmcm-3315", "8611h"},
    {"encoder-loss", "tmc8670", "8611h"},
    {"encoder-loss", "tmcc160", "it loses commutation, if the encoder commutates"},
    {"encoder-loss", "tmcm-142", "it stops, with the deviation event"},
    {"encoder-slip", "tmcm-3315", "8611h"},
    {"encoder-slip", "tmc8670", "8611h; commutation is wrong until it is initialised anew"},
    {"encoder-slip", "tmcc160",
     "8611h is not told; commutation is wrong until it is initialised anew"},
    {"encoder-slip", "tmcm-142", "it stops, with the deviation event"},
    {"hall-fault", "tmc8670", "7310h, if the sensors commutate"},
    {"hall-fault", "tmcc160", "Fault, 200Dh bit 5, no code"},
    {"supply-sag", "tmcm-3315", "FF00h"},
    {"supply-sag", "tmc8670", "3220h"},
    {"supply-sag", "tmcc160", "FF00h"},
    {"supply-sag", "tmcm-142", "parameter 26 bit 0, outside its range"},
    {"supply-overvoltage", "tmcm-3315", "nothing: it is not watched"},
    {"supply-overvoltage", "tmc8670", "3210h"},
    {"supply-overvoltage", "tmcc160", "Fault, 200Dh bit 2, no code (A-75)"},
    {"supply-overvoltage", "tmcm-142", "parameter 26 bit 0"},
    {"over-temperature", "tmcm-3315", "4310h/1 as a warning, then 4310h/2"},
    {"over-temperature", "tmc8670", "refused: nothing measures the power stage"},
    {"over-temperature", "tmcc160", "4310h/1 as a warning, then 4310h/2"},
    {"over-temperature", "tmcm-142", "parameter 26 bit 1, then bit 0"},
    {"switch-stuck", "tmcm-3315", "FF01h/3 or FF01h/4: it stops, without a fault"},
    {"switch-stuck", "tmc8670", "FF01h/3 or FF01h/4"},
    {"switch-stuck", "tmcc160", "FF01h/3 or FF01h/4"},
    {"switch-stuck", "tmcm-142", "it stops, as at a limit"},
    {"brake-stuck", "tmcm-3315",
     "as motor-stall: 8611h where an encoder and 6065h watch the axis, with a stop on stall 3230h; "
     "without either nothing is told, and steps are lost in fours"},
    {"brake-stuck", "tmc8670",
     "as motor-stall: 8611h in modes that move to positions; in velocity and torque modes full "
     "current, and nothing is told"},
    {"brake-stuck", "tmcc160",
     "as motor-stall: nothing is told in any mode, as its document has no following error window "
     "(6065h): full current, the shaft stands, the velocity actual value is 0"},
    {"clock-drift", "tmcm-3315", "AL status codes 092Ch and 0932h"},
    {"clock-drift", "tmc8670", "AL status codes 092Ch and 0932h"},
});

}  // namespace

std::span<const product::FaultConsequence> fault_consequences() {
  return kConsequences;
}

}  // namespace stator::devices
