#include "canopen/conformance_device.hpp"

#include <gtest/gtest.h>

#include "stator/canopen/sdo/crc16.hpp"

namespace stator::canopen::test {

namespace {

using namespace base::literals;

constexpr std::array<ParameterRange, 1> kCommunication{{{0x1000, 0x1FFF}}};
constexpr std::array<ParameterRange, 1> kApplication{{{0x2000, 0x9FFF}}};
constexpr std::array<ParameterGroup, 2> kGroups{{{2, kCommunication, true}, {3, kApplication}}};
constexpr std::uint32_t kAllGroups = 1U << 2 | 1U << 3;
constexpr std::array<StorageCommand, 8> kCommands{{
    {0x1010, 1, StorageCommand::Action::store, kAllGroups},
    {0x1010, 2, StorageCommand::Action::store, 1U << 2},
    {0x1010, 3, StorageCommand::Action::store, 1U << 3},
    {0x1010, 4, StorageCommand::Action::store, 1U << 3},
    {0x1011, 1, StorageCommand::Action::restore, kAllGroups},
    {0x1011, 2, StorageCommand::Action::restore, 1U << 2},
    {0x1011, 3, StorageCommand::Action::restore, 1U << 3},
    {0x1011, 4, StorageCommand::Action::restore, 1U << 3},
}};

constexpr std::uint32_t kClientToServer = 0x600 + kNodeId;
constexpr std::uint32_t kServerToClient = 0x580 + kNodeId;
constexpr std::size_t kSegment = 7;

std::uint8_t low(unsigned value) {
  return static_cast<std::uint8_t>(value & 0xFF);
}

ConformanceDevice::Message initiate(unsigned command, std::uint16_t index, std::uint8_t subindex,
                                    std::uint32_t data = 0) {
  return {low(command), low(index),      low(index >> 8U), subindex,
          low(data),    low(data >> 8U), low(data >> 16U), low(data >> 24U)};
}

}  // namespace

ConformanceDevice::ConformanceDevice()
    : emergencies(dictionary, transmitter, {}),
      node(dictionary, transmitter, {}, {.node_id = kNodeId}),
      sync_consumer(dictionary, emergencies),
      sync_producer(dictionary, transmitter, sync_consumer),
      pdos(dictionary, transmitter, emergencies, {}),
      error_behaviour(
          dictionary,
          {base::Delegate<NmtState()>::bind<&ConformanceDevice::node_state>(*this),
           base::Delegate<void(NmtState, base::SimTime)>::bind<&ConformanceDevice::node_enter>(
               *this)},
          {}),
      storage(dictionary, memory, {}, {kGroups, kCommands}) {
  sync_consumer.set_listener(SyncConsumer::Listener::bind<&PdoService::on_sync>(pdos));
  NodeHooks hooks;
  hooks.reset_application =
      base::Delegate<void(base::SimTime)>::bind<&ConformanceDevice::on_reset_application>(*this);
  hooks.assign_node_id = base::Delegate<void(
      std::uint8_t, base::SimTime)>::bind<&ConformanceDevice::on_assign_node_id>(*this);
  node.set_hooks(hooks);
  node.set_emergency_sink(&emergencies);
  node.set_communication_error_reaction(&error_behaviour);
  node.set_write_completion(&storage);
  for (Service* service :
       std::initializer_list<Service*>{&emergencies, &sync_consumer, &sync_producer, &pdos}) {
    node.add(*service);
  }
  node.power_on(now);
  wait(1_s);
  reset_node();
  EXPECT_EQ(download(0x1011, 1, kLoadSignature), 0U);
  reset_node();
}

void ConformanceDevice::on_assign_node_id(std::uint8_t node_id, base::SimTime time) {
  dictionary.set_node_id(node_id);
  dictionary.reset_values(0x1000, 0x1FFF);
  storage.load(time);
}

void ConformanceDevice::nmt(NmtCommand command, std::uint8_t addressed) {
  send(can::data_frame(0x000, {static_cast<unsigned>(command), addressed}));
  wait(0_ns);
}

void ConformanceDevice::reset_node() {
  take_sent();
  nmt(NmtCommand::reset_node);
  wait(100_ms);
  EXPECT_EQ(take_sent(), std::vector{can::data_frame(0x700U + kNodeId, {0})});
}

void ConformanceDevice::wait(base::SimDuration duration) {
  const base::SimTime end = now + duration;
  for (base::SimTime due = node.next_deadline(); due <= end; due = node.next_deadline()) {
    now = std::max(now, due);
    node.advance(now);
  }
  now = end;
}

void ConformanceDevice::send(const can::Frame& frame) {
  wait(0_ns);
  node.receive(frame, now);
  wait(0_ns);
}

std::size_t ConformanceDevice::take_count(std::uint32_t can_id) {
  return static_cast<std::size_t>(std::ranges::count(take_sent(), can_id, &can::Frame::identifier));
}

ConformanceDevice::Message ConformanceDevice::exchange(std::span<const std::uint8_t> request) {
  can::Frame frame{.identifier = kClientToServer, .length = 8};
  std::ranges::transform(request, frame.data.begin(),
                         [](std::uint8_t byte) { return std::byte{byte}; });
  send(frame);
  wait(5_ms);
  Message answer{};
  const auto found =
      std::ranges::find(transmitter.frames, kServerToClient, &can::Frame::identifier);
  if (found != transmitter.frames.end()) {
    std::ranges::transform(found->data, answer.begin(),
                           [](std::byte byte) { return std::to_integer<std::uint8_t>(byte); });
    transmitter.frames.erase(found);
  }
  return answer;
}

std::uint32_t ConformanceDevice::abort_of(const Message& answer) {
  return answer[0] == 0x80 ? answer[4] | static_cast<std::uint32_t>(answer[5]) << 8 |
                                 static_cast<std::uint32_t>(answer[6]) << 16 |
                                 static_cast<std::uint32_t>(answer[7]) << 24
                           : 0;
}

std::uint32_t ConformanceDevice::download(std::uint16_t index, std::uint8_t subindex,
                                          std::uint32_t value, std::uint8_t size) {
  return abort_of(exchange(initiate(0x23U | (4U - size) << 2U, index, subindex, value)));
}

std::uint32_t ConformanceDevice::download(std::uint16_t index, std::uint8_t subindex,
                                          std::uint32_t value) {
  return download(index, subindex, value,
                  static_cast<std::uint8_t>(dictionary.find(index, subindex)->size()));
}

std::uint32_t ConformanceDevice::download_segmented(std::uint16_t index, std::uint8_t subindex,
                                                    std::string_view bytes) {
  Message answer =
      exchange(initiate(0x21, index, subindex, static_cast<std::uint32_t>(bytes.size())));
  unsigned toggle = 0;
  for (std::size_t at = 0; abort_of(answer) == 0 && (at == 0 || at < bytes.size());
       at += kSegment) {
    const std::string_view part = bytes.substr(at, kSegment);
    const unsigned last = at + kSegment >= bytes.size() ? 1 : 0;
    Message segment{low(toggle << 4U | static_cast<unsigned>(kSegment - part.size()) << 1U | last)};
    std::ranges::transform(part, segment.begin() + 1,
                           [](char byte) { return static_cast<std::uint8_t>(byte); });
    answer = exchange(segment);
    toggle ^= 1U;
  }
  return abort_of(answer);
}

ConformanceDevice::Upload ConformanceDevice::upload(std::uint16_t index, std::uint8_t subindex) {
  Message answer = exchange(initiate(0x40, index, subindex));
  Upload result;
  if ((answer[0] & 0xE2) == 0x42) {  // expedited
    result.bytes.assign(answer.begin() + 4, answer.end() - ((answer[0] >> 2) & 3));
    return result;
  }
  for (unsigned toggle = 0; abort_of(answer) == 0; toggle ^= 0x10U) {
    answer = exchange({low(0x60U | toggle)});
    if (abort_of(answer) == 0) {
      result.bytes.append(answer.begin() + 1, answer.end() - ((answer[0] >> 1) & 7));
      if ((answer[0] & 1) != 0) {
        return result;
      }
    }
  }
  result.abort = abort_of(answer);
  return result;
}

std::uint32_t ConformanceDevice::upload_number(std::uint16_t index, std::uint8_t subindex) {
  const Upload result = upload(index, subindex);
  EXPECT_EQ(result.abort, 0U) << std::hex << index;
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < std::min<std::size_t>(result.bytes.size(), 4); ++i) {
    number |= static_cast<std::uint32_t>(static_cast<std::uint8_t>(result.bytes[i])) << (8 * i);
  }
  return number;
}

