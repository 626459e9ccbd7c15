#include "stator/ethercat/eoe/eoe.hpp"

#include <deque>

#include "ethercat/stack_fixture.hpp"
#include "stator/base/random.hpp"

namespace stator::ethercat::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

/// A network that notes what it is told.
class RecordingPort final : public EthernetPort {
 public:
  void send(std::span<const std::byte> frame) override {
    sent.emplace_back(frame.begin(), frame.end());
  }
  std::size_t take(std::span<std::byte> buffer) override {
    if (waiting.empty()) {
      return 0;
    }
    const Bytes frame = waiting.front();
    waiting.pop_front();
    std::ranges::copy(frame, buffer.begin());
    return frame.size();
  }
  void set_ip_parameters(const IpParameters& parameters) override { ip.push_back(parameters); }

  std::vector<Bytes> sent;
  std::deque<Bytes> waiting;
  std::vector<IpParameters> ip;
};

Bytes frame_of(std::size_t length, unsigned seed = 0) {
  Bytes frame(length);
  for (std::size_t i = 0; i < length; ++i) {
    frame[i] = static_cast<std::byte>(i * 7 + seed);
  }
  return frame;
}

Bytes eoe_message(const EoeHeader& header, const Bytes& data = {}) {
  Bytes message(EoeHeader::kSize);
  header.encode(message);
  return concat({message, data});
}

/// A frame as a master sends it, in fragments of `size` bytes.
std::vector<Bytes> fragments_of(const Bytes& frame, std::size_t size, std::uint8_t frame_number) {
  std::vector<Bytes> fragments;
  for (std::size_t done = 0; done < frame.size(); done += size) {
    const std::size_t offset = fragments.empty() ? frame.size() + 31 : done;
    fragments.push_back(eoe_message({.last_fragment = done + size >= frame.size(),
                                     .fragment_number = static_cast<std::uint8_t>(fragments.size()),
                                     .offset = static_cast<std::uint8_t>(offset / 32),
                                     .frame_number = frame_number},
                                    part(frame, done, size)));
  }
  return fragments;
}

/// The server alone, as the mailbox sees it.
class EoeTest : public testing::Test {
 protected:
  EoeTest() { server.connect(&port); }

  /// The reply to `request`; empty if there is none.
  Bytes handle(const Bytes& request, base::SimTime now = base::SimTime()) {
    Bytes reply(room);
    const MailboxReply answer = server.handle(request, reply, now);
    error = answer.error;
    reply.resize(answer.length);
    return reply;
  }
  void deliver(const std::vector<Bytes>& fragments) {
    for (const Bytes& fragment : fragments) {
      EXPECT_THAT(handle(fragment), IsEmpty());
    }
  }
  std::vector<Bytes> messages() {
    std::vector<Bytes> all;
    while (server.has_message()) {
      Bytes message(room);
      message.resize(server.next_message(message, base::SimTime()));
      if (!message.empty()) {
        all.push_back(message);
      }
    }
    return all;
  }
  /// The frames in `messages`, put together by the rules of the standard, each checked.
  static std::vector<Bytes> reassemble(const std::vector<Bytes>& messages) {
    std::vector<Bytes> frames;
    Bytes frame;
    std::size_t size = 0;
    unsigned expected = 0;
    for (const Bytes& message : messages) {
      const EoeHeader header = EoeHeader::decode(message);
      const Bytes data = part(message, EoeHeader::kSize);
      EXPECT_EQ(header.type, EoeType::fragment);
      EXPECT_EQ(header.fragment_number, expected);
      EXPECT_FALSE(header.time_stamp_appended);
      EXPECT_EQ(header.frame_number, (frames.size() + 1) % 16);
      if (expected == 0) {
        size = header.offset * 32U;
      } else {
        EXPECT_EQ(header.offset * 32U, frame.size());
      }
      frame = concat({frame, data});
      if (header.last_fragment) {
        EXPECT_EQ(size, (frame.size() + 31) / 32 * 32);
        frames.push_back(frame);
        frame.clear();
        expected = 0;
      } else {
        EXPECT_EQ(data.size() % 32, 0U);
        ++expected;
      }
    }
    EXPECT_THAT(frame, IsEmpty()) << "the last frame is not complete";
    return frames;
  }

