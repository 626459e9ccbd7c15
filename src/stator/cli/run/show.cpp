#include "stator/cli/run/show.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdint>
#include <fstream>
#include <mutex>
#include <numbers>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "stator/cli/failure.hpp"
#include "stator/cli/run/show_files.hpp"
#include "stator/mfc/block/memory_map.hpp"
#include "stator/product/catalogue/io_configuration.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/file/rack_file_steps.hpp"

namespace stator::cli {

namespace {

using manual::AxisRecord;
using manual::Command;
using manual::CommandKind;
using manual::DeviceStatus;
using manual::ManualControl;
using manual::Phase;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

/// How often the show looks; well below manual::kJogHold, for which a velocity holds.
constexpr milliseconds kBeat{150};

std::optional<rack::DeviceAddress> find(const rack::Rack& rack, std::string_view name) {
  const auto addresses = rack.addresses();
  const auto found = std::ranges::find_if(
      addresses, [&](rack::DeviceAddress each) { return rack.name_of(each) == name; });
  return found != addresses.end() ? std::optional(*found) : std::nullopt;
}

/// A device in the show, as long as nobody else has it.
class Performer {
 public:
  Performer(ManualControl& control, std::optional<rack::DeviceAddress> device)
      : control_(control), device_(device) {}
  Performer(const Performer&) = delete;
  Performer& operator=(const Performer&) = delete;
  virtual ~Performer() = default;

  void beat(steady_clock::duration time) {
    if (!device_) {
      return;
    }
    const DeviceStatus status = control_.status(*device_);
    if (!begun_) {
      begun_ = true;
      sent_.assign(kMostAxes, 0);
      if (!control_.start(*device_)) {
        device_.reset();
      }
      return;
    }
    if (status.phase == Phase::starting) {
      return;
    }
    if (status.phase != Phase::active || somebody_else(status)) {
      device_.reset();
      return;
    }
    perform(status, std::chrono::duration<double>(time).count());
  }

 protected:
  /// What is due `time` seconds after the show's begin.
  virtual void perform(const DeviceStatus& status, double time) = 0;

  void send(std::size_t axis, const Command& command) {
    if (device_ && control_.command(*device_, axis, command)) {
      ++sent_[axis];
    }
  }
  /// Whether the axis is ready to move; has it enabled if it is not, now and then.
  bool ready(const DeviceStatus& status, std::size_t axis, double time) {
    const AxisRecord& record = status.axes[axis];
    if (!record.status.enabled && record.executed == sent_[axis] && time >= next_try_[axis]) {
      next_try_[axis] = record.status.fault ? time + kSecondsBetweenResets : 0.0;
      send(axis, {.kind = record.status.fault ? CommandKind::reset_fault : CommandKind::enable});
    }
    return record.status.enabled;
  }
  void jog(std::size_t axis, const AxisRecord& record, double revolutions_per_second) {
    if (record.description.units) {
      send(axis,
           {.kind = CommandKind::jog,
            .value = std::llround(revolutions_per_second * record.description.units->velocity)});
    }
  }
  void set_outputs(std::size_t offset, std::uint64_t value, std::size_t size) {
    std::vector<std::byte> bytes(size);
    for (std::size_t i = 0; i < size; ++i) {
      bytes[i] = static_cast<std::byte>(value >> (8 * i));
    }
    static_cast<void>(control_.set_outputs(*device_, offset, std::move(bytes)));
  }
  [[nodiscard]] rack::DeviceAddress device() const { return *device_; }

 private:
  static constexpr std::size_t kMostAxes = 8;
  static constexpr double kSecondsBetweenResets = 5.0;

  /// More was carried out than was sent from here.
  [[nodiscard]] bool somebody_else(const DeviceStatus& status) const {
    for (std::size_t i = 0; i < status.axes.size(); ++i) {
      if (status.axes[i].executed > sent_[i]) {
        return true;
      }
    }
    return false;
  }

  ManualControl& control_;
  std::optional<rack::DeviceAddress> device_;  ///< nothing: it is somebody else's, or not there
  bool begun_ = false;
  std::vector<std::uint64_t> sent_;
  std::array<double, kMostAxes> next_try_{};
};

/// Two axes draw a five-pointed star, a third one lifts the pen from time to time.
class Gantry final : public Performer {
 public:
  using Performer::Performer;

