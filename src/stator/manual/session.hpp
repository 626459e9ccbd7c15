#pragma once

#include <atomic>
#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/manual/axis.hpp"
#include "stator/manual/device_status.hpp"
#include "stator/manual/network_master.hpp"
#include "stator/rack/world/device_address.hpp"

namespace stator::manual {

/// Manual control of the devices of one network, from the first that is wanted until the last is
/// given back or somebody else speaks: a thread that runs the network's master.
class Session {
 public:
  /// A device that can be controlled here.
  struct Member {
    rack::DeviceAddress device;
    unsigned axes = 1;  ///< 0: it has process data only
    std::optional<product::MotionUnits> units{};
    base::EventReporter reporter{};
  };

  /// Begins with the device `first`. `running` is the rack of `master` and outlives the session.
  Session(const rack::RunningRack& running, std::unique_ptr<NetworkMaster> master,
          std::vector<Member> members, rack::DeviceAddress first);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  [[nodiscard]] DeviceStatus status(rack::DeviceAddress device) const;
  /// Hands in what is wanted. False: the session is over and takes no more.
  bool start(rack::DeviceAddress device);
  bool release(rack::DeviceAddress device);
  bool command(rack::DeviceAddress device, std::size_t axis, const Command& command);
  bool set_outputs(rack::DeviceAddress device, std::size_t offset, std::vector<std::byte> data);

 private:
  struct Request {
    enum class Kind : std::uint8_t { start, release, command, outputs };
    Kind kind = Kind::start;
    rack::DeviceAddress device;
    std::size_t axis = 0;
    Command command{};
    std::size_t offset = 0;
    std::vector<std::byte> data{};
  };
  /// An axis in the thread's hands.
  struct Held {
    std::unique_ptr<Axis> axis;
    std::optional<base::SimTime> jog_until{};
  };
  using Axes = std::vector<Held>;

  bool ask(Request request);
  void run();
  void serve(const Request& request);
  void begin(rack::DeviceAddress device);
  void give_back(rack::DeviceAddress device);
  void execute(const Request& request);
  void end_jogs();
  void look();
  master::Result<void> look(rack::DeviceAddress device, Axes& axes);
  void end(const std::string& why);
  [[nodiscard]] const Member& member(rack::DeviceAddress device) const;
  void report(rack::DeviceAddress device, const base::EventRule& rule, const std::string& text);

  const rack::RunningRack& running_;
  std::unique_ptr<NetworkMaster> master_;
  std::vector<Member> members_;
  std::map<rack::DeviceAddress, Axes> axes_;  ///< of the thread
  base::SimTime next_look_;                   ///< of the thread
  std::atomic<bool> stopping_{false};

  mutable std::mutex mutex_;  ///< guards all below
  std::deque<Request> requests_;
  std::map<rack::DeviceAddress, DeviceStatus> statuses_;
  bool over_ = false;

  std::jthread thread_;
};

}  // namespace stator::manual