ConformanceDevice::Upload ConformanceDevice::upload_block(std::uint16_t index,
                                                          std::uint8_t subindex, bool with_crc) {
  constexpr std::uint8_t kBlockSize = 127;
  Upload result;
  const Message answer = exchange(initiate(with_crc ? 0xA4 : 0xA0, index, subindex, kBlockSize));
  result.abort = abort_of(answer);
  if (result.abort != 0) {
    return result;
  }
  EXPECT_EQ(answer[0] & 0xF9, 0xC0) << "a block upload is offered";
  const std::size_t size = answer[4] | static_cast<std::size_t>(answer[5]) << 8;
  take_sent();
  send(can::data_frame(kClientToServer, {0xA3, 0, 0, 0, 0, 0, 0, 0}));
  for (bool last = false; !last;) {
    wait(5_ms);
    unsigned sequence = 0;
    for (const can::Frame& frame : take_sent()) {
      if (frame.identifier == kServerToClient) {
        const auto header = std::to_integer<unsigned>(frame.data[0]);
        sequence = header & 0x7FU;
        last = (header & 0x80U) != 0;
        for (std::size_t i = 1; i < 8; ++i) {
          result.bytes += static_cast<char>(frame.data[i]);
        }
      }
    }
    if (sequence == 0) {
      result.abort = 1;
      return result;
    }
    const Message end = exchange({0xA2, low(sequence), kBlockSize});
    if (last) {
      const std::size_t unused = (end[0] >> 2) & 7;
      result.bytes.erase(result.bytes.size() - unused);
      EXPECT_EQ(result.bytes.size(), size);
      const std::uint16_t crc = crc16(std::as_bytes(std::span(result.bytes)));
      EXPECT_EQ(end[1] | end[2] << 8, with_crc ? crc : 0);
      send(can::data_frame(kClientToServer, {0xA1, 0, 0, 0, 0, 0, 0, 0}));
    }
  }
  return result;
}

