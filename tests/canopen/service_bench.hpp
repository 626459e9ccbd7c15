#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "canopen/test_objects.hpp"
#include "stator/base/byte_order.hpp"
#include "stator/canopen/cob_id.hpp"
#include "stator/canopen/emergency/emergency_producer.hpp"
#include "stator/canopen/pdo/pdo_service.hpp"
#include "stator/canopen/sync/sync_consumer.hpp"
#include "stator/canopen/sync/sync_producer.hpp"
#include "stator/dictionary/dictionary.hpp"

namespace stator::canopen::test {

/// Keeps what is sent; full when told to be.
class RecordingTransmitter final : public can::Transmitter {
 public:
  bool send(const can::Frame& frame) override {
    if (!full) {
      frames.push_back(frame);
    }
    return !full;
  }
  std::vector<can::Frame> frames;
  bool full = false;
};

/// A finished dictionary with the full-featured objects and the COB-IDs of node kNodeId.
class TestDictionary {
 public:
  TestDictionary() : declarations_(full_featured_objects()) {
    dictionary.add(declarations_);
    dictionary.finish();
    dictionary.set_node_id(kNodeId);
    dictionary.reset_values();
  }

  /// Writes as an SDO does; 0 or the abort code.
  std::uint32_t write(std::uint16_t index, std::uint8_t subindex, std::uint64_t value) {
    const auto entry = dictionary.require(index, subindex);
    if (!entry) {
      return static_cast<std::uint32_t>(entry.error().code);
    }
    std::array<std::byte, 8> bytes{};
    base::store_le(bytes.data(), value);
    const auto verdict = dictionary.write(**entry, std::span(bytes).first((*entry)->size()), {});
    return verdict ? 0 : static_cast<std::uint32_t>(verdict.error().code);
  }
  /// Reads as an SDO does; 0 or the abort code.
  std::uint32_t read_refusal(std::uint16_t index, std::uint8_t subindex) {
    const auto verdict = dictionary.prepare_read(*dictionary.find(index, subindex));
    return verdict ? 0 : static_cast<std::uint32_t>(verdict.error().code);
  }
  [[nodiscard]] std::uint64_t value(std::uint16_t index, std::uint8_t subindex = 0) const {
    return dictionary.find(index, subindex)->value();
  }
  /// Sets a value as the application does.
  void set(std::uint16_t index, std::uint8_t subindex, std::uint64_t value) {
    dictionary.find(index, subindex)->set_value(value);
  }

 private:
  std::vector<dictionary::EntryDeclaration> declarations_;

 public:
  dictionary::Dictionary dictionary;
};

/// PDOs, SYNC and emergencies of a node without its NMT state machine and its SDO server.
class ServiceBench : public TestDictionary {
 public:
  explicit ServiceBench(const PdoRules& pdo_rules = {}, const EmergencyRules& emergency_rules = {},
                        const SyncRules& sync_rules = {})
      : emergencies(dictionary, transmitter, {}, emergency_rules),
        sync(dictionary, emergencies, sync_rules),
        sync_producer(dictionary, transmitter, sync),
        pdos(dictionary, transmitter, emergencies, {}, pdo_rules) {
    sync.set_listener(SyncConsumer::Listener::bind<&PdoService::on_sync>(pdos));
    pdos.set_process_data_hook(
        PdoService::ProcessDataHook::bind<&ServiceBench::on_process_data>(*this));
    start();
  }

  /// As after power-on, or after NMT reset.
  void start() {
    enter(NmtState::initialisation);
    for (Service* service : services()) {
      service->start(now);
    }
    enter(NmtState::pre_operational);
  }
  void enter(NmtState state) {
    for (Service* service : services()) {
      service->on_state(state, now);
    }
  }
  void operational() { enter(NmtState::operational); }

