#include <array>
#include <cerrno>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "stator/cli/event_printer.hpp"
#include "stator/cli/failure.hpp"
#include "stator/cli/interruption.hpp"
#include "stator/cli/option_words.hpp"
#include "stator/cli/products.hpp"
#include "stator/cli/progress.hpp"
#include "stator/cli/temporary_csv.hpp"
#include "stator/cli/tmcl/program_files.hpp"
#include "stator/cli/tmcl/tmcl_bench_options.hpp"
#include "stator/cli/tmcl/tmcl_commands.hpp"
#include "stator/rack/observe/plot.hpp"
#include "stator/rack/observe/recorder.hpp"
#include "stator/tmcl_tools/tmcl_bench.hpp"
#include "stator/tmcl_tools/tmcl_profile.hpp"
#include "stator/tmcl_tools/tmcl_source.hpp"
#include "stator/tmcl_tools/tmcl_trace.hpp"

namespace stator::cli {

namespace {

/// What a person wants to see first of a motion.
std::vector<std::string> usual_signals() {
  return {"*position_actual", "*velocity_actual"};
}

struct RunOptions : TmclBenchOptions {
  std::string limit = "60s";
  std::string trace;
  bool changes_only = false;
  std::vector<std::string> signals;
  std::string record;
  std::string period = "1ms";
  std::string plot;
  bool profile = false;
};

struct FileCloser {
  void operator()(std::FILE* file) const {
    if (file != nullptr && file != stdout) {
      static_cast<void>(std::fclose(file));
    }
  }
};
using File = std::unique_ptr<std::FILE, FileCloser>;

[[noreturn]] void cannot_write(const std::string& path) {
  throw Failure(
      fmt::format("cannot write {}: {}; choose a file in a directory that exists and "
                  "can be written",
                  path, std::generic_category().message(errno)));
}

File open_for_writing(const std::string& path) {
  if (path == "-") {
    return File(stdout);
  }
  File file(std::fopen(path.c_str(), "w"));
  if (file == nullptr) {
    cannot_write(path);
  }
  return file;
}

/// Panels of the signals in `csv`, one for each unit.
void draw(const RunOptions& options, const std::vector<product::Signal>& signals,
          const std::string& csv, std::uint64_t rows) {
  constexpr std::array kColours{"#1f77b4", "#d1495b", "#2a9d5c", "#e08e0b", "#8d99a6"};
  rack::Plot plot;
  plot.title = options.program;
  plot.csv_path = csv;
  plot.rows = rows;
  plot.legend = rack::Plot::Legend::above;
  std::map<std::string, std::size_t> panel_of_unit;
  int column = 1;
  for (const product::Signal& signal : signals) {
    const auto [place, added] = panel_of_unit.try_emplace(signal.unit, plot.panels.size());
    if (added) {
      plot.panels.emplace_back().label = signal.unit.empty() ? "number" : signal.unit;
    }
    auto& curves = plot.panels[place->second].curves;
    rack::PlotCurve curve;
    curve.column = ++column;
    curve.title = signal.name;
    curve.colour = kColours[curves.size() % kColours.size()];
    curves.push_back(std::move(curve));
  }
  rack::draw(plot, options.plot);
}

/// How the run ended, for people.
std::string ending(const tmcl_tools::TmclBench& bench, const tmcl_tools::TmclSource& source,
                   bool interrupted) {
  const auto counter = bench.firmware().state().program_counter;
  if (!bench.running()) {
    return fmt::format("the program stopped at {} after {} s and {} instructions",
                       source.place_of(counter), tmcl_tools::seconds_text(bench.now()),
                       bench.executed());
  }
  return fmt::format("{} after {} s and {} instructions; the program is at {}: {}",
                     interrupted ? "interrupted" : "ended", tmcl_tools::seconds_text(bench.now()),
                     bench.executed(), source.place_of(counter), source.command_at(counter));
}

/// Until the program stops or time is up, saying how far that is. True: interrupted.
bool run_program(tmcl_tools::TmclBench& bench, base::SimTime limit, Progress* progress) {
  constexpr unsigned kStepsBetweenLooks = 1000;
  const Interruption interruption;
  for (unsigned steps = 0; bench.running() && bench.advance_to_next(limit); ++steps) {
    if (steps % kStepsBetweenLooks != 0) {
      continue;
    }
    if (interruption.taken()) {
      return true;
    }
    if (progress != nullptr) {
      progress->reached(bench.now().seconds() / limit.seconds());
    }
  }
  return false;
}

/// A run with all that looks on.
class ProgramRun {
 public:
  explicit ProgramRun(const RunOptions& options)
      : options_(options),
        source_(tmcl_tools::load_tmcl_source(options.program, tmcl_module(options.device),
                                             program_files())),
        bench_(make_tmcl_module(options, base::EventReporter(&events_, 0))),
        limit_(duration_of("--for", options.limit)),
        signals_(rack::select_signals(bench_.device().signals(), options.signals.empty()
                                                                     ? usual_signals()
                                                                     : options.signals)) {
    for (const tmcl_tools::InputChange& change : input_changes(options)) {
      if (change.time == base::SimTime()) {
        bench_.set_input(change.input, change.value);
      } else {
        bench_.schedule(change);
      }
    }
    begin_trace();
    begin_recording();
    if (options.profile) {
      bench_.observe(profile_.emplace(source_.module(), bench_.now()));
    }
  }

