#include "session.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "stator/rack/observe/recorder.hpp"
#include "stator/settings/words.hpp"

namespace stator::python {

namespace {

using Clock = std::chrono::steady_clock;

/// How often who waits for time to pass looks whether it has, and whether Ctrl-C was pressed.
constexpr std::chrono::milliseconds kLook{1};
/// Of the machine's time that a bench passes at once; then others may hold the rack, and signals
/// are looked for.
constexpr std::chrono::milliseconds kSlice{20};
constexpr int kCyclesPerLook = 16;
/// Of the machine's time that somebody waits for something, so that ends of waits can be counted.
constexpr std::chrono::hours kLongestWait{24 * 365};

/// Where lines of a rack on links go: what events say is read by who asks for them.
class NoLog final : public rack::Log {
 public:
  void write(Level /*level*/, std::string_view /*line*/) override {}
};

bool interrupted() {
  const nanobind::gil_scoped_acquire interpreter;
  return PyErr_CheckSignals() != 0;
}

}  // namespace

base::SimDuration duration_of(double seconds, const char* what) {
  constexpr double kMost = 9.2e9;
  if (!(seconds >= 0.0) || seconds > kMost) {
    throw std::runtime_error(
        fmt::format("{} is {} s; it must lie in 0 .. {:g} s", what, seconds, kMost));
  }
  return base::SimDuration(std::llround(seconds * 1e9));
}

Session::Holding::Holding(Session& session) : session_(session), lock_(session.mutex_) {
  if (session_.closed_) {
    throw std::runtime_error("the rack is closed");
  }
  if (session_.runner_) {
    session_.runner_->running().mutex.lock();
    session_.runner_->running().catch_up();
  }
}

Session::Holding::~Holding() {
  if (session_.signals_) {
    session_.signals_->take();
  }
  if (session_.runner_) {
    session_.runner_->running().mutex.unlock();
  }
  lock_.unlock();
  session_.changed_.notify_all();
}

Session::Session(Source source, rack::RackConfiguration configuration, const Options& options)
    : source_(std::move(source)),
      sampled_(options.signals),
      sampling_period_(options.period),
      configuration_(std::move(configuration)),
      failure_(options.failure) {
  if (!options.links) {
    bench_.emplace(configuration_, options.limit);
    bench_->rack().set_journal(&untouched_);
    if (!options.recording.empty()) {
      begin_recording(options.recording);
    } else if (options.rewindable) {
      folder_.emplace();
      begin_recording((folder_->path() / "way.stator").string());
    }
    sample();
    return;
  }
  if (options.rewindable) {
    throw std::runtime_error(
        "a rack on links cannot be brought back, its masters are outside; make it without "
        "rewindable=True, and with recording=\"run.stator\", from which \"stator run --restore\" "
        "goes "
        "on");
  }
  configuration_.clock = rack::ClockKind::real;
  std::optional<replay::RecordingHeader> header;
  if (!options.recording.empty()) {
    header = header_of(source_, configuration_, true);  // kept files are those of power-on
  }
  log_ = std::make_unique<rack::EventLog>();
  rack_ = std::make_unique<rack::Rack>(configuration_, *log_);
  if (header) {
    recorder_.emplace(*rack_, options.recording, std::move(*header));
    recording_ = true;
  }
  runner_ = std::make_unique<rack::Runner>(*rack_, configuration_, std::make_shared<NoLog>());
  sample();
  runner_->start();
  pacing_ = true;
  pacing_thread_ = std::thread([this] { keep_samples(); });
}

// Threads that end may be in a device's function of Python, for which they need the interpreter.
Session::~Session() {
  if (PyGILState_Check() != 0) {
    const nanobind::gil_scoped_release released;
    static_cast<void>(close());
  } else {
    static_cast<void>(close());
  }
}

void Session::sample() {
  if (sampled_.empty()) {
    return;
  }
  if (sampling_period_ <= base::SimDuration()) {
    throw std::runtime_error("the period of recorded signals must be longer than 0 s");
  }
  signals_.emplace(rack(), rack::select_signals(all_signals(), sampled_), sampling_period_,
                   base::SimTime());
}

void Session::admit(const std::shared_ptr<Guest>& guest) {
  std::erase_if(guests_, [](const std::weak_ptr<Guest>& each) { return each.expired(); });
  guests_.push_back(guest);
}

std::string Session::close() {
  stop_pacing();
  const std::scoped_lock lock(mutex_);
  if (closed_.exchange(true)) {
    return {};
  }
  changed_.notify_all();
  if (runner_) {
    runner_->stop();
  }
  for (const std::weak_ptr<Guest>& each : guests_) {
    if (const std::shared_ptr<Guest> guest = each.lock()) {
      guest->leave();
    }
  }
  std::string incomplete = finish_recording();
  signals_.reset();
  runner_.reset();
  recorder_.reset();
  folder_.reset();
  rack_.reset();
  log_.reset();
  bench_.reset();
  return incomplete;
}

void Session::record(const std::string& path) {
  if (recording_ && !folder_) {
    throw std::runtime_error(fmt::format(
        "the rack is recorded into {} already; end_recording() ends that", recorder_->path()));
  }
  if (has_links() || recorder_ || !untouched_.untouched()) {
    throw std::runtime_error(fmt::format(
        "a recording begins at power-on, before anything is done to the rack, which is at {:g} s; "
        "make the rack with recording=\"{}\", or call record() first",
        now().seconds(), path));
  }
  begin_recording(path);
}

void Session::begin_recording(const std::string& path) {
  recorder_.emplace(bench_->rack(), path, header_of(source_, bench_->configuration(), false));
  recording_ = true;
  keep_file();
}

void Session::mark(const std::string& name) {
  if (!recording_) {
    throw std::runtime_error(
        "the rack is not recorded; make it with recording=\"run.stator\" to give moments names");
  }
  if (name.empty() || std::ranges::any_of(recorder_->marks(), [&name](const replay::Mark& each) {
        return each.name == name;
      })) {
    throw std::runtime_error(name.empty() ? std::string("the name of a moment is empty")
                                          : fmt::format("there is a moment \"{}\" in {} already",
                                                        name, recorder_->path()));
  }
  recorder_->mark(name);
}

void Session::end_recording() {
  if (!recording_) {
    throw std::runtime_error("the rack is not recorded, or its recording has ended");
  }
  if (const std::string incomplete = finish_recording(); !incomplete.empty()) {
    throw std::runtime_error(incomplete);
  }
}

std::string Session::finish_recording() {
  if (!std::exchange(recording_, false)) {
    return {};
  }
  recorder_->finish();
  if (recorder_->broken_off() == base::SimTime::never()) {
    return {};
  }
  return fmt::format("the recording {} ends at {:.3f} s, because the disk was too slow or is full",
                     recorder_->path(), recorder_->broken_off().seconds());
}

// Who only asks tells nobody, or two that wait would wake each other for ever. What threads of a
// runner bring tells nobody either, so it is looked for.
bool Session::wait_until(const std::function<bool()>& reached, std::chrono::nanoseconds duration) {
  const auto end = Clock::now() + std::min<std::chrono::nanoseconds>(duration, kLongestWait);
  const auto asked = [this, &reached] {
    if (!runner_) {
      return reached();
    }
    const std::scoped_lock running(runner_->running().mutex);
    runner_->running().catch_up();
    return reached();
  };
  std::unique_lock lock(mutex_);
  while (!closed_) {
    if (asked()) {
      return true;
    }
    const auto now = Clock::now();
    if (now >= end) {
      return false;
    }
    changed_.wait_until(lock, runner_ ? std::min(end, now + kLook) : end);
  }
  return false;
}

base::SimTime Session::now() {
  return bench_ ? bench_->now() : runner_->running().now();
}

bench::Bench& Session::bench() {
  if (!bench_) {
    throw std::runtime_error(
        "a rack on links has its masters outside; make it without links=True to have one here");
  }
  return *bench_;
}

const std::vector<product::Signal>& Session::all_signals() {
  if (all_signals_.empty()) {
    all_signals_ = rack().signals();
  }
  return all_signals_;
}

const product::Signal& Session::require_signal(const std::string& name) {
  const std::vector<product::Signal>& all = all_signals();
  const auto found = std::ranges::find(all, name, &product::Signal::name);
  if (found == all.end()) {
    throw std::runtime_error(fmt::format("there is no signal \"{}\"", name));
  }
  return *found;
}

void Session::wake() const {
  if (runner_) {
    runner_->wake();
  }
}

rack::DeviceAddress Session::require_device(const std::string& name) {
  std::set<std::string> names;
  for (const rack::DeviceAddress device : rack().addresses()) {
    if (rack().name_of(device) == name) {
      return device;
    }
    names.insert(rack().name_of(device));
  }
  throw std::runtime_error(fmt::format("there is no device \"{}\"{}; the devices are: {}", name,
                                       settings::guess_text(name, names), settings::joined(names)));
}

void Session::pass(base::SimDuration duration) {
  if (bench_ && !pacing_) {
    while (pass_slice(duration) && !interrupted()) {
      failure_->raise();
    }
    failure_->raise();
    return;
  }
  const base::SimTime end = held_without_interpreter([this] { return now(); }) + duration;
  while (!await(end) && !interrupted()) {
    failure_->raise();
  }
  failure_->raise();
}

// What other threads let pass between two slices is theirs.
bool Session::pass_slice(base::SimDuration& remaining) {
  return held_without_interpreter([this, &remaining] {
    const base::SimTime begin = bench_->now();
    const base::SimTime end = begin + remaining;
    const auto slice_ends = Clock::now() + kSlice;
    while (bench_->now() < end && Clock::now() < slice_ends) {
      for (int i = 0; i < kCyclesPerLook && bench_->now() < end; ++i) {
        bench_->cycle();
      }
      if (signals_) {
        signals_->take();
      }
    }
    remaining = end - bench_->now();
    return remaining > base::SimDuration();
  });
}

bool Session::await(base::SimTime end) {
  const auto slice_ends = Clock::now() + kSlice;
  while (held_without_interpreter([this] { return now(); }) < end) {
    if (Clock::now() >= slice_ends) {
      return false;
    }
    std::this_thread::sleep_for(kLook);
  }
  return true;
}

void Session::start_pacing(double speed) {
  if (!(speed > 0.0) || speed > 1000.0) {
    throw std::runtime_error(fmt::format("the speed is {}; it must lie in 0 .. 1000", speed));
  }
  held_without_interpreter([this] { static_cast<void>(bench()); });
  if (pacing_.exchange(true)) {
    throw std::runtime_error("the rack runs already; stop() it first");
  }
  pacing_thread_ = std::thread([this, speed] { pace(speed); });
}

void Session::stop_pacing() {
  {
    const std::scoped_lock lock(pacing_mutex_);
    pacing_ = false;
  }
  pacing_ends_.notify_all();
  if (pacing_thread_.joinable()) {
    pacing_thread_.join();
  }
}

// Lag is given up: a machine that was too slow for a while does not make up for it, as a rack on
// links does not.
void Session::pace(double speed) {
  constexpr base::SimDuration kWorstLag = rack::RunningRack::kWorstLag;
  auto began = Clock::now();
  base::SimTime from = held_without_interpreter([this] { return now(); });
  while (pacing_) {
    const std::chrono::duration<double, std::nano> passed = Clock::now() - began;
    const base::SimTime due = from + base::SimDuration(std::llround(passed.count() * speed));
    try {
      const base::SimTime reached = held_without_interpreter([this, due] {
        const auto slice_ends = Clock::now() + kLook;
        while (bench_->now() < due && Clock::now() < slice_ends) {
          bench_->cycle();
        }
        return bench_->now();
      });
      if (due - reached > kWorstLag) {
        began = Clock::now();
        from = reached;
      }
    } catch (const bench::TimeLimitReached&) {
      pacing_ = false;
      return;
    }
    std::unique_lock lock(pacing_mutex_);
    pacing_ends_.wait_for(lock, kLook, [this] { return !pacing_.load(); });
  }
}

void Session::keep_samples() {
  constexpr std::chrono::milliseconds kKeepingPeriod{20};
  while (pacing_) {
    held_without_interpreter([] {});
    std::unique_lock lock(pacing_mutex_);
    pacing_ends_.wait_for(lock, kKeepingPeriod, [this] { return !pacing_.load(); });
  }
}

}  // namespace stator::python
