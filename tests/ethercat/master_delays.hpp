#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "ethercat/test_bus.hpp"

namespace stator::ethercat::testing {

/// What a master reads of a slave to work out propagation delays.
struct DelayMeasurement {
  std::uint16_t dl_status = 0;
  std::array<std::uint32_t, 4> receive_times{};
};

/// Propagation delays as masters compute them from receive times, for slaves in the order in which
/// a frame passes them, each entered through the port with the smallest time: ETG.1020, "delay
/// measurement". The delay of a link is half of what the parent waits for the answer from that
/// port, less what the child itself waits for those behind it.
class MasterDelays {
 public:
  explicit MasterDelays(const std::vector<DelayMeasurement>& slaves) {
    for (const DelayMeasurement& slave : slaves) {
      nodes_.push_back(node_of(slave));
    }
    connect();
    std::vector<bool> parent_of_somebody(nodes_.size());
    for (const Node& node : nodes_) {
      if (node.has_parent) {
        parent_of_somebody[node.parent] = true;
      }
    }
    delays_.resize(nodes_.size());
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (nodes_[i].has_parent) {
        delays_[i] = delay_of(nodes_[i], parent_of_somebody[i]);
      }
    }
  }

  /// ns from the first slave's receiving port to that of the slave at `position`.
  [[nodiscard]] std::uint32_t operator[](std::size_t position) const { return delays_[position]; }

 private:
  struct Node {
    std::vector<std::uint32_t> times;  ///< of open ports, in the order of a frame's way
    bool has_parent = false;
    std::size_t parent = 0;
    std::size_t parent_port = 0;  ///< index into the parent's `times`
    std::size_t next_child = 1;
  };

  static Node node_of(const DelayMeasurement& slave) {
    constexpr std::array<unsigned, 4> kWay{0, 3, 1, 2};
    std::vector<unsigned> open;
    for (const unsigned port : kWay) {
      if ((slave.dl_status >> (8 + 2 * port) & 3U) == 2U) {
        open.push_back(port);
      }
    }
    std::size_t entry = 0;
    for (std::size_t i = 1; i < open.size(); ++i) {
      const std::uint32_t ahead = slave.receive_times[open[entry]] - slave.receive_times[open[i]];
      entry = static_cast<std::int32_t>(ahead) > 0 ? i : entry;
    }
    Node node;
    for (std::size_t i = 0; i < open.size(); ++i) {
      node.times.push_back(slave.receive_times[open[(entry + i) % open.size()]]);
    }
    return node;
  }

  /// The parent of a slave is the last one before it that still has an open port to fill.
  void connect() {
    for (std::size_t i = 1; i < nodes_.size(); ++i) {
      std::size_t parent = i - 1;
      while (nodes_[parent].next_child >= nodes_[parent].times.size() && parent > 0) {
        parent = nodes_[parent].parent;
      }
      nodes_[i].has_parent = true;
      nodes_[i].parent = parent;
      nodes_[i].parent_port = nodes_[parent].next_child++;
    }
  }

  [[nodiscard]] std::uint32_t delay_of(const Node& node, bool has_children) const {
    const Node& parent = nodes_[node.parent];
    const std::uint32_t before = parent.times[node.parent_port - 1];
    const std::uint32_t answer = parent.times[node.parent_port] - before;
    const std::uint32_t own = has_children ? node.times.back() - node.times.front() : 0;
    return delays_[node.parent] + (before - parent.times.front()) + (answer - own) / 2;
  }

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> delays_;
};

/// Has all slaves latch a frame's receive times and reads them, in the order of the frame's way.
inline std::vector<DelayMeasurement> measure_delays(TestBus& bus) {
  const unsigned slaves = bus.broadcast_write(0x0900, zeros(4)).working_counter;
  std::vector<DelayMeasurement> measurements;
  for (std::uint16_t i = 0; i < slaves; ++i) {
    DelayMeasurement measurement;
    measurement.dl_status = static_cast<std::uint16_t>(number(bus.read(i, 0x0110, 2).data));
    const Bytes times = bus.read(i, 0x0900, 16).data;
    for (std::size_t port = 0; port < 4; ++port) {
      measurement.receive_times[port] = base::load_le<std::uint32_t>(times.data() + 4 * port);
    }
    measurements.push_back(measurement);
  }
  return measurements;
}

}  // namespace stator::ethercat::testing
