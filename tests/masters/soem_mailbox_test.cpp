// What SOEM sends through the mailboxes: SDO, SDO information, repeats, errors, emergencies.

#include <utility>

#include <gtest/gtest.h>

#include "masters/soem.hpp"
#include "stator/base/byte_order.hpp"

namespace stator::tests {
namespace {

class SoemMailbox : public ::testing::Test {
 protected:
  SoemMailbox() : bus(2), soem(bus) { soem.config_init(); }

  static Bytes sdo_request(unsigned command, std::uint16_t index, unsigned subindex) {
    Bytes request = bytes({command, 0, 0, subindex, 0, 0, 0, 0});
    base::store_le(request, 1, index);
    return request;
  }
  Bytes upload_message(std::uint16_t index, unsigned subindex = 0) {
    return soem.coe(2, sdo_request(0x40, index, subindex));
  }
  /// Both mailboxes shorter than the device offers, from Init on.
  void restart_with_mailbox_length(std::size_t slave, std::uint16_t length) {
    const std::uint16_t station = Soem::station(slave);
    soem.request(slave, Soem::kInit);
    bus.fpwr(station, 0x0806, zeros(1));
    bus.fpwr(station, 0x080E, zeros(1));
    bus.fpwr(station, 0x0800, sync_manager(Soem::kReceiveMailbox, length, 0x26));
    bus.fpwr(station, 0x0808, sync_manager(Soem::kTransmitMailbox, length, 0x22));
    soem.request(slave, Soem::kPreOperational);
    ASSERT_EQ(number(bus.fprd(station, 0x0130, 2).data), 0x02U);
  }
  /// A message through mailboxes of `length` bytes, and the answer.
  Bytes short_exchange(std::size_t slave, std::uint16_t length, Bytes message) {
    message.resize(length);
    EXPECT_EQ(bus.fpwr(Soem::station(slave), Soem::kReceiveMailbox, message).working_counter, 1U);
    return short_receive(slave, length);
  }
  Bytes short_receive(std::size_t slave, std::uint16_t length) {
    for (int poll = 0; poll < 100 && !soem.mailbox_full(slave); ++poll) {
      bus.pass(200_us);
    }
    const Answer answer = bus.fprd(Soem::station(slave), Soem::kTransmitMailbox, length);
    EXPECT_EQ(answer.working_counter, 1U);
    return part(answer.data, 0, 6 + number(part(answer.data, 0, 2)));
  }

