// Moments of a rack, and bringing it back to one of them.
#include <algorithm>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "session.hpp"
#include "stator/replay/player.hpp"
#include "stator/replay/recording_reader.hpp"

namespace stator::python {

namespace {

/// Of simulated time that is played at once, so that samples find room.
constexpr base::SimDuration kSlice{100'000'000};

/// The file beside `path` that has none yet: "run-2.stator", "run-3.stator".
std::string next_to(const std::string& path) {
  const std::filesystem::path file(path);
  std::string stem = file.stem().string();
  const std::size_t dash = stem.rfind('-');
  if (dash != std::string::npos && dash + 1 < stem.size() &&
      stem.find_first_not_of("0123456789", dash + 1) == std::string::npos) {
    stem.resize(dash);
  }
  for (unsigned number = 2;; ++number) {
    const std::filesystem::path next =
        file.parent_path() / fmt::format("{}-{}{}", stem, number, file.extension().string());
    if (!std::filesystem::exists(std::filesystem::symlink_status(next))) {
      return next.string();
    }
  }
}

}  // namespace

/// The recording of a session, played on the rack that is made anew up to a moment.
class Session::Replayed final : public bench::Bench::Past {
 public:
  /// Throws std::runtime_error if the recording cannot be read.
  Replayed(Session& session, const Moment& moment)
      : session_(session), moment_(moment), reader_(moment.recording) {}

  /// Records the new way in this file; before play().
  void record(std::string path) { path_ = std::move(path); }

  void play(rack::Rack& rack) override {
    ++session_.generation_;
    session_.all_signals_.clear();
    if (!path_.empty()) {
      replay::RecordingHeader header = reader_.header();
      header.version = replay::kFormatVersion;
      session_.recorder_.emplace(rack, path_, std::move(header));
      session_.recording_ = true;
      session_.keep_file();
    }
    session_.sample();
    player_.emplace(reader_, rack, session_.bench_->configuration());
    for (base::SimTime end; !player_->at_mark(); end += kSlice) {
      if (const auto difference = player_->play(end, moment_.name)) {
        throw std::runtime_error(fmt::format("at {:.9f} s {} is {} and was {}",
                                             difference->time.seconds(), difference->place,
                                             difference->got, difference->expected));
      }
      if (session_.signals_) {
        session_.signals_->take();
      }
      if (!player_->at_mark() && !player_->reached()) {
        throw std::runtime_error(fmt::format("{} ends at {:.9f} s, before the moment: {}",
                                             moment_.recording, player_->now().seconds(),
                                             reader_.damage()));
      }
    }
  }
  std::unique_ptr<rack::BusPort> take_port(std::size_t bus, std::size_t number) override {
    return player_->take_port(bus, number);
  }
  void end() override {
    for (const std::weak_ptr<Guest>& each : session_.guests_) {
      if (const std::shared_ptr<Guest> guest = each.lock()) {
        guest->recall(memory_of(guest), *this);
      }
    }
    player_.reset();
  }
  /// Lets go of a rack that did not come back.
  void drop() { player_.reset(); }

 private:
  [[nodiscard]] std::any memory_of(const std::shared_ptr<Guest>& guest) const {
    const auto known = std::ranges::find_if(
        moment_.guests, [&guest](const auto& each) { return each.first.lock() == guest; });
    return known == moment_.guests.end() ? std::any() : known->second;
  }

  Session& session_;
  const Moment& moment_;
  std::string path_;
  replay::RecordingReader reader_;
  std::optional<replay::Player> player_;
};

void Session::keep_file() {
  if (folder_) {
    kept_file_ = {new std::string(recorder_->path()), [](const std::string* path) {
                    std::error_code error;
                    std::filesystem::remove(*path, error);
                    delete path;  // NOLINT: the pointer owns it
                  }};
  }
}

Moment Session::snapshot(std::string name) {
  bench::Bench& bench = this->bench();
  if (!recording_) {
    throw std::runtime_error(
        "the rack is not recorded, so it cannot be brought back; make it with rewindable=True, or "
        "recording=\"run.stator\"");
  }
  if (name.empty()) {
    name = fmt::format("moment-{}", ++moments_);
  }
  mark(name);
  Moment moment{.name = std::move(name),
                .time = bench.now(),
                .recording = recorder_->path(),
                .session = this,
                .masters = bench.remember(),
                .kept_file = kept_file_};
  for (const std::weak_ptr<Guest>& each : guests_) {
    if (const std::shared_ptr<Guest> guest = each.lock()) {
      moment.guests.emplace_back(each, guest->remember());
    }
  }
  return moment;
}

void Session::rewind(const Moment& moment) {
  if (moment.session != this) {
    throw std::runtime_error(fmt::format("the moment \"{}\" is of another rack", moment.name));
  }
  if (paced()) {
    throw std::runtime_error(
        "time follows the machine's clock; stop() that before the rack is brought back");
  }
  static_cast<void>(replay::RecordingReader(moment.recording));  // it is still there
  const std::string present = recorder_->path();
  const bool goes_on = recording_;
  if (const std::string incomplete = finish_recording(); !incomplete.empty() &&
                                                         present == moment.recording &&
                                                         recorder_->broken_off() <= moment.time) {
    throw std::runtime_error(incomplete + ", so the rack cannot be brought back");
  }
  Replayed past(*this, moment);
  if (goes_on) {
    past.record(next_to(present));
  }
  signals_.reset();
  recorder_.reset();
  for (const std::weak_ptr<Guest>& each : guests_) {
    if (const std::shared_ptr<Guest> guest = each.lock()) {
      guest->step_aside();
    }
  }
  try {
    bench_->rewind(*moment.masters, past);
  } catch (const std::exception& error) {
    past.drop();
    closed_ = true;
    signals_.reset();
    static_cast<void>(finish_recording());
    recorder_.reset();
    bench_.reset();
    throw std::runtime_error(fmt::format(
        "the rack cannot be brought back to \"{}\" and is closed: {}", moment.name, error.what()));
  }
}

}  // namespace stator::python