  /// Lets time pass, from deadline to deadline.
  void wait(base::SimDuration duration) {
    const base::SimTime end = now + duration;
    for (base::SimTime due = next_deadline(); due <= end; due = next_deadline()) {
      now = std::max(now, due);
      for (Service* service : services()) {
        service->advance(now);
      }
    }
    now = end;
  }
  bool receive(const can::Frame& frame) {
    wait(base::SimDuration());
    return std::ranges::any_of(services(),
                               [&](Service* service) { return service->receive(frame, now); });
  }
  bool receive(std::uint32_t can_id, std::initializer_list<unsigned> data) {
    return receive(can::data_frame(can_id, data));
  }
  void send_sync() { receive(can::data_frame(0x80, {})); }

  /// Writes to objects of a PDO while it does not exist, and has it exist again.
  void reconfigure(std::uint16_t communication, std::initializer_list<std::uint32_t> map,
                   std::uint8_t type) {
    const auto mapping = static_cast<std::uint16_t>(communication + 0x200);
    const std::uint64_t cob_id = value(communication, 1) & ~std::uint64_t{kCobIdInvalid};
    write(communication, 1, cob_id | kCobIdInvalid);
    write(communication, 2, type);
    write(mapping, 0, 0);
    std::uint8_t subindex = 0;
    for (const std::uint32_t object : map) {
      write(mapping, ++subindex, object);
    }
    write(mapping, 0, map.size());
    write(communication, 1, cob_id);
    wait(base::SimDuration());
  }

  /// What has been sent since the last call.
  std::vector<can::Frame> take_sent() { return std::exchange(transmitter.frames, {}); }
  /// How many of them had `can_id`.
  std::size_t take_count(std::uint32_t can_id) {
    return static_cast<std::size_t>(
        std::ranges::count(take_sent(), can_id, &can::Frame::identifier));
  }

  [[nodiscard]] std::array<Service*, 4> services() {
    return {&emergencies, &sync, &sync_producer, &pdos};
  }
  [[nodiscard]] base::SimTime next_deadline() {
    base::SimTime deadline = base::SimTime::never();
    for (const Service* service : services()) {
      deadline = std::min(deadline, service->next_deadline());
    }
    return deadline;
  }

  base::SimTime now;
  RecordingTransmitter transmitter;
  EmergencyProducer emergencies;
  SyncConsumer sync;
  SyncProducer sync_producer;
  PdoService pdos;
  int process_data_calls = 0;

 private:
  void on_process_data(base::SimTime /*time*/) { ++process_data_calls; }
};

/// The message of an emergency of kNodeId.
inline can::Frame emergency_frame(unsigned code, unsigned error_register,
                                  std::array<unsigned, 5> information = {}) {
  return can::data_frame(0x80U + kNodeId,
                         {code & 0xFFU, code >> 8U, error_register, information[0], information[1],
                          information[2], information[3], information[4]});
}

/// What the document of the TMCC160 allows (requirements RPD, TPD).
inline constexpr std::array<TransmissionTypes, 2> kTmcc160ReceiveTypes{{{0, 0}, {254, 255}}};
inline constexpr std::array<TransmissionTypes, 2> kTmcc160TransmitTypes{{{0, 1}, {254, 255}}};
inline constexpr PdoRules kTmcc160Pdos{
    .receive_types = kTmcc160ReceiveTypes,
    .transmit_types = kTmcc160TransmitTypes,
    .inhibit_unit = base::SimDuration(1'000'000),
    .inhibit_synchronous = true,
    .dummy_usage = 0,
    .mapping_locked = dictionary::AbortCode::device_state,
    .long_pdo = LongPdo::reject,
    .cob_id = {.remote_requests = false, .receive_pdo_bit_30_set = true},
};
inline constexpr std::array<EmergencyRule, 4> kTmcc160Emergencies{{
    {0x6320, 0x21, {0, 255}},
    {0x8130, 0x11, {0, 255}},
    {0x8210, 0x11, {0, 255}},
    {0x8220, 0x11, {0, 255}},
}};

}  // namespace stator::canopen::test
