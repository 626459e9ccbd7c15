#include "stator/cli/run/live_session.hpp"

#include <algorithm>
#include <csignal>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "stator/cli/failure.hpp"
#include "stator/rack/core/command.hpp"

namespace stator::cli {

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
  return {.file = recorder_->path(),
          .time = recorder_->time(),
          .bytes = recorder_->bytes(),
          .complete = recorder_->broken_off() == base::SimTime::never()};
}

std::vector<web::SessionControl::Snapshot> LiveSession::snapshots() {
  std::vector<Snapshot> all;
  for (const replay::Mark& mark : recorder_->marks()) {
    all.push_back({mark.name, mark.time});
  }
  return all;
}

bool LiveSession::take_snapshot(const std::string& name) {
  if (std::ranges::find(recorder_->marks(), name, &replay::Mark::name) !=
      recorder_->marks().end()) {
    return false;
  }
  recorder_->mark(name);
  return recorder_->broken_off() == base::SimTime::never();
}

bool LiveSession::restore(const std::string& name) {
  if (std::ranges::find(recorder_->marks(), name, &replay::Mark::name) ==
      recorder_->marks().end()) {
    return false;
  }
  const std::scoped_lock lock(mutex_);
  wished_ = RecordingPlace{.path = recorder_->path(), .mark = name, .state = state_};
  ::kill(::getpid(), SIGUSR1);  // ends the wait for the end of the run
  return true;
}

std::optional<RecordingPlace> LiveSession::wished() {
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
    if (configuration.buses[i].ports.size() != count) {
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