std::uint32_t ConformanceDevice::download_block(std::uint16_t index, std::uint8_t subindex,
                                                std::string_view bytes, bool with_crc) {
  Message answer = exchange(
      initiate(with_crc ? 0xC6 : 0xC2, index, subindex, static_cast<std::uint32_t>(bytes.size())));
  if (abort_of(answer) != 0) {
    return abort_of(answer);
  }
  const std::size_t block_size = answer[4];
  std::size_t in_block = 0;
  for (std::size_t at = 0; at < bytes.size(); at += kSegment) {
    const std::string_view part = bytes.substr(at, kSegment);
    const bool last = at + kSegment >= bytes.size();
    ++in_block;
    Message segment{low(static_cast<unsigned>(in_block) | (last ? 0x80U : 0U))};
    std::ranges::transform(part, segment.begin() + 1,
                           [](char byte) { return static_cast<std::uint8_t>(byte); });
    if (last || in_block == block_size) {
      answer = exchange(segment);
      EXPECT_EQ(answer[0], 0xA2);
      EXPECT_EQ(answer[1], in_block);
      in_block = 0;
    } else {
      can::Frame frame{.identifier = kClientToServer, .length = 8};
      std::ranges::transform(segment, frame.data.begin(),
                             [](std::uint8_t byte) { return std::byte{byte}; });
      send(frame);
    }
  }
  const auto unused = static_cast<unsigned>((kSegment - bytes.size() % kSegment) % kSegment);
  const std::uint16_t crc = with_crc ? crc16(std::as_bytes(std::span(bytes))) : std::uint16_t{0};
  return abort_of(exchange({low(0xC1U | unused << 2U), low(crc), low(crc >> 8U)}));
}

void ConformanceDevice::configure_pdo(std::uint16_t communication, std::uint8_t type,
                                      std::initializer_list<std::uint32_t> map) {
  const auto mapping = static_cast<std::uint16_t>(communication + 0x200);
  const std::uint32_t cob_id = upload_number(communication, 1) & ~kCobIdInvalid;
  EXPECT_EQ(download(communication, 1, cob_id | kCobIdInvalid), 0U);
  EXPECT_EQ(download(communication, 2, type), 0U);
  EXPECT_EQ(download(mapping, 0, 0), 0U);
  std::uint8_t subindex = 0;
  for (const std::uint32_t object : map) {
    EXPECT_EQ(download(mapping, ++subindex, object), 0U);
  }
  EXPECT_EQ(download(mapping, 0, subindex), 0U);
  EXPECT_EQ(download(communication, 1, cob_id), 0U);
}

}  // namespace stator::canopen::test