  EventLog log;
  RecordingPort port;
  EoeServer server{base::EventReporter(&log, 0)};
  std::size_t room = 122;  ///< behind the header of a mailbox of 128 bytes
  MailboxErrorCode error = MailboxErrorCode::none;
};

class EoeFrameLength : public EoeTest, public testing::WithParamInterface<std::size_t> {};

TEST_P(EoeFrameLength, FromTheMaster_ArrivesWhole) {
  const Bytes frame = frame_of(GetParam());
  deliver(fragments_of(frame, 96, 3));
  deliver(fragments_of(frame, 1504, 4));
  EXPECT_THAT(port.sent, ElementsAre(frame, frame));
  EXPECT_EQ(server.statistics().frames_received, 2U);
  EXPECT_EQ(server.statistics().receive_dropped, 0U);
}

TEST_P(EoeFrameLength, ToTheMaster_IsCutAt32ByteUnitsAndNumbered) {
  const Bytes frame = frame_of(GetParam());
  for (const std::size_t payload : {std::size_t{36}, std::size_t{118}, std::size_t{1500}}) {
    room = payload;
    EoeServer fresh{base::EventReporter()};
    fresh.queue_frame(frame);
    std::vector<Bytes> all;
    while (fresh.has_message()) {
      Bytes message(room);
      message.resize(fresh.next_message(message, base::SimTime()));
      all.push_back(message);
    }
    EXPECT_THAT(reassemble(all), ElementsAre(frame)) << "mailbox payload " << payload;
    const std::size_t per_fragment = (payload - 4) / 32 * 32;
    const std::size_t expected =
        frame.size() <= payload - 4
            ? 1
            : (frame.size() - (payload - 4) + per_fragment - 1) / per_fragment + 1;
    EXPECT_EQ(all.size(), expected) << "mailbox payload " << payload;
    EXPECT_EQ(fresh.statistics().frames_sent, 1U);
  }
}

INSTANTIATE_TEST_SUITE_P(AtTheBorders, EoeFrameLength,
                         testing::Values(1, 31, 32, 33, 63, 64, 65, 96, 97, 1514, 1518));

TEST_F(EoeTest, Header_LiesOnTheWireAsTheStandardDrawsIt) {
  // Type 0, port 3, last fragment, time stamp requested; fragment 2 at 4 * 32, frame 5.
  EXPECT_EQ(to_hex(eoe_message({.port = 3,
                                .last_fragment = true,
                                .time_stamp_requested = true,
                                .fragment_number = 2,
                                .offset = 4,
                                .frame_number = 5})),
            "30 05 02 51");
  const EoeHeader header = EoeHeader::decode(hex("39 02 FF FF"));
  EXPECT_EQ(header.type, EoeType::get_filter_response);
  EXPECT_EQ(header.port, 3);
  EXPECT_FALSE(header.last_fragment);
  EXPECT_TRUE(header.time_stamp_appended);
  EXPECT_EQ(header.fragment_number, 63);
  EXPECT_EQ(header.offset, 63);
  EXPECT_EQ(header.frame_number, 15);
}

TEST_F(EoeTest, AFragmentThatIsMissing_DropsItsFrameAndNotTheNext) {
  std::vector<Bytes> fragments = fragments_of(frame_of(300), 96, 1);
  fragments.erase(fragments.begin() + 1);
  deliver(fragments);
  EXPECT_THAT(port.sent, IsEmpty());
  EXPECT_EQ(server.statistics().receive_dropped, 1U);
  EXPECT_EQ(server.statistics().fragments_ignored, 1U);
  EXPECT_THAT(log.last("eoe-frame-dropped"), HasSubstr("expected fragment 1, got fragment 2"));

  deliver(fragments_of(frame_of(300), 96, 2));
  EXPECT_THAT(port.sent, ElementsAre(frame_of(300)));
}