 private:
  static constexpr int kPoints = 5;
  static constexpr double kRadius = 3.0;  ///< revolutions
  static constexpr double kStroke = 1.5;  ///< seconds from point to point
  static constexpr double kLift = 1.0;    ///< revolutions

  void perform(const DeviceStatus& status, double time) override {
    constexpr std::size_t kAxes = 3;
    bool all = status.axes.size() >= kAxes;
    for (std::size_t i = 0; all && i < kAxes; ++i) {
      all = ready(status, i, time) && all;
    }
    if (!all || time < next_) {
      return;
    }
    next_ = time + kStroke;
    // Each stroke leaves one point out, which makes a star.
    point_ = (point_ + 2) % kPoints;
    const double angle = 2.0 * std::numbers::pi * point_ / kPoints;
    go(status, 0, kRadius * std::cos(angle));
    go(status, 1, kRadius * std::sin(angle));
    go(status, 2, point_ == 0 ? kLift : 0.0);
  }

  void go(const DeviceStatus& status, std::size_t axis, double revolutions) {
    const AxisRecord& record = status.axes[axis];
    if (!record.description.units) {
      return;
    }
    const double per_revolution = record.description.units->position;
    const double distance = std::abs(revolutions - record.status.position / per_revolution);
    // Both arrive together, in a part of the stroke.
    const double velocity = std::max(distance / (0.6 * kStroke), 0.1);
    send(axis,
         {.kind = CommandKind::move,
          .value = std::llround(revolutions * per_revolution),
          .velocity = static_cast<std::uint32_t>(velocity * record.description.units->velocity)});
  }

  double next_ = 0.0;
  int point_ = 0;
};

/// Turns to and fro; the servo also gets steps of its load.
class Turner final : public Performer {
 public:
  /// `load`: N m, at the input "axis0.load_torque"; 0: none.
  Turner(ManualControl& control, std::optional<rack::DeviceAddress> device,
         rack::RunningRack& running, double revolutions_per_second, double load)
      : Performer(control, device),
        running_(running),
        velocity_(revolutions_per_second),
        load_(load) {}

 private:
  static constexpr double kTurn = 4.0;  ///< seconds in one direction
  static constexpr double kStep = 1.0;  ///< seconds between steps of the load, from one on

  void perform(const DeviceStatus& status, double time) override {
    const bool turns = !status.axes.empty() && ready(status, 0, time);
    const bool back = std::fmod(time, 2.0 * kTurn) >= kTurn;
    const double velocity = back ? -0.5 * velocity_ : velocity_;
    if (turns) {
      jog(0, status.axes[0], velocity);
    }
    // Against the motion, and only while it is under way: nothing holds a motor without current.
    const double since_turn = std::fmod(time, kTurn);
    const bool braked = turns && since_turn >= kStep && since_turn < kTurn - kStep / 2.0 &&
                        std::fmod(since_turn, 2.0 * kStep) >= kStep;
    set_load(!braked ? 0.0 : back ? load_ : -load_);
  }

  void set_load(double torque) {
    if (torque == shown_) {
      return;
    }
    shown_ = torque;
    const std::scoped_lock lock(running_.mutex);
    running_.catch_up();
    running_.rack.apply(
        {rack::InputEvent{
            .device = device(), .input = "axis0.load_torque", .value = torque, .logged = false}},
        running_.reached);
  }

  rack::RunningRack& running_;
  double velocity_;
  double load_;
  double shown_ = 0.0;  ///< N m that the load has at present
};

/// A fan at changing speed and a lamp that blinks, behind a TMC8461.
class Board final : public Performer {
 public:
  Board(ManualControl& control, std::optional<rack::DeviceAddress> device,
        const mfc::MemoryMap& map)
      : Performer(control, device), map_(map) {}

 private:
  // 100 kHz, both half-bridges on; a duty of 1000 is full (TMC8461 data sheet section 7.9.6).
  static constexpr std::uint64_t kPwmConfiguration = 999U | 7U << 16U | 7U << 20U;
  static constexpr double kFullDuty = 1'000.0;
  static constexpr double kPeriod = 10.0;  ///< seconds

