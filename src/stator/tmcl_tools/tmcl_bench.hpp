#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/product/device/device.hpp"
#include "stator/rack/observe/recorder.hpp"
#include "stator/tmcl/interpreter/firmware.hpp"
#include "stator/tmcl/interpreter/program_observer.hpp"

namespace stator::tmcl_tools {

/// A complete module without interfaces, as it is after switching on at time 0.
struct TmclModule {
  std::unique_ptr<product::Device> device;
  tmcl::Firmware* firmware = nullptr;  ///< of `device`
};

/// Something around the module is set at a moment.
struct InputChange {
  base::SimTime time;
  std::string input;  ///< as Device::inputs() names it
  double value = 0.0;
};

/// "NAME=VALUE" at `time`. Throws Failure.
[[nodiscard]] InputChange parse_input_change(const std::string& text, base::SimTime time);

/// Where a module runs in simulated time for those who look at its program: as fast as the machine
/// goes, from one moment at which something happens to the next.
class TmclBench {
 public:
  explicit TmclBench(TmclModule module);
  TmclBench(const TmclBench&) = delete;
  TmclBench& operator=(const TmclBench&) = delete;
  ~TmclBench();

  [[nodiscard]] base::SimTime now() const { return now_; }
  [[nodiscard]] product::Device& device() const { return *module_.device; }
  [[nodiscard]] tmcl::Firmware& firmware() const { return *module_.firmware; }

  /// Puts `program` into the memory and starts it from its first command on.
  void start(std::span<const tmcl::Instruction> program);
  /// The program runs or is held by a WAIT.
  [[nodiscard]] bool running() const;

  /// Is told of every instruction; it must outlive the bench.
  void observe(tmcl::ProgramObserver& observer) { fan_.observers.push_back(&observer); }
  /// Instructions executed so far.
  [[nodiscard]] std::uint64_t executed() const { return fan_.executed_count; }

  /// Throws Failure naming the inputs there are, or the range.
  void check(const std::string& input, double value);
  /// Sets an input now. Throws as check() does.
  void set_input(const std::string& input, double value);
  /// Has an input set once its time comes, after what the program does at that moment. Throws as
  /// check() does.
  void schedule(const InputChange& change);
  /// Samples what `recorder` wants; null: none. It must outlive the bench or be taken off.
  void record(rack::Recorder* recorder) { recorder_ = recorder; }

  /// Lets time go on to the next moment at which an instruction is due, an input changes or a
  /// sample is taken, to `limit` at most. False: `limit` is the present.
  bool advance_to_next(base::SimTime limit);
  void advance_to(base::SimTime moment);

 private:
  struct Fan final : tmcl::ProgramObserver {
    void executed(const tmcl::ProgramStep& step, const tmcl::Registers& registers) override {
      ++executed_count;
      for (tmcl::ProgramObserver* each : observers) {
        each->executed(step, registers);
      }
    }
    std::vector<tmcl::ProgramObserver*> observers;
    std::uint64_t executed_count = 0;
  };

  void sample_what_is_due();

  TmclModule module_;
  std::vector<product::Input> inputs_;
  std::vector<product::InputRange> ranges_;  ///< of the inputs
  Fan fan_;
  base::SimTime now_;
  std::vector<InputChange> changes_;  ///< the next one last
  rack::Recorder* recorder_ = nullptr;
};

/// Makes a module anew. Throws Failure if there is none.
using MakeTmclModule = std::function<TmclModule()>;

}  // namespace stator::tmcl_tools