TEST_F(EoeTest, FragmentsOutOfOrder_DropTheFrame) {
  std::vector<Bytes> fragments = fragments_of(frame_of(300), 96, 1);
  std::swap(fragments[1], fragments[2]);
  deliver(fragments);
  EXPECT_THAT(port.sent, IsEmpty());
  EXPECT_EQ(server.statistics().receive_dropped, 1U);
}

TEST_F(EoeTest, AnAbandonedFrame_GivesWayToANewOne) {
  std::vector<Bytes> abandoned = fragments_of(frame_of(300), 96, 1);
  abandoned.pop_back();
  deliver(abandoned);
  deliver(fragments_of(frame_of(200), 96, 2));
  EXPECT_THAT(port.sent, ElementsAre(frame_of(200)));
  EXPECT_EQ(server.statistics().receive_dropped, 1U);
}

TEST_F(EoeTest, AFragmentOfAnotherFrame_DropsTheOneInProgress) {
  std::vector<Bytes> fragments = fragments_of(frame_of(200), 96, 1);
  fragments[1] = fragments_of(frame_of(200), 96, 2)[1];
  deliver(fragments);
  EXPECT_THAT(port.sent, IsEmpty());
  EXPECT_EQ(server.statistics().receive_dropped, 1U);
}

TEST_F(EoeTest, AWrongOffset_DropsTheFrame) {
  std::vector<Bytes> fragments = fragments_of(frame_of(200), 96, 1);
  fragments[1][2] ^= std::byte{0x40};
  deliver(fragments);
  EXPECT_THAT(port.sent, IsEmpty());
  EXPECT_EQ(server.statistics().receive_dropped, 1U);
}

TEST_F(EoeTest, MoreThanAnnouncedOrThanAFrameCanHold_IsDropped) {
  handle(eoe_message({.last_fragment = true, .offset = 1}, frame_of(33)));
  handle(eoe_message({.last_fragment = true, .offset = 63}, frame_of(1519)));
  handle(eoe_message({.last_fragment = true, .offset = 0}, frame_of(1)));
  EXPECT_THAT(port.sent, IsEmpty());
  EXPECT_EQ(server.statistics().receive_dropped, 3U);
}

TEST_F(EoeTest, AnInnerFragmentThatIsNoMultipleOf32Bytes_IsDropped) {
  handle(eoe_message({.offset = 3}, frame_of(33)));
  EXPECT_EQ(server.statistics().receive_dropped, 1U);
  handle(eoe_message({.last_fragment = true, .offset = 3}));
  EXPECT_EQ(server.statistics().receive_dropped, 2U) << "an empty frame";
}

TEST_F(EoeTest, ManyLosses_AreToldOnceAndCounted) {
  for (int i = 0; i < 5; ++i) {
    handle(eoe_message({.last_fragment = true, .offset = 0}, frame_of(40)));
  }
  EXPECT_THAT(log.events, SizeIs(1));
  EXPECT_EQ(server.statistics().receive_dropped, 5U);
}

TEST_F(EoeTest, AnAppendedTimeStamp_IsNotPartOfTheFrame) {
  const Bytes frame = frame_of(32);
  handle(eoe_message({.last_fragment = true, .time_stamp_appended = true, .offset = 1},
                     concat({frame, hex("11 22 33 44")})));
  EXPECT_THAT(port.sent, ElementsAre(frame));
  handle(eoe_message({.last_fragment = true, .time_stamp_appended = true, .offset = 1},
                     hex("11 22 33")));
  EXPECT_THAT(port.sent, SizeIs(1));
}

