#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <vector>

#include "canopen/memory_double.hpp"
#include "canopen/service_bench.hpp"
#include "stator/canopen/emergency/error_behaviour.hpp"
#include "stator/canopen/nmt/node.hpp"
#include "stator/canopen/nmt_command.hpp"
#include "stator/canopen/storage/parameter_storage.hpp"

namespace stator::canopen::test {

/// A complete node with the full-featured objects, and the master of a conformance test: SDO
/// client, NMT master, and everything else as frames.
class ConformanceDevice : public TestDictionary {
 public:
  using Message = std::array<std::uint8_t, 8>;

  /// Powers on and begins as every group of cases does: reset node, restore defaults, reset node.
  ConformanceDevice();

  // NMT master.

  void nmt(NmtCommand command, std::uint8_t node = kNodeId);
  /// Resets the node and expects its boot-up message.
  void reset_node();
  void operational() { nmt(NmtCommand::start); }

  // Time and frames.

  void wait(base::SimDuration duration);
  void send(const can::Frame& frame);
  void sync() { send(can::data_frame(0x80, {})); }
  std::vector<can::Frame> take_sent() { return std::exchange(transmitter.frames, {}); }
  std::size_t take_count(std::uint32_t can_id);

  // SDO client. Abort codes as results; 0: success.

  /// One request of eight bytes (shorter ones are filled with 0) and its answer.
  Message exchange(std::span<const std::uint8_t> request);
  Message exchange(std::initializer_list<std::uint8_t> request) {
    return exchange(std::span(request.begin(), request.size()));
  }
  /// The abort code in an answer; 0 if it is none.
  static std::uint32_t abort_of(const Message& answer);

  std::uint32_t download(std::uint16_t index, std::uint8_t subindex, std::uint32_t value,
                         std::uint8_t size);
  /// The same with the size the object has.
  std::uint32_t download(std::uint16_t index, std::uint8_t subindex, std::uint32_t value);
  std::uint32_t download_segmented(std::uint16_t index, std::uint8_t subindex,
                                   std::string_view bytes);
  std::uint32_t download_block(std::uint16_t index, std::uint8_t subindex, std::string_view bytes,
                               bool with_crc);

  struct Upload {
    std::uint32_t abort = 0;
    std::string bytes;
  };
  /// Expedited or segmented, as the server wants.
  Upload upload(std::uint16_t index, std::uint8_t subindex);
  Upload upload_block(std::uint16_t index, std::uint8_t subindex, bool with_crc);
  std::uint32_t upload_number(std::uint16_t index, std::uint8_t subindex);

  /// Sets up a PDO as the test tool does: invalid, parameters, mapping, valid.
  void configure_pdo(std::uint16_t communication, std::uint8_t type,
                     std::initializer_list<std::uint32_t> map);

  base::SimTime now;
  RecordingTransmitter transmitter;
  MemoryDouble memory;
  EmergencyProducer emergencies;
  Node node;
  SyncConsumer sync_consumer;
  SyncProducer sync_producer;
  PdoService pdos;
  ErrorBehaviour error_behaviour;
  ParameterStorage storage;

 private:
  void on_reset_application(base::SimTime /*now*/) { dictionary.reset_values(); }
  void on_assign_node_id(std::uint8_t node_id, base::SimTime time);
  NmtState node_state() { return node.state(); }
  void node_enter(NmtState state, base::SimTime time) { node.enter(state, time); }
};

}  // namespace stator::canopen::test
