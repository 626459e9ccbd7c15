#pragma once

#include <atomic>
#include <cstdint>
#include <list>
#include <string>
#include <utility>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/link/system/background_output.hpp"

namespace stator::rack {

class EventLog;

/// All that is written while a rack runs: recordings, captures, logs, traces. None of it may stop
/// who answers frames, and what is missing in one has to be said.
///
/// Without a master in real time (lockstep, replays, scenarios) a file is complete: the rack waits
/// for it, and simulated time with it. With the machine's clock nobody waits, and what finds no
/// room is lost. An event tells of the first loss of each and of each that cannot be written.
class OutputFiles {
 public:
  /// What people are told of an output.
  struct Description {
    std::string name;             ///< "recording run.csv"
    std::string records;          ///< what is in it: "rows"
    std::uint16_t device = 0;     ///< whose event it is
    bool ends_at_loss = false;    ///< it has no gaps, but breaks off
    bool always_waits = false;    ///< its writer may wait: it is no thread that answers masters
    bool wanted_complete = true;  ///< false: finish() does not report what is missing
  };

  explicit OutputFiles(EventLog& log) : log_(log) {}

  /// `output` is looked after until it is removed. Not while threads run.
  void add(link::BackgroundOutput& output, Description description);
  void remove(const link::BackgroundOutput& output);

  /// From now on writers lose what finds no room instead of waiting, also those of outputs added
  /// later, except where always_waits says otherwise.
  void lose_rather_than_wait();

  // From any thread, also while another one waits in one of the files.

  /// The run is being ended: writers that wait for a file that does not move give up soon.
  void stop_waiting();
  /// A loss or failure has begun that look() has not reported. Costs next to nothing.
  [[nodiscard]] bool have_news() const;
  /// Reports such losses and failures as events; costs as little when there are none.
  void look(base::SimTime now);

  /// Closes the files, one sentence for each that is incomplete; not while others write. `asked`:
  /// when the end was asked for, from which on waiting is limited
  /// (link::BackgroundOutput::drain()).
  [[nodiscard]] std::vector<std::string> finish(
      link::BackgroundOutput::Clock::time_point asked = link::BackgroundOutput::Clock::now());

  /// Calls `look(description, output)` for each.
  template <typename Look>
  void visit(Look look) const {
    for (const File& file : files_) {
      look(file.description, std::as_const(*file.output));
    }
  }

 private:
  struct File {
    File(link::BackgroundOutput& written, Description said)
        : output(&written), description(std::move(said)) {}
    link::BackgroundOutput* output;
    Description description;
    std::atomic<bool> reported{false};  ///< of the first loss
    std::atomic<bool> failed{false};    ///< and that it ends

    [[nodiscard]] bool has_news() const {
      return output->in_trouble() && !failed && (!reported || output->error());
    }
  };

  void tell(File& file, base::SimTime now);
  void report(const File& file, base::SimTime now, const base::EventRule& rule,
              const std::string& text);

  EventLog& log_;
  std::list<File> files_;
  bool loses_ = false;
};

}  // namespace stator::rack