TEST_F(EoeTest, ARequestedTimeStamp_IsAnsweredWithTheFramesNumber) {
  const base::SimTime now = base::SimTime() + base::SimDuration(0x1'2345'6789);
  EXPECT_EQ(to_hex(handle(eoe_message({.port = 2,
                                       .last_fragment = true,
                                       .time_stamp_requested = true,
                                       .offset = 2,
                                       .frame_number = 9},
                                      frame_of(60)),
                          now)),
            "21 01 00 90 89 67 45 23");
}

TEST_F(EoeTest, TimeStampsThatTheMasterWants_AreAppendedToTheLastFragment) {
  EXPECT_EQ(to_hex(handle(hex("02 01 00 00 00 00 01 00"))), "03 01 00 00");
  const base::SimTime now = base::SimTime() + base::SimDuration(0x1'2345'6789);
  const auto next = [&] {
    Bytes message(room);
    message.resize(server.next_message(message, now));
    return message;
  };
  server.queue_frame(frame_of(20));
  EXPECT_EQ(to_hex(next()), "00 03 40 10 " + to_hex(frame_of(20)) + " 89 67 45 23");

  room = 4 + 64;  // the frame alone would fit, the time stamp does not
  server.queue_frame(frame_of(64));
  EXPECT_EQ(to_hex(next()), "00 00 80 20 " + to_hex(part(frame_of(64), 0, 32)));
  EXPECT_EQ(to_hex(next()), "00 03 41 20 " + to_hex(part(frame_of(64), 32)) + " 89 67 45 23");
  EXPECT_FALSE(server.has_message());
}

TEST_F(EoeTest, WithoutANetwork_FramesEndHere) {
  server.connect(nullptr);
  deliver(fragments_of(frame_of(60), 96, 1));
  server.poll(true);
  EXPECT_EQ(server.statistics().frames_received, 1U);
}

TEST_F(EoeTest, SetIp_StoresReportsAndAnswersEveryParameter) {
  const Bytes request = concat({hex("12 01 00 00 3F 00 00 00"), hex("02 0A 0B 0C 0D 0E"),
                                hex("02 01 A8 C0"), hex("00 FF FF FF"), hex("FE 01 A8 C0"),
                                hex("08 08 08 08"), hex("67 61 6E 74 72 79"), Bytes(26)});
  EXPECT_EQ(to_hex(handle(request)), "13 01 00 00");
  const IpParameters& ip = server.ip_parameters();
  EXPECT_EQ(ip.mac_address, (MacAddress{2, 10, 11, 12, 13, 14}));
  EXPECT_EQ(ip.address, (Ipv4Address{192, 168, 1, 2}));
  EXPECT_EQ(ip.subnet_mask, (Ipv4Address{255, 255, 255, 0}));
  EXPECT_EQ(ip.default_gateway, (Ipv4Address{192, 168, 1, 254}));
  EXPECT_EQ(ip.dns_server, (Ipv4Address{8, 8, 8, 8}));
  EXPECT_STREQ(ip.dns_name->data(), "gantry");
  EXPECT_THAT(port.ip, ElementsAre(ip));
  EXPECT_THAT(log.last("eoe-address-set"), HasSubstr("192.168.1.2/24"));

  Bytes expected = request;
  expected[0] = std::byte{0x17};
  EXPECT_EQ(to_hex(handle(hex("16 01 00 00"))), to_hex(expected)) << "get IP reads it back";
}

TEST_F(EoeTest, SetIp_ChangesOnlyWhatTheRequestContains) {
  handle(hex("02 01 00 00 06 00 00 00 02 01 A8 C0 00 FF FF FF"));
  EXPECT_EQ(to_hex(handle(hex("02 01 00 00 02 00 00 00 03 01 A8 C0"))), "03 01 00 00");
  EXPECT_EQ(server.ip_parameters().address, (Ipv4Address{192, 168, 1, 3}));
  EXPECT_EQ(server.ip_parameters().subnet_mask, (Ipv4Address{255, 255, 255, 0}));
  EXPECT_EQ(to_hex(handle(hex("06 01 00 00"))), "07 01 00 00 06 00 00 00 03 01 A8 C0 00 FF FF FF");
}