  void perform(const DeviceStatus& /*status*/, double time) override {
    const double swing = 0.4 * std::sin(2.0 * std::numbers::pi * time / kPeriod);
    put("PWM_CFG", kPwmConfiguration);
    put("PWM1", static_cast<std::uint64_t>((0.5 + swing) * kFullDuty));
    put("PWM2", static_cast<std::uint64_t>((0.5 - swing) * kFullDuty));
    put("GPIO_CONFIG", 1);  // the lamp's line is an output
    put("GPO", std::fmod(time, 1.0) < 0.5 ? 1U : 0U);
  }

  void put(std::string_view name, std::uint64_t value) {
    for (const mfc::MappedRegister& mapped : map_.registers(0)) {
      if (mfc::kRegisters[mapped.number].name == name) {
        set_outputs(mapped.address - map_.block(0).start, value, mapped.size);
      }
    }
  }

  mfc::MemoryMap map_;
};

/// Where the registers of the I/O board lie in its process data, by the file beside the rack file.
mfc::MemoryMap board_map(const rack::RackConfiguration& configuration,
                         std::optional<rack::DeviceAddress> board,
                         const std::filesystem::path& rack_file) {
  if (!board) {
    return {};
  }
  const auto io = configuration.segments[board->network]
                      .devices[board->device]
                      .setup.product()
                      .io_configuration();
  if (io == nullptr) {
    return {};
  }
  const std::string path = (rack_file.parent_path() / "../examples/mfc/io-board.toml").string();
  rack::read_tree(rack::parse_rack_tree(rack::read_rack_text(path), path), path,
                  "the configuration", [&](settings::Reader& root) { io->read(root); });
  return mfc::MemoryMap(io->block());
}

}  // namespace

class Show::Implementation {
 public:
  Implementation(ManualControl& control, rack::Runner& runner,
                 const rack::RackConfiguration& configuration,
                 const std::filesystem::path& rack_file) {
    rack::RunningRack& running = runner.running();
    const rack::Rack& rack = running.rack;
    constexpr double kServoVelocity = 10.0;
    constexpr double kServoLoad = 0.05;
    constexpr double kSpindleVelocity = 5.0;
    performers_.push_back(std::make_unique<Gantry>(control, find(rack, "gantry")));
    performers_.push_back(std::make_unique<Turner>(control, find(rack, "servo"), running,
                                                   kServoVelocity, kServoLoad));
    performers_.push_back(
        std::make_unique<Turner>(control, find(rack, "spindle"), running, kSpindleVelocity, 0.0));
    const auto board = find(rack, "io");
    performers_.push_back(
        std::make_unique<Board>(control, board, board_map(configuration, board, rack_file)));
    thread_ = std::jthread([this](const std::stop_token& over) { run(over); });
  }

 private:
  void run(const std::stop_token& over) {
    std::mutex mutex;
    std::unique_lock lock(mutex);
    std::condition_variable_any never;
    const auto begin = steady_clock::now();
    while (!over.stop_requested()) {
      for (const auto& each : performers_) {
        each->beat(steady_clock::now() - begin);
      }
      never.wait_for(lock, over, kBeat, [] { return false; });
    }
  }

  std::vector<std::unique_ptr<Performer>> performers_;
  std::jthread thread_;
};

Show::Show(manual::ManualControl& control, rack::Runner& runner,
           const rack::RackConfiguration& configuration, const std::filesystem::path& rack_file)
    : implementation_(std::make_unique<Implementation>(control, runner, configuration, rack_file)) {
}

Show::~Show() = default;

std::filesystem::path write_show_rack(const std::filesystem::path& directory) {
  for (const ShowFile& file : show_files()) {
    const std::filesystem::path path = directory / file.path;
    std::error_code error;
    std::filesystem::create_directories(path.parent_path(), error);
    std::ofstream out(path, std::ios::binary);
    out << file.text;
    if (!out.flush()) {
      throw Failure(
          fmt::format("cannot write {}; choose another directory with --output", path.string()));
    }
  }
  return directory / show_files().front().path;
}

}  // namespace stator::cli
