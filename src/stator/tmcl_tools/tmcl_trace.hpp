#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "stator/product/device/signal.hpp"
#include "stator/tmcl/interpreter/program_observer.hpp"
#include "stator/tmcl_tools/tmcl_source.hpp"

namespace stator::tmcl_tools {

/// Flags of the registers that are set, as JC names them: "ZE EQ ETO".
[[nodiscard]] std::string flags_text(const tmcl::Registers& registers);

/// Simulated time in seconds to the microsecond, from integers.
[[nodiscard]] std::string seconds_text(base::SimTime time);

struct TraceOptions {
  bool csv = false;  ///< else columns for people
  /// Leaves out what polling loops repeat: an instruction that ended as it did the last time, if no
  /// WAIT has held the program since.
  bool changes_only = false;
};

/// Writes one line for each instruction that was executed: time, address, line of the text,
/// command, accumulator, X register, flags and status after it, and the values of some signals.
class TmclTrace final : public tmcl::ProgramObserver {
 public:
  /// `file` and `source` must outlive the trace. Writes the heading.
  TmclTrace(std::FILE* file, const TmclSource& source, std::vector<product::Signal> signals,
            const TraceOptions& options);

  void executed(const tmcl::ProgramStep& step, const tmcl::Registers& registers) override;

  /// False after a write failed.
  [[nodiscard]] bool good() const { return good_; }

 private:
  /// How an instruction ended when it was executed last.
  struct Outcome {
    std::uint64_t era = 0;  ///< count of WAITs until then; 0: it was not executed yet
    tmcl::Instruction instruction;
    tmcl::Registers registers;
    tmcl::Status status = tmcl::Status::success;

    friend bool operator==(const Outcome&, const Outcome&) = default;
  };

  [[nodiscard]] bool repeats(const tmcl::ProgramStep& step, const tmcl::Registers& registers);
  void write(const std::string& row);

  std::FILE* file_;
  const TmclSource& source_;
  std::vector<product::Signal> signals_;
  TraceOptions options_;
  std::size_t command_width_ = 20;
  std::vector<Outcome> outcomes_;  ///< by address
  std::uint64_t era_ = 1;
  bool good_ = true;
};

}  // namespace stator::tmcl_tools