TEST_F(EoeTest, SetIp_TakesAShortNameAndIgnoresWhatFollowsTheLastParameter) {
  EXPECT_EQ(to_hex(handle(hex("02 01 00 00 20 00 00 00 61 62"))), "03 01 00 00");
  EXPECT_STREQ(server.ip_parameters().dns_name->data(), "ab");
  EXPECT_EQ(to_hex(handle(concat({hex("02 01 00 00 02 00 00 00 01 00 00 0A"), Bytes(54)}))),
            "03 01 00 00");
  EXPECT_EQ(server.ip_parameters().address, (Ipv4Address{10, 0, 0, 1}));
}

/// As IgH sends it: every parameter has its place, those that are not included are zero.
Bytes block_with_gaps(std::uint8_t flags,
                      std::initializer_list<std::pair<std::size_t, const char*>> parameters) {
  Bytes block(kMaximumIpParameterBlock);
  block[0] = static_cast<std::byte>(flags);
  for (const auto& [offset, bytes] : parameters) {
    std::ranges::copy(hex(bytes), block.begin() + static_cast<std::ptrdiff_t>(offset));
  }
  return concat({hex("02 00 00 00"), block});
}

TEST_F(EoeTest, SetIp_WithGaps_TakesEveryParameterFromItsOwnPlace) {
  EXPECT_EQ(to_hex(handle(block_with_gaps(0x06, {{10, "37 4D A8 C0"}, {14, "00 FF FF FF"}}))),
            "03 01 00 00");
  EXPECT_EQ(server.ip_parameters().address, (Ipv4Address{192, 168, 77, 55}));
  EXPECT_EQ(server.ip_parameters().subnet_mask, (Ipv4Address{255, 255, 255, 0}));
  EXPECT_EQ(server.ip_parameters().mac_address, std::nullopt);
  EXPECT_THAT(log.last("eoe-address-set"), HasSubstr("192.168.77.55/24"));

  EXPECT_EQ(to_hex(handle(block_with_gaps(
                0x38, {{18, "01 4D A8 C0"}, {22, "08 08 08 08"}, {26, "67 61 6E 74 72 79"}}))),
            "03 01 00 00");
  EXPECT_EQ(server.ip_parameters().address, (Ipv4Address{192, 168, 77, 55})) << "kept";
  EXPECT_EQ(server.ip_parameters().default_gateway, (Ipv4Address{192, 168, 77, 1}));
  EXPECT_EQ(server.ip_parameters().dns_server, (Ipv4Address{8, 8, 8, 8}));
  EXPECT_STREQ(server.ip_parameters().dns_name->data(), "gantry");
}

TEST_F(EoeTest, SetIp_WithGaps_LooksAtNothingInThem) {
  EXPECT_EQ(to_hex(handle(block_with_gaps(
                0x02, {{4, "FF FF FF FF FF FF"}, {10, "37 4D A8 C0"}, {14, "FF 00 FF 00"}}))),
            "03 01 00 00");
  IpParameters expected;
  expected.address = {192, 168, 77, 55};
  EXPECT_EQ(server.ip_parameters(), expected);
}

