#include "stator/cli/master/cycle_report.hpp"

#include <fmt/format.h>

namespace stator::cli {

std::string cycles_text(const master::CycleStatistics& cycles) {
  constexpr double kMillisecond = 1e-3;
  const std::string lost =
      cycles.lost == 0 ? "0 lost"
                       : fmt::format("{} late or lost, {:.1f} ms without an answer at the longest",
                                     cycles.lost, cycles.longest_silence.seconds() / kMillisecond);
  return fmt::format("{} bus cycles, {}, {} with a wrong working counter", cycles.cycles, lost,
                     cycles.working_counter_errors);
}

}  // namespace stator::cli
