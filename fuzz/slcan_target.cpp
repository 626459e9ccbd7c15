// The adapter's end of slcan: any text in any pieces. What it takes off its input is there, frames
// are ones that can be on a bus, and every frame it writes it reads again as the same one.

#include "can_text.hpp"
#include "stator/link/can/slcan_session.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  stator::link::SlcanSession session(size % 2 == 0);
  stator::fuzz::feed(session, {data, size}, [](const stator::can::Frame& frame) {
    stator::link::SlcanSession writer(false);
    stator::link::SlcanSession reader(false);
    const auto now = stator::link::MachineTime();
    std::string answers;
    std::string line;
    stator::fuzz::require(writer.take("O\r", now, answers).consumed == 2);
    stator::fuzz::require(reader.take("O\r", now, answers).consumed == 2);
    stator::fuzz::require(writer.put(frame, {}, line));
    const auto again = reader.take(line, now, answers);
    stator::fuzz::require(again.consumed == line.size() && again.frame == frame);
  });
  return 0;
}
