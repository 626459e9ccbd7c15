#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "stator/base/expected.hpp"
#include "stator/bench/local_can_port.hpp"
#include "stator/bench/local_port.hpp"
#include "stator/can/port.hpp"
#include "stator/ethercat/standard/al_state.hpp"
#include "stator/master/can_sdo_client.hpp"
#include "stator/master/cia402/drive_port.hpp"
#include "stator/master/master.hpp"
#include "stator/product/catalogue/catalogue.hpp"
#include "stator/product/device/signal.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/observe/event_log.hpp"
#include "stator/rack/world/clock.hpp"
#include "stator/rack/world/device_address.hpp"
#include "stator/settings/value.hpp"
#include "stator/tmcl/instruction.hpp"
#include "stator/tmcl/telegram.hpp"

namespace stator::bench {

/// The rack that a file describes (docs/rack-file.md), of products of `catalogue`. Throws
/// rack::RackFileError, a std::runtime_error with file, line, reason and remedy.
[[nodiscard]] rack::RackConfiguration load(const std::string& path,
                                           const product::Catalogue& catalogue);
/// The same of a table with the keys of such a file.
[[nodiscard]] rack::RackConfiguration load(const settings::Table& table,
                                           const product::Catalogue& catalogue);

/// A bench was asked for more simulated time than it may take.
struct TimeLimitReached {
  base::SimDuration limit;  ///< the time it may take
};

/// A rack with a master on each of its networks, all in simulated time: time passes only with what
/// the masters send and wait for, so equal calls give equal results. Functions that let time
/// pass throw TimeLimitReached.
class Bench {
 public:
  /// Frames of a bus that are kept, the newest.
  static constexpr std::size_t kKeptFrames = 4096;
  /// For an answer to an SDO on CAN.
  static constexpr base::SimDuration kSdoTimeout{500'000'000};
  /// For a reply to a command of TMCL.
  static constexpr base::SimDuration kTmclTimeout{200'000'000};
  /// For the boot-up of a node.
  static constexpr base::SimDuration kBootTimeout{5'000'000'000};

  /// Builds the rack as `configuration` has it, but for what it would write to files. Throws
  /// std::runtime_error as rack::Rack does. `limit` is the simulated time it may take.
  explicit Bench(const rack::RackConfiguration& configuration,
                 base::SimDuration limit = base::SimDuration::max());
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;
  ~Bench();

  /// What the masters are connected to. Time is passed by the bench alone.
  [[nodiscard]] rack::Rack& rack() { return *rack_; }
  /// As it was built: without what would write files.
  [[nodiscard]] const rack::RackConfiguration& configuration() const { return configuration_; }
  /// What devices and buses had to say.
  [[nodiscard]] const rack::EventLog& log() const { return *log_; }
  /// The present moment, counted from power-on.
  [[nodiscard]] base::SimTime now() const { return clock_.now(); }
  /// Of further masters' ports onto the rack, e.g. a LocalCanPort.
  [[nodiscard]] rack::LockstepClock& clock() { return clock_; }

  /// The device of that name; nothing: there is none.
  [[nodiscard]] std::optional<rack::DeviceAddress> find(std::string_view device) const;
  /// What can be seen of a device or bus, e.g. "gantry.axis0.shaft_position"; it is read as long as
  /// the bench is there. Throws std::runtime_error for one that is not there.
  [[nodiscard]] const product::Signal& signal(std::string_view name);

  /// Arms a fault, e.g. {{"kind", "motor-stall"}, {"device", "gantry"}, {"at", "200ms"}}: the keys
  /// of a [[fault]] of a rack file. Returns its number. Throws std::runtime_error for one that does
  /// not exist or does not fit.
  std::uint64_t inject(const settings::Table& fault);
  /// The same of one that has been read. Returns its number, or why it cannot be.
  base::Expected<std::uint64_t, std::string> inject(const rack::FaultConfiguration& fault);
  /// Ends the fault of this number; nothing: all.
  void clear_faults(std::optional<std::uint64_t> id = std::nullopt);

  /// Takes all slaves of all segments to Operational, with their process data, and starts the nodes
  /// of all buses (NMT). From then on what drive() carries goes with the process data where it can.
  master::Result<void> go_operational();

  /// Lets one bus cycle pass: every master exchanges its process data, if it has some. Cycles that
  /// fail are in the master's statistics.
  void cycle();
  /// Lets `duration` pass, in whole cycles at least.
  void pass(base::SimDuration duration);
  /// Lets cycles pass until `reached` says so, at most for `limit`. False: it never did.
  bool wait_until(const std::function<bool()>& reached, base::SimDuration limit);

  /// To be called before a step that acts: events_before(), frames_before() and lost_cycles() count
  /// from here on.
  void begin_deed();
  /// Number of the newest event of log() when the last deed began.
  [[nodiscard]] std::uint64_t events_before() const { return events_before_; }
  /// How many frames of frames(bus) had come when the last deed began, those no longer kept
  /// included.
  [[nodiscard]] std::uint64_t frames_before(std::size_t bus) const;
  /// Exchanges of process data of a segment that have failed since the last deed began.
  [[nodiscard]] std::uint64_t lost_cycles(std::size_t segment) const;

  // EtherCAT.

  /// The master of a segment, which has scanned it.
  master::Result<master::Master*> scanned(std::size_t segment);
  /// Scans again, which takes all slaves to Init.
  master::Result<void> scan(std::size_t segment);
  /// Takes all slaves of a segment to a state, as a master does at its start.
  master::Result<void> take_to(ethercat::AlState state, std::size_t segment);
  /// Where the device was found on its segment by the last scan.
  master::Result<std::size_t> position(rack::DeviceAddress device);

  // Objects, over the device's network.

  /// The value of an object, as an SDO carries it: the lowest byte first.
  master::Result<std::vector<std::byte>> upload(rack::DeviceAddress device,
                                                master::ObjectAddress object);
  /// Writes an object; one that goes out with the process data at present is written there.
  master::Result<void> download(rack::DeviceAddress device, master::ObjectAddress object,
                                std::span<const std::byte> data);
  /// A port by which a CiA 402 master reaches the device: by process data where they carry an
  /// object, else by SDO.
  master::Result<master::DrivePort*> drive(rack::DeviceAddress device);

  /// Emergencies of the device that have come since the last deed began, the oldest first. A slave
  /// keeps its own until its mailbox is read, which this does: of it those count that nobody has
  /// fetched before the deed.
  master::Result<std::vector<master::Emergency>> emergencies(rack::DeviceAddress device);

  // CAN.

  /// Puts a frame on a bus.
  void send(std::size_t bus, const can::Frame& frame);
  /// Waits for the boot-up of a CANopen node, before which it hears nothing.
  void wait_for_boot_up(rack::DeviceAddress device);
  /// What passed on the bus, the oldest first, but for what was sent here.
  [[nodiscard]] const std::deque<can::TimedFrame>& frames(std::size_t bus);
  /// How many of the oldest frames of the bus are no longer in frames(), see kKeptFrames.
  [[nodiscard]] std::uint64_t forgotten_frames(std::size_t bus) const;
  /// Node-ID of a CANopen device; nothing: it is none.
  [[nodiscard]] std::optional<std::uint8_t> node_id(rack::DeviceAddress device) const;

  // TMCL.

  /// Sends a direct command to a module, over a serial line if it is on one, else over CAN. Waits
  /// for the reply for kTmclTimeout.
  base::Expected<tmcl::Reply, std::string> ask(rack::DeviceAddress device,
                                               const tmcl::Instruction& instruction);

  // Serial lines.

  /// Sends bytes to the devices of a line, as one telegram, and lets what they answer at once pass.
  void write_line(std::size_t line, std::span<const std::byte> bytes);
  /// What they have sent since the last call of this or of ask().
  std::vector<std::byte> read_line(std::size_t line);

  // Back to an earlier moment.

  /// What the masters know at a moment.
  struct Memory;
  /// It knows nothing of the rack, whose past is for whoever rewinds.
  [[nodiscard]] std::shared_ptr<const Memory> remember() const;
  /// Who brings a rack back to a moment, e.g. by playing a recording.
  class Past {
   public:
    Past() = default;
    Past(const Past&) = delete;
    Past& operator=(const Past&) = delete;
    virtual ~Past() = default;
    /// Brings `rack`, at power-on, to the moment. Nobody else has touched it.
    virtual void play(rack::Rack& rack) = 0;
    /// The place that a master had on a bus at that moment, with what waited in it.
    virtual std::unique_ptr<rack::BusPort> take_port(std::size_t bus, std::size_t number) = 0;
    /// Lets go of the rack: the masters take over.
    virtual void end() = 0;
  };
  /// Goes back to the moment of `memory`: builds rack() anew, in its place, has `past` bring it
  /// there and lets the masters know what they knew. Drives and references to rack(), log() and
  /// clock() go on being good; signals and further ports of others on the rack do not, and have to
  /// be gone before. If `past` throws, nothing but the destructor may be called any more.
  void rewind(const Memory& memory, Past& past);

 private:
  struct SegmentMaster;
  struct BusMaster;
  struct LineMaster;
  class BenchDrivePort;

  [[nodiscard]] const rack::DeviceConfiguration& device_configuration(
      rack::DeviceAddress device) const;
  [[nodiscard]] const std::string& name_of(rack::DeviceAddress device) {
    return rack_->name_of(device);
  }
  void disconnect_lines();
  void take_frames(BusMaster& bus);
  [[nodiscard]] std::vector<master::Emergency> emergencies_on_bus(rack::DeviceAddress device);
  /// Where the device was found, with its mailbox started.
  master::Result<std::size_t> mailbox_position(rack::DeviceAddress device);
  [[nodiscard]] master::CanSdoClient can_client(rack::DeviceAddress device);
  /// Sends `request` and waits for a data frame with that 11-bit identifier.
  std::optional<can::Frame> answer_to(std::size_t bus, const can::Frame& request,
                                      std::uint32_t identifier, base::SimDuration timeout);
  base::Expected<tmcl::Reply, std::string> ask_on_line(LineMaster& line,
                                                       const tmcl::Request& request);

  rack::RackConfiguration configuration_;
  base::SimDuration limit_;
  std::optional<rack::EventLog> log_;
  std::optional<rack::Rack> rack_;  ///< stays where it is when it is made anew
  rack::LockstepClock clock_;
  std::uint64_t events_before_ = 0;
  std::vector<std::unique_ptr<SegmentMaster>> segments_;
  std::vector<std::unique_ptr<BusMaster>> buses_;
  std::vector<std::unique_ptr<LineMaster>> lines_;
  std::vector<std::pair<rack::DeviceAddress, std::unique_ptr<master::DrivePort>>> drives_;
  std::vector<product::Signal> signals_;  ///< empty until one was asked for
};

}  // namespace stator::bench