TEST_F(EoeTest, SetIp_WithAMaskThatHasHoles_IsRefusedAndChangesNothing) {
  handle(hex("02 01 00 00 06 00 00 00 02 01 A8 C0 00 FF FF FF"));
  port.ip.clear();
  const IpParameters before = server.ip_parameters();
  for (const char* mask : {"00 FF 00 FF", "FF 00 00 00", "01 00 00 80", "00 FE FF 7F"}) {
    EXPECT_EQ(to_hex(handle(concat({hex("02 01 00 00 06 00 00 00 03 01 A8 C0"), hex(mask)}))),
              "03 01 02 04")
        << mask;
  }
  EXPECT_EQ(server.ip_parameters(), before);
  EXPECT_THAT(port.ip, IsEmpty());
  EXPECT_THAT(log.last("eoe-mask-refused"), HasSubstr("127.255.254.0 is no subnet mask"));
  for (const char* mask : {"00 00 00 00", "00 00 00 80", "FE FF FF FF", "FF FF FF FF"}) {
    EXPECT_EQ(to_hex(handle(concat({hex("02 01 00 00 04 00 00 00"), hex(mask)}))), "03 01 00 00")
        << mask;
  }
}

TEST_F(EoeTest, SetIp_ThatIsTooShortOrNamesAGroupAddress_IsRefusedAndChangesNothing) {
  handle(hex("02 01 00 00 02 00 00 00 02 01 A8 C0"));
  port.ip.clear();
  const IpParameters before = server.ip_parameters();
  for (const char* request :
       {"02 01 00 00", "02 01 00 00 02 00 00", "02 01 00 00 02 00 00 00 03 01 A8",
        "02 01 00 00 03 00 00 00 02 0A 0B 0C 0D", "02 01 00 00 01 00 00 00 03 0A 0B 0C 0D 0E"}) {
    EXPECT_EQ(to_hex(handle(hex(request))), "03 01 01 00") << request;
  }
  EXPECT_EQ(server.ip_parameters(), before);
  EXPECT_THAT(port.ip, IsEmpty());
  EXPECT_THAT(log.last("eoe-ip-refused"), HasSubstr("group address"));
}

TEST_F(EoeTest, GetIp_BeforeAnythingIsSet_ContainsNothing) {
  EXPECT_EQ(to_hex(handle(hex("06 01 00 00"))), "07 01 00 00 00 00 00 00");
}

TEST_F(EoeTest, GetIp_ThatDoesNotFitTheMailbox_IsAMailboxError) {
  handle(hex("02 01 00 00 20 00 00 00 61 62"));
  room = 30;
  EXPECT_THAT(handle(hex("06 01 00 00")), IsEmpty());
  EXPECT_EQ(error, MailboxErrorCode::no_more_memory);
}

TEST_F(EoeTest, MacFilters_AreAnsweredWithNoFilterSupport) {
  EXPECT_EQ(to_hex(handle(concat({hex("14 01 00 00 01 00"), Bytes(120)}))), "15 01 01 04");
  EXPECT_EQ(to_hex(handle(hex("08 01 00 00"))), "09 01 01 04");
  EXPECT_THAT(log.last("eoe-filter-refused"), HasSubstr("0401h"));
}

TEST_F(EoeTest, ResponsesUnknownTypesAndShortMessages_AreMailboxErrors) {
  for (const char* response :
       {"01 01 00 00 00 00 00 00", "03 01 00 00", "05 01 00 00", "07 01 00 00", "09 01 00 00"}) {
    EXPECT_THAT(handle(hex(response)), IsEmpty());
    EXPECT_EQ(error, MailboxErrorCode::service_not_supported) << response;
  }
  for (const char* unknown : {"0A 01 00 00", "0F 01 00 00"}) {
    EXPECT_THAT(handle(hex(unknown)), IsEmpty());
    EXPECT_EQ(error, MailboxErrorCode::invalid_header) << unknown;
  }
  EXPECT_THAT(handle(hex("00 01 00")), IsEmpty());
  EXPECT_EQ(error, MailboxErrorCode::size_too_short);
}

TEST_F(EoeTest, WhenTheQueueIsFull_TheOldestFrameGoes) {
  for (unsigned i = 0; i < EoeServer::kQueuedFrames + 2; ++i) {
    server.queue_frame(frame_of(60, i));
  }
  const std::vector<Bytes> frames = reassemble(messages());
  ASSERT_THAT(frames, SizeIs(EoeServer::kQueuedFrames));
  EXPECT_EQ(frames.front(), frame_of(60, 2));
  EXPECT_EQ(frames.back(), frame_of(60, EoeServer::kQueuedFrames + 1));
  EXPECT_EQ(server.statistics().send_dropped, 2U);
}