  DeviceBus bus;
  Soem soem;
};

TEST_F(SoemMailbox, AnAnswerLeftByAnEarlierMasterIsDrainedBeforeTheRequest) {
  ASSERT_EQ(soem.send_mailbox(0, upload_message(0x1018, 1)), 1U);
  bus.pass(1_ms);
  ASSERT_TRUE(soem.mailbox_full(0));
  const Bytes answer = soem.upload(0, 0x1018, 2);
  EXPECT_EQ(number(upload_value(answer)), 3315U) << "not the answer of before";
}

TEST_F(SoemMailbox, AFullWriteMailboxCountsNothingUntilItsStatusBitFalls) {
  bus.set_firmware_running(false);
  Bytes message = upload_message(0x1018, 1);
  message.resize(Soem::kMailboxLength);
  EXPECT_EQ(bus.fpwr(Soem::station(0), Soem::kReceiveMailbox, message).working_counter, 1U);
  EXPECT_EQ(bus.fpwr(Soem::station(0), Soem::kReceiveMailbox, message).working_counter, 0U);
  EXPECT_EQ(number(bus.fprd(Soem::station(0), 0x0805, 1).data) & 0x08, 0x08U);
  bus.set_firmware_running(true);
  bus.pass(1_ms);
  EXPECT_EQ(number(bus.fprd(Soem::station(0), 0x0805, 1).data) & 0x08, 0x00U);
  EXPECT_EQ(number(upload_value(part(soem.receive_mailbox(0), 8))), 0x286U);
}

TEST_F(SoemMailbox, AShorterMessageIsTakenOnlyWithTheLastByteOfTheMailbox) {
  const Bytes message = upload_message(0x1018, 1);
  bus.fpwr(Soem::station(0), Soem::kReceiveMailbox, message);
  bus.pass(2_ms);
  EXPECT_FALSE(soem.mailbox_full(0)) << "the mailbox was not filled to its end";
  EXPECT_EQ(soem.send_mailbox(0, message), 1U);
  EXPECT_EQ(number(upload_value(part(soem.receive_mailbox(0), 8))), 0x286U);
}

TEST_F(SoemMailbox, TheFullBitReachesTheCyclicExchangeThroughItsFmmu) {
  soem.config_map();
  const std::size_t status = soem.image_length() - 2;
  const auto full = [&] {
    const Bytes image = soem.exchange(zeros(soem.image_length()))[0].data;
    return std::pair{(image[status] & std::byte{8}) != std::byte{0},
                     (image[status + 1] & std::byte{8}) != std::byte{0}};
  };
  EXPECT_EQ(full(), std::pair(false, false));
  soem.send_mailbox(1, upload_message(0x1018, 1));
  EXPECT_EQ(full(), std::pair(false, true));
  soem.receive_mailbox(1);
  EXPECT_EQ(full(), std::pair(false, false));
}

TEST_F(SoemMailbox, ALostReadIsRepeatedWithTheSameMessage) {
  soem.send_mailbox(0, upload_message(0x1008));
  bus.pass(1_ms);
  const Bytes lost = bus.fprd(Soem::station(0), Soem::kTransmitMailbox, Soem::kMailboxLength).data;
  for (int round = 0; round < 3; ++round) {
    // Status and activate byte go out together, the repeat bit toggled.
    Bytes status = bus.fprd(Soem::station(0), 0x080D, 2).data;
    status[1] ^= std::byte{0x02};
    EXPECT_EQ(bus.fpwr(Soem::station(0), 0x080D, status).working_counter, 1U);
    const auto acknowledged = [&] {
      return (bus.fprd(Soem::station(0), 0x080F, 1).data[0] & std::byte{2}) ==
             (status[1] & std::byte{2});
    };
    for (int poll = 0; poll < 100 && !acknowledged(); ++poll) {
      bus.pass(200_us);
    }
    ASSERT_TRUE(acknowledged());
    const Answer again = bus.fprd(Soem::station(0), Soem::kTransmitMailbox, Soem::kMailboxLength);
    EXPECT_EQ(again.working_counter, 1U);
    EXPECT_EQ(again.data, lost) << round;
  }
}

TEST_F(SoemMailbox, AnUnknownProtocolIsAnsweredByAMailboxErrorOfTypeZero) {
  soem.send_mailbox(0, soem.message(15, zeros(8)));
  const Bytes answer = soem.receive_mailbox(0);
  ASSERT_EQ(answer.size(), 10U);
  EXPECT_EQ(number(part(answer, 5, 1)) & 0x0F, 0U);
  EXPECT_EQ(number(part(answer, 6, 2)), 0x0001U);
  EXPECT_EQ(number(part(answer, 8, 2)), 0x0002U) << "unsupported protocol";
}

TEST_F(SoemMailbox, AnEmergencyInBetweenDoesNotReplaceTheAnswer) {
  EXPECT_EQ(soem.download(0, 0x607D, 1, 1000, 4), 0U);  // the axis stands at 0, outside
  bus.pass(2_ms);
  ASSERT_TRUE(soem.mailbox_full(0));
  // SOEM drains what it finds before a request, so the request is sent without that.
  Bytes request = upload_message(0x1018, 1);
  request.resize(Soem::kMailboxLength);
  EXPECT_EQ(bus.fpwr(Soem::station(0), Soem::kReceiveMailbox, request).working_counter, 1U);
  const Bytes emergency = soem.receive_mailbox(0);
  EXPECT_EQ(number(part(emergency, 6, 2)), 0x1000U);
  EXPECT_EQ(number(part(emergency, 8, 2)), 0xFF01U);
  const Bytes answer = soem.receive_mailbox(0);
  EXPECT_EQ(number(part(answer, 6, 2)), 0x3000U);
  EXPECT_EQ(number(upload_value(part(answer, 8))), 0x286U);
}

TEST_F(SoemMailbox, AnAbortHasCommandByte80AndTheIndexOfItsRequest) {
  for (const unsigned command : {0x40U, 0x50U, 0x2FU, 0x23U}) {
    const Bytes answer = soem.sdo(0, sdo_request(command, 0x5FFF, 0));
    ASSERT_EQ(answer.size(), 8U);
    EXPECT_EQ(answer[0], std::byte{0x80}) << std::hex << command;
    EXPECT_EQ(number(part(answer, 1, 2)), 0x5FFFU);
    EXPECT_EQ(number(part(answer, 4, 4)), 0x06020000U);
  }
}

TEST_F(SoemMailbox, ExpeditedAnswersTellTheirSize) {
  EXPECT_EQ(soem.upload(0, 0x1001, 0)[0], std::byte{0x4F}) << "one byte";
  EXPECT_EQ(soem.upload(0, 0x6041, 0)[0], std::byte{0x4B}) << "two bytes";
  EXPECT_EQ(soem.upload(0, 0x1018, 1)[0], std::byte{0x43}) << "four bytes";
}

TEST_F(SoemMailbox, ANormalAnswerHasItsLengthAndItsDataInOneMessage) {
  const Bytes answer = soem.upload(0, 0x1008, 0);
  EXPECT_EQ(answer[0], std::byte{0x41});
  EXPECT_EQ(number(part(answer, 4, 4)), 9U);
  EXPECT_EQ(to_hex(part(answer, 8)), "54 4D 43 4D 2D 33 33 31 35");
}

TEST_F(SoemMailbox, TheFirstAnswerOfASegmentedUploadCarriesDataAlready) {
  constexpr std::uint16_t kLength = 48;
  restart_with_mailbox_length(0, kLength);
  const Bytes first = short_exchange(0, kLength, soem.coe(2, sdo_request(0x50, 0x1600, 0)));
  EXPECT_EQ(first[8], std::byte{0x51}) << "size indicated, complete access";
  EXPECT_EQ(number(part(first, 12, 4)), 38U);
  EXPECT_EQ(first.size(), kLength) << "32 bytes of data in it";
  const Bytes second = short_exchange(0, kLength, soem.coe(2, sdo_request(0x60, 0, 0)));
  EXPECT_EQ(second[8], std::byte{0x03}) << "last segment, one of seven bytes unused";
  EXPECT_EQ(to_hex(part(second, 9, 6)), "7A 70 20 00 FF 70");
}

TEST_F(SoemMailbox, AnUploadAbandonedWithoutAbortLeavesTheMailboxUsable) {
  constexpr std::uint16_t kLength = 48;
  restart_with_mailbox_length(0, kLength);
  for (int round = 0; round < 3; ++round) {
    short_exchange(0, kLength, soem.coe(2, sdo_request(0x50, 0x1600, 0)));
    const Bytes next = short_exchange(0, kLength, upload_message(0x1018, 1));
    EXPECT_EQ(number(upload_value(part(next, 8))), 0x286U) << round;
  }
}

TEST_F(SoemMailbox, SubindexZeroOfEveryObjectOfSeveralEntriesIsReadable) {
  unsigned records = 0;
  for (const dictionary::Object& object : bus.device().dictionary().objects()) {
    if (object.entries.size() > 1) {
      const Bytes value = upload_value(soem.upload(0, object.index, 0));
      EXPECT_EQ(value.size(), 1U) << std::hex << object.index;
      ++records;
    }
  }
  EXPECT_GT(records, 10U);
}

TEST_F(SoemMailbox, TheObjectListInFragmentsCountsThoseThatAreLeft) {
  for (const std::uint16_t length : {Soem::kMailboxLength, std::uint16_t{128}}) {
    restart_with_mailbox_length(0, length);
    Bytes list;
    Bytes answer = short_exchange(0, length, soem.coe(8, hex("01 00 00 00 01 00")));
    auto left = number(part(answer, 10, 2));
    for (;;) {
      EXPECT_EQ(number(part(answer, 6, 2)), 0x8000U);
      EXPECT_EQ(answer[8], left == 0 ? std::byte{0x02} : std::byte{0x82});
      const Bytes fragment = part(answer, 12);
      list.insert(list.end(), fragment.begin(), fragment.end());
      if (left == 0) {
        break;
      }
      answer = short_receive(0, length);
      ASSERT_EQ(number(part(answer, 10, 2)), --left);
    }
    EXPECT_EQ(number(part(list, 0, 2)), 1U) << "list type";
    EXPECT_EQ(number(part(list, 2, 2)), 0x1000U);
    EXPECT_EQ(list.size(), 2 + 2 * bus.device().dictionary().objects().size());
  }
}

TEST_F(SoemMailbox, AnEntryIsDescribedWithAccessTypeAndName) {
  soem.send_mailbox(0, soem.coe(8, hex("03 00 00 00 18 10")));
  const Bytes object = soem.receive_mailbox(0);
  EXPECT_EQ(object[8], std::byte{0x04});
  EXPECT_EQ(number(part(object, 12, 2)), 0x1018U);
  EXPECT_EQ(number(part(object, 16, 1)), 3U) << "highest sub-index";
  EXPECT_EQ(number(part(object, 17, 1)), 9U) << "record";
  soem.send_mailbox(0, soem.coe(8, hex("05 00 00 00 18 10 01 07")));
  const Bytes entry = soem.receive_mailbox(0);
  EXPECT_EQ(entry[8], std::byte{0x06});
  EXPECT_EQ(number(part(entry, 14, 1)), 1U) << "sub-index";
  EXPECT_EQ(number(part(entry, 16, 2)), 0x0007U) << "UNSIGNED32";
  EXPECT_EQ(number(part(entry, 18, 2)), 32U) << "bits";
  EXPECT_EQ(number(part(entry, 20, 2)) & 0x3F, 0x07U) << "read only in all states";
  EXPECT_GT(entry.size(), 22U) << "name";
}

TEST_F(SoemMailbox, RepeatedReadsInOperationKeepTheCycleUndisturbed) {
  soem.config_map();
  soem.to_operational();
  for (int cycle = 0; cycle < 200; ++cycle) {
    ASSERT_EQ(soem.exchange(zeros(soem.image_length()))[0].working_counter,
              soem.expected_working_counter());
    if (cycle % 20 == 0) {
      EXPECT_EQ(number(upload_value(soem.upload(0, 0x1018, 2))), 3315U);
    }
    bus.pass(1_ms);
  }
  EXPECT_EQ(number(bus.brd(0x0130, 2).data), Soem::kOperational);
}

}  // namespace
}  // namespace stator::tests
