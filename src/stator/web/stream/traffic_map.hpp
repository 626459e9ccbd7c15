#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "stator/dictionary/dictionary.hpp"
#include "stator/ethercat/units/fmmu.hpp"
#include "stator/web/state.hpp"

namespace stator::web {

class Job;

/// An object in process data, in bits from the begin of the PDO or of the sync manager's area.
struct MappedObject {
  std::uint16_t index = 0;  ///< 0: padding
  std::uint8_t subindex = 0;
  std::size_t bit = 0;
  std::size_t bits = 0;
};

/// An area of a sync manager.
struct MailboxArea {
  std::uint16_t start = 0;
  std::uint16_t length = 0;

  [[nodiscard]] bool contains(std::uint16_t address) const {
    return address >= start && address - start < length;
  }
};

/// What of an EtherCAT slave tells the meaning of frames.
struct SlaveMap {
  std::string name;
  const dictionary::Dictionary* objects = nullptr;
  std::uint16_t station = 0;
  std::vector<ethercat::Fmmu> fmmus{};
  std::array<MailboxArea, 4> areas{};  ///< sync managers: mailbox out, in, outputs, inputs
  std::vector<MappedObject> outputs{};
  std::vector<MappedObject> inputs{};
};

/// The same of a node on a CAN bus.
struct NodeMap {
  std::string name;
  const dictionary::Dictionary* objects = nullptr;
  std::uint8_t node_id = 0;  ///< 0: it is no CANopen node
  struct Pdo {
    std::string name;  ///< "RPDO1"
    std::vector<MappedObject> objects{};
  };
  std::map<std::uint32_t, Pdo> pdos{};         ///< by CAN-ID
  std::vector<std::uint32_t> tmcl_requests{};  ///< CAN-IDs of a TMCL module
  std::uint32_t tmcl_replies = 0;
};

/// How the rack's devices are configured at one moment, for who decodes frames.
struct TrafficMap {
  std::vector<std::vector<SlaveMap>> segments{};
  std::vector<std::vector<NodeMap>> buses{};  ///< by bus of the rack, those without wire too
};

/// A map as it is before anybody has looked: names and objects.
[[nodiscard]] TrafficMap empty_traffic_map(const State& state);

/// Reads how the devices are configured at present, a device in each call; its response is of no
/// use, but puts what was read into `result`.
[[nodiscard]] std::unique_ptr<Job> make_traffic_map_job(const State& state, TrafficMap& result);

}  // namespace stator::web