TEST_F(EoeTest, AFrameWhoseFragmentsAreOnTheWay_IsNotTheOneThatGoes) {
  server.queue_frame(frame_of(300));
  std::vector<Bytes> all{Bytes(room)};
  all[0].resize(server.next_message(all[0], base::SimTime()));
  for (unsigned i = 0; i < EoeServer::kQueuedFrames; ++i) {
    server.queue_frame(frame_of(60, i));
  }
  std::ranges::copy(messages(), std::back_inserter(all));
  EXPECT_EQ(reassemble(all).front(), frame_of(300));
  EXPECT_EQ(server.statistics().send_dropped, 0U);
}

TEST_F(EoeTest, FramesOfNoLegalLength_AreDropped) {
  server.queue_frame({});
  server.queue_frame(frame_of(1519));
  EXPECT_FALSE(server.has_message());
  EXPECT_EQ(server.statistics().send_dropped, 2U);
}

TEST_F(EoeTest, AMailboxTooSmallForAFragment_DropsTheFrame) {
  room = 35;
  server.queue_frame(frame_of(60));
  EXPECT_THAT(messages(), IsEmpty());
  EXPECT_EQ(server.statistics().send_dropped, 1U);
}

TEST_F(EoeTest, Polling_QueuesWhatWaitsWhileTheMailboxRunsAndElseLosesIt) {
  port.waiting = {frame_of(60, 1), frame_of(61, 2)};
  server.poll(false);
  EXPECT_FALSE(server.has_message());
  port.waiting = {frame_of(60, 3), frame_of(61, 4)};
  server.poll(true);
  EXPECT_THAT(reassemble(messages()), ElementsAre(frame_of(60, 3), frame_of(61, 4)));
}

TEST_F(EoeTest, Polling_LeavesFramesAtThePortWhileTheQueueIsFull) {
  port.waiting.assign(EoeServer::kQueuedFrames + 5, frame_of(60));
  server.poll(true);
  server.poll(true);
  EXPECT_EQ(port.waiting.size(), 5U);
  EXPECT_EQ(server.statistics().send_dropped, 0U);
  EXPECT_EQ(messages().size(), EoeServer::kQueuedFrames);
  server.poll(true);
  EXPECT_THAT(port.waiting, IsEmpty());
}

TEST_F(EoeTest, Reset_ForgetsFramesInBothDirectionsAndKeepsTheAddress) {
  handle(hex("02 01 00 00 02 00 00 00 02 01 A8 C0"));
  const std::vector<Bytes> fragments = fragments_of(frame_of(200), 96, 1);
  handle(fragments[0]);
  server.queue_frame(frame_of(300));
  Bytes message(room);
  (void)server.next_message(message, base::SimTime());
  server.queue_frame(frame_of(60));
  server.reset();
  EXPECT_FALSE(server.has_message());
  handle(fragments[1]);
  handle(fragments[2]);
  EXPECT_THAT(port.sent, IsEmpty());
  EXPECT_TRUE(server.ip_parameters().address.has_value());
}

class EoeFuzz : public EoeTest, public testing::WithParamInterface<int> {};

