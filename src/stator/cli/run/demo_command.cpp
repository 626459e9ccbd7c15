// stator demo: moves three axes of a drive and draws them, with master and slave in one process.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "stator/cli/commands.hpp"
#include "stator/cli/logging.hpp"
#include "stator/cli/master/cycle_report.hpp"
#include "stator/cli/master/master_session.hpp"
#include "stator/cli/option_words.hpp"
#include "stator/cli/products.hpp"
#include "stator/cli/progress.hpp"
#include "stator/cli/run/run_options.hpp"
#include "stator/cli/run/show.hpp"
#include "stator/master/cia402/cia402_client.hpp"
#include "stator/plant/axes/stepper_axis.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/observe/output_files.hpp"
#include "stator/rack/observe/plot.hpp"
#include "stator/rack/observe/recorder.hpp"

namespace stator::cli {

namespace {

constexpr double kMicrostepsPerRevolution = 51'200.0;

/// One axis' part in the demonstration, in revolutions.
struct DemoMove {
  double distance;
  double velocity;      ///< revolutions/s
  double acceleration;  ///< revolutions/s²
  std::string_view colour;

  [[nodiscard]] double duration() const {
    return std::abs(distance) / velocity + velocity / acceleration;
  }
};

constexpr std::array<DemoMove, 3> kMoves{{
    {10.0, 5.0, 10.0, "#1f77b4"},
    {-5.0, 3.0, 5.0, "#d1495b"},
    {7.5, 4.0, 20.0, "#2a9d5c"},
}};

/// The first product on EtherCAT with a stepper axis for every move.
std::shared_ptr<const product::Product> demo_product() {
  for (const auto& product : catalogue().products()) {
    product::Setup setup = product->defaults();
    const std::vector<product::AxisSetup> axes = setup.axes();
    if (product->identity().network == product::NetworkKind::segment &&
        axes.size() >= kMoves.size() &&
        std::ranges::all_of(axes, [](const auto& axis) { return axis.stepper != nullptr; })) {
      return product;
    }
  }
  throw Failure(fmt::format("no product on EtherCAT has {} stepper axes", kMoves.size()));
}

/// The demonstration's rack: one module whose axes carry different loads.
rack::RackConfiguration demo_rack(const product::Product& product, const std::string& csv) {
  rack::RackConfiguration configuration =
      rack::single_device_rack(product.identity().type, catalogue());
  rack::DeviceConfiguration& device = configuration.segments.front().devices.front();
  const std::vector<product::AxisSetup> axes = device.setup.axes();
  axes.at(1).stepper->load.inertia = 3e-5;
  axes.at(1).stepper->load.coulomb_friction = 0.02;
  axes.at(2).stepper->load.inertia = 1e-5;
  axes.at(2).stepper->load.viscous_friction = 2e-3;
  configuration.record = rack::RecordConfiguration{csv, base::SimDuration(100'000), {"*"}};
  return configuration;
}

/// Looks signals of a device's axes up by name; the rack must outlive it.
class SignalTable {
 public:
  SignalTable(rack::Rack& rack, std::string device)
      : signals_(rack.signals()), device_(std::move(device)) {}

  [[nodiscard]] double read(std::size_t axis, std::string_view name) const {
    return find(axis, name).read();
  }
  /// Column in a recording of all signals, 1 = time.
  [[nodiscard]] int column(std::size_t axis, std::string_view name) const {
    return static_cast<int>(&find(axis, name) - signals_.data()) + 2;
  }

 private:
  [[nodiscard]] const product::Signal& find(std::size_t axis, std::string_view of_axis) const {
    const std::string name = fmt::format("{}.axis{}.{}", device_, axis, of_axis);
    const auto found = std::ranges::find(signals_, name, &product::Signal::name);
    if (found == signals_.end()) {
      throw Failure(fmt::format("the rack has no signal {}", name));
    }
    return *found;
  }

  std::vector<product::Signal> signals_;
  std::string device_;
};

struct AxisOutcome {
  double peak_following_error = 0.0;  ///< microsteps, demand against shaft
  double peak_velocity = 0.0;         ///< revolutions/s of the shaft
  base::SimTime arrival;
  bool arrived = false;
};

void observe(const SignalTable& signals, std::size_t axis, AxisOutcome& outcome) {
  const double demand = signals.read(axis, "position_demand");
  const double shaft = signals.read(axis, "shaft_position") * kMicrostepsPerRevolution;
  outcome.peak_following_error = std::max(outcome.peak_following_error, std::abs(demand - shaft));
  outcome.peak_velocity =
      std::max(outcome.peak_velocity, std::abs(signals.read(axis, "shaft_speed")));
}

void start(master::Cia402Client& axis, const DemoMove& move) {
  require(axis.set_mode(master::OperationMode::profile_position));
  require(axis.enable());
  const auto units = [](double revolutions) {
    return static_cast<std::uint32_t>(std::lround(revolutions * kMicrostepsPerRevolution));
  };
  require(axis.start_move(
      {.target = static_cast<std::int32_t>(std::lround(move.distance * kMicrostepsPerRevolution)),
       .velocity = units(move.velocity),
       .acceleration = units(move.acceleration),
       .deceleration = units(move.acceleration)}));
}

/// `start` is the moment at which axis 0 was told to move.
rack::Plot picture(const product::Product& product, const std::string& csv, std::uint64_t rows,
                   const SignalTable& signals, base::SimTime start) {
  rack::Plot plot{.title = product.identity().name() + ": three axes in profile position mode",
                  .csv_path = csv,
                  .rows = rows,
                  .panels = {}};
  const auto panel = [&](const std::string& label, std::string_view signal, double scale) {
    rack::PlotPanel result{.label = label, .curves = {}, .window = {}};
    for (std::size_t axis = 0; axis < kMoves.size(); ++axis) {
      result.curves.push_back({signals.column(axis, signal), scale, fmt::format("axis {}", axis),
                               std::string(kMoves[axis].colour)});
    }
    return result;
  };
  plot.panels.push_back(panel("shaft / rev", "shaft_position", 1.0));
  plot.panels.push_back(panel("speed / rev/s", "shaft_speed", 1.0));
  plot.panels.push_back(panel("follow. error / µstep", "following_error", 1.0));
  rack::PlotPanel currents{.label = "coils, axis 0 / A", .curves = {}, .window = {}};
  currents.curves.push_back({signals.column(0, "coil_current_a"), 1.0, "phase A", "#1f77b4"});
  currents.curves.push_back({signals.column(0, "coil_current_b"), 1.0, "phase B", "#e08e0b"});
  rack::PlotPanel first_steps = currents;
  first_steps.label = "first 150 ms / A";
  first_steps.window = std::pair(start.seconds() - 0.01, start.seconds() + 0.14);
  plot.panels.push_back(std::move(currents));
  plot.panels.push_back(std::move(first_steps));
  return plot;
}

struct DemoOptions {
  std::string output = "demo-output";
  WebOptions web;  ///< empty: three axes in this process; else where the show is served
};

class Demo {
 public:
  explicit Demo(const std::string& directory)
      : csv_((std::filesystem::path(directory) / "motion.csv").string()),
        product_(demo_product()),
        log_(make_logger()),
        configuration_(demo_rack(*product_, csv_)),
        rack_(configuration_, log_),
        signals_(rack_, configuration_.segments.front().devices.front().name),
        port_(rack_, 0, configuration_.cycle, configuration_.step,
              capture((std::filesystem::path(directory) / "bus.pcap").string())),
        master_(port_) {}

  void bring_up() {
    require(master_.scan());
    for (const master::Slave& slave : master_.slaves()) {
      fmt::print("found {} (vendor {:X}h, product {:X}h, revision {:X}h)\n", slave.information.name,
                 slave.information.identity.vendor_id, slave.information.identity.product_code,
                 slave.information.identity.revision);
    }
    require(master_.configure_process_data());
    require(master_.go_operational());
    fmt::print("segment operational: {} bytes out, {} bytes in per cycle of {} us\n",
               master_.outputs(0).size(), master_.inputs(0).size(),
               configuration_.cycle.nanoseconds() / 1000);
  }

  void move() {
    for (std::size_t i = 0; i < kMoves.size(); ++i) {
      axes_.emplace_back(master_, 0, static_cast<unsigned>(i));
    }
    begin_ = port_.now();
    for (std::size_t i = 0; i < kMoves.size(); ++i) {
      start_[i] = port_.now();
      start(axes_[i], kMoves[i]);
      fmt::print("axis {}: {:+.1f} rev at {:.1f} rev/s, {:.1f} rev/s² started\n", i,
                 kMoves[i].distance, kMoves[i].velocity, kMoves[i].acceleration);
    }
    constexpr base::SimDuration kLimit{10'000'000'000};
    double longest = 0.0;
    for (const DemoMove& move : kMoves) {
      longest = std::max(longest, move.duration());
    }
    Progress progress("moving");
    while (std::ranges::any_of(outcomes_, [](const AxisOutcome& o) { return !o.arrived; })) {
      if (port_.now() - begin_ > kLimit) {
        throw Failure("the axes did not arrive within 10 s of simulated time");
      }
      require(master_.run_cycle());
      progress.reached(std::min((port_.now() - begin_).seconds() / longest, 1.0));
      for (std::size_t i = 0; i < kMoves.size(); ++i) {
        observe(signals_, i, outcomes_[i]);
        if (!outcomes_[i].arrived && require(axes_[i].target_reached())) {
          outcomes_[i].arrived = true;
          outcomes_[i].arrival = port_.now();
        }
      }
    }
    for (int settle = 0; settle < 200; ++settle) {
      require(master_.run_cycle());
    }
  }

  void report() {
    fmt::print("\n{:4}  {:>12}  {:>12}  {:>13}  {:>15}  {:>10}  {:>10}\n", "axis", "target",
               "reached", "final error", "peak following", "time", "by ramp");
    fmt::print("{:4}  {:>12}  {:>12}  {:>13}  {:>15}  {:>10}  {:>10}\n", "", "[microstep]",
               "[microstep]", "[microstep]", "[microstep]", "[s]", "[s]");
    for (std::size_t i = 0; i < kMoves.size(); ++i) {
      const double target = kMoves[i].distance * kMicrostepsPerRevolution;
      const double reached = require(axes_[i].position_actual());
      fmt::print("{:4}  {:12.0f}  {:12.0f}  {:13.0f}  {:15.1f}  {:10.3f}  {:10.3f}\n", i, target,
                 reached, reached - target, outcomes_[i].peak_following_error,
                 (outcomes_[i].arrival - start_[i]).seconds(), kMoves[i].duration());
    }
    fmt::print("{}\n", cycles_text(master_.cycle_statistics()));
  }

  void shut_down() {
    for (master::Cia402Client& axis : axes_) {
      require(axis.disable());
    }
    require(master_.stop());
  }

  /// Closes the recording and draws it.
  [[nodiscard]] rack::Plot plot() {
    if (const auto missing = rack_.outputs().finish(); !missing.empty()) {
      throw Failure(missing.front());
    }
    return picture(*product_, csv_, rack_.recorder()->rows(), signals_, start_[0]);
  }

 private:
  static std::unique_ptr<link::PcapWriter> capture(const std::string& path) {
    auto writer = link::PcapWriter::open(path);
    if (!writer) {
      throw Failure(writer.error().text);
    }
    return std::move(*writer);
  }

  std::string csv_;
  std::shared_ptr<const product::Product> product_;
  rack::EventLog log_;
  rack::RackConfiguration configuration_;
  rack::Rack rack_;
  SignalTable signals_;
  bench::LocalPort port_;
  master::Master master_;
  std::vector<master::Cia402Client> axes_;
  base::SimTime begin_;
  std::array<base::SimTime, kMoves.size()> start_{};
  std::array<AxisOutcome, kMoves.size()> outcomes_{};
};

/// Five devices on their links that all move, until Ctrl-C.
void show(const DemoOptions& options) {
  RunOptions run;
  run.rack_file = write_show_rack(options.output).string();
  run.web = options.web;
  run.show = true;
  fmt::print("The rack file is {}.\n", run.rack_file);
  run_until_stopped(std::move(run));
}

void demo(const DemoOptions& options) {
  std::error_code error;
  std::filesystem::create_directories(options.output, error);
  if (error) {
    throw Failure(fmt::format("cannot create the directory {}: {}; choose another with --output",
                              options.output, error.message()));
  }
  rack::Plot plot;
  {
    Demo demo(options.output);
    demo.bring_up();
    demo.move();
    demo.report();
    demo.shut_down();
    plot = demo.plot();
  }
  const std::filesystem::path directory(options.output);
  for (const char* name : {"motion.png", "motion.svg"}) {
    rack::draw(plot, (directory / name).string());
  }
  fmt::print("\nwritten to {}/:\n", options.output);
  fmt::print("  motion.png, motion.svg  position, speed, following error and coil currents\n");
  fmt::print("  motion.csv              every signal each 100 us of simulated time\n");
  fmt::print("  bus.pcap                every EtherCAT frame, for Wireshark or tshark\n");
}

}  // namespace

void add_demo_command(CLI::App& app) {
  auto options = std::make_shared<DemoOptions>();
  CLI::App* command = app.add_subcommand(
      "demo", "Move three axes of a TMCM-3315 in this process: no privileges, no interface");
  command->add_option("-o,--output", options->output, "Directory for pictures and recordings")
      ->check(names(Names::directory))
      ->capture_default_str();
  auto* http =
      command->add_option("--http", options->web.http,
                          "[ADDRESS:]PORT of a dashboard with five turning devices instead, until "
                          "Ctrl-C; port 0: any that is free");
  command
      ->add_option("--http-token", options->web.token_file,
                   "File with the token that writes need, and from other machines all access")
      ->check(names(Names::file))
      ->needs(http);
  command->footer(
      "Examples:\n"
      "  stator demo                     pictures of a move in demo-output\n"
      "  stator demo --http 8080         five turning devices in the browser");
  command->callback([options] { options->web.http.empty() ? demo(*options) : show(*options); });
}

}  // namespace stator::cli