  void run() {
    bench_.start(source_.program().instructions);
    const bool interrupted = run_to_the_end();
    bench_.record(nullptr);
    end_trace();
    fmt::print(stderr, "{}\n", ending(bench_, source_, interrupted));
    if (profile_) {
      fmt::print("{}", profile_->text(source_));
    }
    end_recording();
  }

 private:
  bool run_to_the_end() {
    if (options_.trace == "-") {
      return run_program(bench_, limit_, nullptr);  // the trace tells how far it is
    }
    Progress progress(fmt::format("running {}", options_.program));
    events_.stand_beside(&progress);
    const bool interrupted = run_program(bench_, limit_, &progress);
    events_.stand_beside(nullptr);
    return interrupted;
  }

  void begin_trace() {
    if (options_.trace.empty()) {
      return;
    }
    trace_file_ = open_for_writing(options_.trace);
    trace_.emplace(trace_file_.get(), source_, signals_,
                   tmcl_tools::TraceOptions{.csv = options_.trace.ends_with(".csv"),
                                            .changes_only = options_.changes_only});
    bench_.observe(*trace_);
  }

  void end_trace() {
    if (trace_ && (std::fflush(trace_file_.get()) != 0 || !trace_->good())) {
      cannot_write(options_.trace);
    }
  }

  void begin_recording() {
    if (options_.record.empty() && options_.plot.empty()) {
      return;
    }
    csv_ = options_.record.empty() ? temporary_.emplace(options_.plot).path() : options_.record;
    bench_.record(
        &recorder_.emplace(csv_, signals_, duration_of("--record-period", options_.period)));
  }

  void end_recording() {
    if (!recorder_) {
      return;
    }
    const std::uint64_t rows = recorder_->rows();
    recorder_->output().finish();
    if (!recorder_->output().complete()) {
      throw Failure(fmt::format("recording {} is not complete: {}", csv_,
                                recorder_->output().what_is_missing("rows")));
    }
    if (!options_.plot.empty()) {
      draw(options_, signals_, csv_, rows);
    }
  }

  const RunOptions& options_;
  EventPrinter events_;
  tmcl_tools::TmclSource source_;
  tmcl_tools::TmclBench bench_;
  base::SimTime limit_;
  std::vector<product::Signal> signals_;
  File trace_file_;
  std::optional<tmcl_tools::TmclTrace> trace_;
  std::optional<tmcl_tools::TmclProfile> profile_;
  std::optional<TemporaryCsv> temporary_;
  std::string csv_;
  std::optional<rack::Recorder> recorder_;
};

}  // namespace

void add_tmcl_run_command(CLI::App& app) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command =
      app.add_subcommand("run", "Run a program on a module of its own in simulated time");
  add_program_options(*command, *options);
  command->add_option("--for", options->limit, "Simulated time after which the run ends")
      ->capture_default_str();
  CLI::Option* trace = command->add_option(
      "--trace", options->trace,
      "File for one line per instruction, as CSV if it ends so; - is standard output");
  command
      ->add_flag("--trace-changes", options->changes_only,
                 "Leave out of the trace what polling loops repeat without effect")
      ->needs(trace);
  command->add_option("--plot", options->plot, "Picture of signals to draw, .svg or .png")
      ->check(names(Names::file));
  command->add_option("--record", options->record, "Write signals to this CSV file")
      ->check(names(Names::file));
  command
      ->add_option("--record-period", options->period,
                   "Simulated time between two rows of recording and plot")
      ->capture_default_str();
  command
      ->add_option("--signals", options->signals,
                   "Signals to trace, plot and record, e.g. \"axis0.*\"; position and velocity if "
                   "left out")
      ->allow_extra_args(false);
  command->add_flag("--profile", options->profile,
                    "Print how often instructions and subroutines ran and how long they took");
  command->footer(
      "The run ends when the program stops. What it waits for can be set with --input and --at.\n"
      "Examples:\n"
      "  stator tmcl run examples/tmcl/test_program.tmc --trace - --plot moves.svg\n"
      "  stator tmcl run examples/tmcl/watchdog.tmc --for 20s --profile");
  command->callback([options] { ProgramRun(*options).run(); });
}

}  // namespace stator::cli
