#include "masters/soem.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "stator/base/byte_order.hpp"

namespace stator::tests {

namespace {

constexpr base::SimDuration kPollInterval = 200_us;
constexpr std::uint16_t kAlControl = 0x0120;
constexpr std::uint16_t kAlStatus = 0x0130;
constexpr std::uint16_t kSiiStatus = 0x0502;

}  // namespace

unsigned Soem::count_slaves() {
  bus_.bwr(0x0103, bytes({0}));
  bus_.bwr(kAlControl, bytes({0x11}));
  bus_.bwr(kAlControl, bytes({0x11}));
  return bus_.brd(0x0000, 2).working_counter;
}

void Soem::set_defaults() {
  struct Row {
    std::uint16_t address;
    Bytes data;
  };
  const Row rows[] = {
      {0x0101, bytes({0})}, {0x0200, bytes({4, 0})},     {0x0300, zeros(8)},
      {0x0600, zeros(48)},  {0x0800, zeros(32)},         {0x0981, bytes({0})},
      {0x0910, zeros(4)},   {0x0930, bytes({0, 0x10})},  {0x0934, bytes({0, 0x0C})},
      {0x0103, bytes({0})}, {kAlControl, bytes({0x11})}, {0x0500, bytes({2})},
      {0x0500, bytes({0})},
  };
  for (const Row& row : rows) {
    EXPECT_EQ(bus_.bwr(row.address, row.data).working_counter, bus_.size())
        << "BWR " << std::hex << row.address;
  }
}

void Soem::set_addresses() {
  for (std::size_t i = 0; i < bus_.size(); ++i) {
    EXPECT_EQ(bus_.aprd(i, 0x0140, 2).working_counter, 1U);
    EXPECT_EQ(bus_.apwr(i, 0x0010, little_endian(station(i), 2)).working_counter, 1U);
    EXPECT_EQ(bus_.apwr(i, 0x0100, little_endian(i == 0 ? 1 : 0, 2)).working_counter, 1U);
    EXPECT_EQ(number(bus_.aprd(i, 0x0010, 2).data), station(i));
    EXPECT_EQ(bus_.fprd(station(i), 0x0012, 2).working_counter, 1U);
    EXPECT_EQ(bus_.fprd(station(i), kSiiStatus, 2).working_counter, 1U);
  }
}

void Soem::to_pre_operational() {
  for (std::size_t i = 0; i < bus_.size(); ++i) {
    unsigned status = 0;
    for (int poll = 0; poll < 2000 && status != kInit; ++poll) {
      status = number(part(bus_.fprd(station(i), kAlStatus, 6).data, 0, 2)) & 0xFFFF;
      bus_.pass(status == kInit ? 0_us : 1_ms);
    }
    EXPECT_EQ(status, kInit);
    Bytes mailboxes = sync_manager(kReceiveMailbox, kMailboxLength, 0x26);
    const Bytes transmit = sync_manager(kTransmitMailbox, kMailboxLength, 0x22);
    mailboxes.insert(mailboxes.end(), transmit.begin(), transmit.end());
    EXPECT_EQ(bus_.fpwr(station(i), 0x0800, mailboxes).working_counter, 1U);
    EXPECT_EQ(bus_.fpwr(station(i), 0x0500, bytes({1})).working_counter, 1U);
    request(i, kPreOperational | 0x10);
  }
  EXPECT_EQ(wait_for_all(kPreOperational), kPreOperational);
}

void Soem::config_init() {
  EXPECT_EQ(count_slaves(), bus_.size());
  set_defaults();
  set_addresses();
  to_pre_operational();
}

void Soem::start_sii_read(std::size_t position, std::uint16_t word) {
  const auto status = number(bus_.fprd(station(position), kSiiStatus, 2).data);
  if ((status & 0x7800) != 0) {
    bus_.fpwr(station(position), kSiiStatus, zeros(2));
  }
  Bytes command = bytes({0x00, 0x01, 0, 0, 0, 0});
  base::store_le(command, 2, word);
  EXPECT_EQ(bus_.fpwr(station(position), kSiiStatus, command).working_counter, 1U);
}

std::uint32_t Soem::finish_sii_read(std::size_t position) {
  const base::SimTime limit = bus_.now() + 20_ms;
  while ((number(bus_.fprd(station(position), kSiiStatus, 2).data) & 0x8000) != 0) {
    if (bus_.now() > limit) {
      ADD_FAILURE() << "EEPROM still busy after 20 ms";
      return 0;
    }
    bus_.pass(kPollInterval);
  }
  return static_cast<std::uint32_t>(number(bus_.fprd(station(position), 0x0508, 4).data));
}

void Soem::write_sii(std::size_t position, std::uint16_t word, std::uint16_t value) {
  EXPECT_EQ(bus_.fpwr(station(position), 0x0508, little_endian(value, 2)).working_counter, 1U);
  Bytes command = bytes({0x01, 0x02, 0, 0, 0, 0});
  base::store_le(command, 2, word);
  EXPECT_EQ(bus_.fpwr(station(position), kSiiStatus, command).working_counter, 1U);
  const base::SimTime limit = bus_.now() + 20_ms;
  std::uint64_t status = 0x8000;
  while ((status & 0x8000) != 0 && bus_.now() < limit) {
    bus_.pass(kPollInterval);
    status = number(bus_.fprd(station(position), kSiiStatus, 2).data);
  }
  EXPECT_EQ(status & 0xF800, 0U) << "write of word " << std::hex << word;
}

void Soem::request(std::size_t position, unsigned al_control) {
  EXPECT_EQ(bus_.fpwr(station(position), kAlControl, little_endian(al_control, 2)).working_counter,
            1U);
}

unsigned Soem::wait_for_all(unsigned state) {
  const base::SimTime limit = bus_.now() + 2_s;
  while (bus_.now() < limit) {
    const Answer answer = bus_.brd(kAlStatus, 2);
    EXPECT_EQ(answer.working_counter, bus_.size());
    if (number(answer.data) == state) {
      return state;
    }
    bus_.pass(1_ms);
  }
  return static_cast<unsigned>(number(bus_.brd(kAlStatus, 2).data));
}

void Soem::config_map() {
  const auto devices = static_cast<std::uint32_t>(bus_.size());
  for (std::uint32_t i = 0; i < devices; ++i) {
    const auto write = [&](std::uint16_t address, const Bytes& registers) {
      EXPECT_EQ(bus_.fpwr(station(i), address, registers).working_counter, 1U);
    };
    write(0x0810, sync_manager(kOutputs, kProcessData, 0x64));
    write(0x0818, sync_manager(kInputs, kProcessData, 0x20));
    write(0x0600, fmmu(i * kProcessData, kProcessData, kOutputs, 2));
    write(0x0610, fmmu((devices + i) * kProcessData, kProcessData, kInputs, 1));
    write(0x0620, fmmu(2 * devices * kProcessData + i, 1, 0x080D, 1));
  }
  for (std::size_t i = 0; i < bus_.size(); ++i) {
    EXPECT_EQ(bus_.fpwr(station(i), 0x0500, bytes({1})).working_counter, 1U);
    request(i, kSafeOperational);
  }
  EXPECT_EQ(wait_for_all(kSafeOperational), kSafeOperational);
}

void Soem::to_operational() {
  exchange(zeros(image_length()));
  bus_.bwr(kAlControl, bytes({kOperational, 0}));
  EXPECT_EQ(wait_for_all(kOperational), kOperational);
}

std::vector<Answer> Soem::exchange(const Bytes& image) {
  return bus_.with(Command::lrw, 0, image)
      .with(Command::frmw, ethercat::physical_address(station(0), 0x0910), zeros(8))
      .send();
}

std::vector<Soem::Clock> Soem::config_dc(std::uint64_t host_time) {
  EXPECT_EQ(bus_.bwr(0x0900, zeros(4)).working_counter, bus_.size());
  std::vector<Clock> clocks(bus_.size());
  for (std::size_t i = 0; i < bus_.size(); ++i) {
    const auto time = [&](std::uint16_t address, std::size_t length) {
      const Answer answer = bus_.fprd(station(i), address, length);
      EXPECT_EQ(answer.working_counter, 1U);
      return number(answer.data);
    };
    Clock& clock = clocks[i];
    clock.port0 = static_cast<std::uint32_t>(time(0x0900, 4));
    const std::uint64_t received = time(0x0918, 8);
    EXPECT_EQ(bus_.fpwr(station(i), 0x0920, little_endian(host_time - received, 8)).working_counter,
              1U);
    clock.port1 = static_cast<std::uint32_t>(time(0x0904, 4));
    time(0x0908, 4);
    time(0x090C, 4);
    if (i == 0) {
      continue;
    }
    // The parent sees the loop behind its port 1 as the time from port 0 to port 1; the loop
    // behind this slave is a part of it, what is left is twice the way between them.
    const Clock& parent = clocks[i - 1];
    const bool last = i + 1 == bus_.size();
    const std::uint32_t behind = last ? 0 : clock.port1 - clock.port0;
    clock.delay = (parent.port1 - parent.port0 - behind) / 2 + parent.delay;
    EXPECT_EQ(bus_.fpwr(station(i), 0x0928, little_endian(clock.delay, 4)).working_counter, 1U);
  }
  return clocks;
}

bool Soem::mailbox_full(std::size_t position) {
  const Answer answer = bus_.fprd(station(position), 0x080D, 2);
  EXPECT_EQ(answer.working_counter, 1U);
  return (answer.data[0] & std::byte{8}) != std::byte{0};
}

unsigned Soem::send_mailbox(std::size_t position, const Bytes& message) {
  if (mailbox_full(position)) {
    bus_.fprd(station(position), kTransmitMailbox, kMailboxLength);
  }
  Bytes mailbox = message;
  mailbox.resize(kMailboxLength);
  return bus_.fpwr(station(position), kReceiveMailbox, mailbox).working_counter;
}

Bytes Soem::receive_mailbox(std::size_t position) {
  const base::SimTime limit = bus_.now() + 700_ms;
  while (!mailbox_full(position)) {
    if (bus_.now() > limit) {
      return {};
    }
    bus_.pass(kPollInterval);
  }
  const Answer answer = bus_.fprd(station(position), kTransmitMailbox, kMailboxLength);
  EXPECT_EQ(answer.working_counter, 1U);
  const auto length = base::load_le<std::uint16_t>(answer.data, 0);
  return part(answer.data, 0, 6U + length);
}

Bytes Soem::message(unsigned type, const Bytes& body) {
  counter_ = counter_ % 7 + 1;
  Bytes message = little_endian(body.size(), 2);
  for (const unsigned value : {0U, 0U, 0U, type | counter_ << 4}) {
    message.push_back(static_cast<std::byte>(value));
  }
  message.insert(message.end(), body.begin(), body.end());
  return message;
}

Bytes Soem::coe(unsigned service, const Bytes& body) {
  Bytes coe = little_endian(service << 12, 2);
  coe.insert(coe.end(), body.begin(), body.end());
  return message(3, coe);
}

Bytes Soem::sdo(std::size_t position, const Bytes& request) {
  EXPECT_EQ(send_mailbox(position, coe(2, request)), 1U);
  for (;;) {
    const Bytes answer = receive_mailbox(position);
    if (answer.empty()) {
      ADD_FAILURE() << "no answer within 700 ms";
      return {};
    }
    const auto service = number(part(answer, 6, 2)) >> 12;
    if ((number(part(answer, 5, 1)) & 0x0F) != 3 || service != 1) {
      // SOEM takes an answer of service 3 for success, whatever its command.
      EXPECT_EQ(service, answer.at(8) == std::byte{0x80} ? 2U : 3U) << to_hex(answer);
      return part(answer, 8);
    }
    emergencies.push_back(part(answer, 8));
  }
}

Bytes Soem::upload(std::size_t position, std::uint16_t index, std::uint8_t subindex,
                   bool complete) {
  Bytes request = bytes({complete ? 0x50U : 0x40U, 0, 0, subindex, 0, 0, 0, 0});
  base::store_le(request, 1, index);
  return sdo(position, request);
}

std::uint32_t Soem::download(std::size_t position, std::uint16_t index, std::uint8_t subindex,
                             std::uint32_t value, std::size_t length) {
  Bytes request(8);
  request[0] = static_cast<std::byte>(0x23U | (4 - length) << 2);
  base::store_le(request, 1, index);
  request[3] = std::byte{subindex};
  base::store_le(request, 4, value);
  const Bytes answer = sdo(position, request);
  return answer.at(0) == std::byte{0x80} ? base::load_le<std::uint32_t>(answer, 4) : 0;
}

Bytes upload_value(const Bytes& answer) {
  const auto command = std::to_integer<unsigned>(answer.at(0));
  EXPECT_EQ(command & 0xE0, 0x40U) << "no upload answer: " << to_hex(answer);
  EXPECT_EQ(command & 0x01, 0x01U) << "size not indicated";
  if ((command & 0x02) != 0) {
    return part(answer, 4, 4 - (command >> 2 & 3));
  }
  return part(answer, 8, number(part(answer, 4, 4)));
}

}  // namespace stator::tests
