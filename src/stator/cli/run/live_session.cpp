#include "stator/cli/run/live_session.hpp"

#include <algorithm>
#include <csignal>
#include <exception>
#include <fstream>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "stator/cli/failure.hpp"
#include "stator/rack/core/command.hpp"

namespace stator::cli {

namespace {

/// Ends the wait for the end of the run.
void wake() {
  ::kill(::getpid(), SIGUSR1);
}

}  // namespace

base::SimTime LiveSession::go_to(const RecordingPlace& from, RecordedRack& recorded,
                                 rack::Rack& rack, const rack::EventLog& log) {
  replay::Player player(recorded.reader(), rack, recorded.configuration());
  const replay::RecordingReader& reader = recorded.reader();
  if (const auto difference = player.play(from.time, from.mark)) {
    throw Failure(fmt::format("{} cannot be restored: {}", from.path, explain(*difference, log)));
  }
  if (!from.mark.empty() && !player.at_mark()) {
    throw Failure(fmt::format("there is no snapshot \"{}\" in {}", from.mark, from.path));
  }
  const bool timed = from.mark.empty() && from.time != base::SimTime::never();
  if (timed && !player.reached()) {
    throw Failure(fmt::format("{} ends at {:.6f} s already", from.path, player.now().seconds()));
  }
  if (reader.ending() == replay::RecordingEnding::damaged) {
    throw Failure(fmt::format("{} cannot be restored: {} ({:.6f} s); name a time before it",
                              from.path, reader.damage(), player.now().seconds()));
  }
  if (reader.ending() == replay::RecordingEnding::cut) {
    fmt::print("{}: {}\n", from.path, reader.damage());
  }
  rack.execute({rack::command::ReplacePorts{}});  // the player's go, those of the run come
  return player.now();
}

web::SessionControl::Recording LiveSession::recording() {
  if (!recorder_) {
    return {.running = false};
  }
  return {.file = recorder_->path(),
          .time = recorder_->time(),
          .bytes = recorder_->bytes(),
          .complete = recorder_->broken_off() == base::SimTime::never(),
          .running = !ended_};
}

std::vector<web::SessionControl::Snapshot> LiveSession::snapshots() {
  std::vector<Snapshot> all;
  if (!recorder_) {
    return all;
  }
  for (const replay::Mark& mark : recorder_->marks()) {
    all.push_back({mark.name, mark.time});
  }
  return all;
}

bool LiveSession::take_snapshot(const std::string& name) {
  if (!recording().running) {
    return false;
  }
  if (std::ranges::find(recorder_->marks(), name, &replay::Mark::name) !=
      recorder_->marks().end()) {
    return false;
  }
  recorder_->mark(name);
  return recorder_->broken_off() == base::SimTime::never();
}

bool LiveSession::restore(const std::string& name) {
  if (!recorder_ || std::ranges::find(recorder_->marks(), name, &replay::Mark::name) ==
                        recorder_->marks().end()) {
    return false;
  }
  const std::scoped_lock lock(mutex_);
  wished_ =
      NextRun{.from = RecordingPlace{.path = recorder_->path(), .mark = name, .state = state_}};
  wake();
  return true;
}

std::string LiveSession::start_recording(const std::string& name) {
  if (recording().running) {
    return recorder_->path() + " is being recorded; end that first";
  }
  const std::string path = name + ".stator";
  if (std::filesystem::exists(std::filesystem::symlink_status(path))) {
    return path + " exists; give the recording another name";
  }
  if (::access(".", W_OK) != 0) {
    return "the directory in which the program was started cannot be written to";
  }
  try {
    recordable_(path);
  } catch (const std::exception& error) {
    return error.what();
  }
  const std::scoped_lock lock(mutex_);
  wished_ = NextRun{.record = path};
  wake();
  return {};
}

bool LiveSession::stop_recording() {
  if (!recording().running) {
    return false;
  }
  recorder_->end();
  ended_ = true;
  return true;
}

std::string LiveSession::content(std::uint64_t from, std::size_t most) {
  std::string bytes;
  if (!recorder_) {
    return bytes;
  }
  std::ifstream file(recorder_->path(), std::ios::binary);
  if (file.seekg(static_cast<std::streamoff>(from))) {
    bytes.resize(most);
    file.read(bytes.data(), static_cast<std::streamsize>(most));
    bytes.resize(static_cast<std::size_t>(file.gcount()));
  }
  return bytes;
}

std::optional<NextRun> LiveSession::wished() {
  const std::scoped_lock lock(mutex_);
  return wished_;
}

std::string LiveSession::finish(link::BackgroundOutput::Clock::time_point asked) {
  if (!recorder_) {
    return {};
  }
  recorder_->finish(asked);
  fmt::print("{}: {:.3f} s recorded, {} bytes\n", recorder_->path(), recorder_->time().seconds(),
             recorder_->bytes());
  if (recorder_->broken_off() == base::SimTime::never()) {
    return {};
  }
  return fmt::format("the recording {} ends at {:.3f} s, because the disk was too slow or is full",
                     recorder_->path(), recorder_->broken_off().seconds());
}

std::filesystem::path state_for(const RecordingPlace& from, const RunOptions& given) {
  namespace fs = std::filesystem;
  fs::path state = from.state.empty() ? given.state : from.state;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(state, error)) {
    if (!entry.is_regular_file()) {
      continue;
    }
    if (from.state.empty()) {
      throw Failure(fmt::format(
          "--state {} has files, but the kept files are to be those of the recording; name an "
          "empty directory",
          given.state));
    }
    fs::remove(entry.path(), error);
  }
  return state;
}

void require_same_ports(const rack::RackConfiguration& configuration,
                        const rack::RackConfiguration& recorded) {
  for (std::size_t i = 0; i < configuration.buses.size(); ++i) {
    const std::size_t count = recorded.buses[i].ports.size();
    if (count != 0 && configuration.buses[i].ports.size() != count) {
      throw Failure(
          fmt::format("CAN bus {} had {} ports when it was recorded; name as many, not {}",
                      recorded.buses[i].name, count, configuration.buses[i].ports.size()));
    }
  }
}

RunOptions continued(RunOptions given, const RunOptions& recorded) {
  if (!given.rack_file.empty() || !given.device.empty() || !given.changes.empty()) {
    throw Failure("--restore takes the rack out of the recording; name none beside it");
  }
  if (!recorded.keeps_state && !given.state.empty()) {
    throw Failure("--state has no place here: the devices of the recording keep nothing in files");
  }
  given.keeps_state = recorded.keeps_state;
  given.rack_file = recorded.rack_file;
  given.device = recorded.device;
  given.count = recorded.count;
  given.no_emergencies = recorded.no_emergencies;
  given.spi = recorded.spi;
  given.serial = recorded.serial;
  given.changes = recorded.changes;
  given.bit_rate = recorded.bit_rate;
  const auto fill = [](auto& member, const auto& value) {
    if (member.empty()) {
      member = value;
    }
  };
  fill(given.link, recorded.link);
  fill(given.redundant, recorded.redundant);
  fill(given.ports, recorded.ports);
  fill(given.clock, recorded.clock);
  fill(given.state, recorded.state);
  return given;
}

}  // namespace stator::cli
