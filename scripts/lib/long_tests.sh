# Tests that let motors turn, programs run or texts be read for many simulated seconds. Their rooms have short ones, which take
# the same paths through memory; below a sanitizer these here take more than a third of all tests' time, so .ci/run leaves
# them to the release build and scripts/nightly runs them. Sourced by scripts that run tests below sanitizers:
#
#   source scripts/lib/long_tests.sh
#   GTEST_FILTER=$without_long_tests ctest ...
#
# shellcheck shell=bash

long_tests=(
  # A shaft that runs down, is held or homed.
  '*Tmcc160Limits.*' '*HeavyWheel.*' '*TooLowASupply.*' '*Tmcc160Stop.*' '*Tmcc160Holding.*' '*Tmcc160ExamplesInMotion.*'
  '*Tmc8670Limits.*' '*Tmc8670Stop*.*' '*Tmc8670Homing.*' '*Tmcm3315Homing.*' '*FocHomingStops.*' '*FocHeavyHomingStops.*'
  'HomingMethods.*' 'HomingModeTest.WithoutAnEncoderAnIndexNeverComes' '*VelocityStream.*'
  # Heat, energy and numbers that grow.
  'DriverModule.AnOverheatedDriverIsSwitchedOffUntilItHasCooled' '*DriverFaults.*' 'Tmcm142Stage.*' '*EnergyBalance.*'
  'MechanicalLoad.AbsurdTorqueKeepsTheNumbersFinite'
  # Identification and tuning.
  'TuneCommand.*' 'TuningOfAStepper.*' '*TuningOf.*' 'TuningLoops.*'
  # Ramps by the million, programs by the thousand, a whole demonstration.
  'MotionControllerBow.*' 'SShapedRampProperties.*' 'Tmcm142ProgramTexts.*' '*FirmwareOrder.*'
  'CommandLine.DemoMovesThreeAxesAndDrawsThem'
)
# GoogleTest's filter: everything but these. Used by who sources this.
# shellcheck disable=SC2034
without_long_tests="-$(
  IFS=:
  printf '%s' "${long_tests[*]}"
)"