TEST_P(EoeFuzz, AnyFragments_LeaveTheServerReceiving) {
  base::Random random{static_cast<std::uint64_t>(GetParam())};
  for (unsigned i = 0; i < 5'000; ++i) {
    std::vector<Bytes> fragments =
        fragments_of(frame_of(1 + random.below(1518), i), 32 * (1 + random.below(47)),
                     static_cast<std::uint8_t>(i % 16));
    const bool intact = random.below(2) == 0;
    if (!intact) {
      Bytes& victim = fragments[random.below(fragments.size())];
      victim[random.below(std::min<std::size_t>(victim.size(), 6))] ^=
          static_cast<std::byte>(1U << random.below(8));
      if (random.below(4) == 0) {
        victim.resize(random.below(victim.size() + 1));
      }
      if (random.below(4) == 0) {
        std::swap(fragments.front(), fragments[random.below(fragments.size())]);
      }
    }
    const std::size_t before = port.sent.size();
    for (const Bytes& fragment : fragments) {
      handle(fragment);
    }
    if (intact) {
      ASSERT_EQ(port.sent.size(), before + 1) << "frame " << i;
    }
    for (const Bytes& frame : port.sent) {
      ASSERT_GE(frame.size(), 1U);
      ASSERT_LE(frame.size(), 1518U);
    }
    port.sent.clear();
  }
  for (unsigned i = 0; i < 5'000; ++i) {
    Bytes noise(random.below(118));
    std::ranges::generate(noise, [&] { return static_cast<std::byte>(random.next()); });
    handle(noise);
  }
  port.sent.clear();
  deliver(fragments_of(frame_of(1518), 96, 5));
  EXPECT_THAT(port.sent, ElementsAre(frame_of(1518)));
}

INSTANTIATE_TEST_SUITE_P(Seeds, EoeFuzz, testing::Range(1, 6));

DeviceDescription device_with_eoe() {
  DeviceDescription description = test_description();
  description.eoe = true;
  return description;
}

/// The server inside a slave, reached through the mailboxes.
class EoeOverMailbox : public StackFixture {
 protected:
  EoeOverMailbox() : StackFixture(device_with_eoe()) { stack.eoe()->connect(&port); }
  ~EoeOverMailbox() override { stack.eoe()->connect(nullptr); }

  RecordingPort port;
};

TEST_F(EoeOverMailbox, FramesPassBothWaysInFragments) {
  go_pre_operational();
  unsigned counter = 1;
  for (const Bytes& fragment : fragments_of(frame_of(300), 96, 1)) {
    EXPECT_THAT(exchange(message(2, fragment, counter++)), IsEmpty());
  }
  EXPECT_THAT(port.sent, ElementsAre(frame_of(300)));

  port.waiting = {frame_of(200)};
  Bytes received;
  for (unsigned fragment = 0; fragment < 2; ++fragment) {
    process();
    const Bytes mail = controller.read_mailbox();
    ASSERT_GT(mail.size(), 10U);
    EXPECT_EQ(std::to_integer<unsigned>(mail[5]) & 0x0F, 2U);
    EXPECT_EQ(EoeHeader::decode(part(mail, 6)).fragment_number, fragment);
    received = concat({received, part(mail, 10)});
  }
  EXPECT_EQ(received, frame_of(200));
}

TEST_F(EoeOverMailbox, InInit_FramesOfTheNetworkAreLost) {
  port.waiting = {frame_of(60)};
  process();
  EXPECT_THAT(port.waiting, IsEmpty());
  go_pre_operational();
  process();
  EXPECT_THAT(controller.read_mailbox(), IsEmpty());
}

TEST_F(EoeOverMailbox, EoeAndCoeShareTheMailbox) {
  go_pre_operational();
  EXPECT_EQ(to_hex(part(exchange(message(2, hex("06 01 00 00"))), 6)), "07 01 00 00 00 00 00 00");
  EXPECT_EQ(to_hex(sdo("40 00 10 00 00 00 00 00")), "43 00 10 00 92 01 FC FF");
}

TEST_F(StackFixture, ADeviceWithoutEoe_AnswersItWithAMailboxError) {
  go_pre_operational();
  EXPECT_EQ(stack.eoe(), nullptr);
  EXPECT_EQ(to_hex(part(exchange(message(2, hex("06 01 00 00"), 1)), 6)), "01 00 02 00");
}

}  // namespace
}  // namespace stator::ethercat::test
