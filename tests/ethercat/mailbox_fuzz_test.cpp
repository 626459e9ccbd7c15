#include "ethercat/stack_fixture.hpp"
#include "stator/base/random.hpp"

namespace stator::ethercat::test {
namespace {

/// Random and half-valid messages: the slave must survive, keep to the buffer protocol and answer a
/// regular request afterwards.
class MailboxFuzz : public StackFixture, public testing::WithParamInterface<int> {
 protected:
  base::Random random{static_cast<std::uint64_t>(GetParam())};

  std::uint8_t any() { return static_cast<std::uint8_t>(random.next()); }
  Bytes random_bytes(std::size_t size) {
    Bytes bytes(size);
    std::ranges::generate(bytes, [this] { return static_cast<std::byte>(any()); });
    return bytes;
  }
  std::uint16_t some_index() {
    const auto objects = dictionary.objects();
    return random.below(8) == 0 ? static_cast<std::uint16_t>(random.next())
                                : objects[random.below(objects.size())].index;
  }
  Bytes almost_sdo() {
    const std::uint8_t commands[] = {0x40, 0x50, 0x60, 0x70, 0x21, 0x31, 0x23, 0x2B, 0x2F, 0x22,
                                     0x33, 0x3F, 0x00, 0x01, 0x10, 0x11, 0x0F, 0x80, 0xA0, any()};
    const std::uint32_t sizes[] = {
        0, 1, 2, 4, 8, 38, 300, 802, 0xFFFFFFFF, static_cast<std::uint32_t>(random.next())};
    return concat({hex("00 20"),
                   {static_cast<std::byte>(commands[random.below(std::size(commands))])},
                   le(some_index()),
                   le(static_cast<std::uint8_t>(random.below(12))),
                   le(sizes[random.below(std::size(sizes))]),
                   random_bytes(random.below(112))});
  }
  Bytes almost_information() {
    return concat(
        {hex("00 80"),
         {static_cast<std::byte>(random.below(8))},
         Bytes(3),
         le(random.below(2) == 0 ? some_index() : static_cast<std::uint16_t>(random.below(8))),
         le(static_cast<std::uint8_t>(random.below(12))),
         le(any())});
  }
  Bytes any_message() {
    switch (random.below(4)) {
      case 0:
        return random_bytes(random.below(140));
      case 1:
        return message(static_cast<unsigned>(random.below(16)), random_bytes(random.below(122)),
                       static_cast<unsigned>(random.below(8)));
      case 2:
        return message(3, almost_information(), static_cast<unsigned>(random.below(8)));
      default:
        return message(3, almost_sdo(), static_cast<unsigned>(random.below(8)));
    }
  }
  void disturb() {
    switch (random.below(40)) {
      case 0:
        controller.toggle_repeat_request();
        break;
      case 1:
        stack.send_emergency(0x1000, 1, {}, now);
        break;
      case 2:
        request(0x11);
        configure_mailbox();
        request(0x12);
        break;
      default:
        break;
    }
  }
};

TEST_P(MailboxFuzz, AnyMessages_LeaveTheSlaveAnswering) {
  go_pre_operational();
  for (int i = 0; i < 4'000; ++i) {
    controller.write_mailbox(any_message());
    disturb();
    process();
    if (random.below(4) != 0) {
      controller.read_mailbox();
    }
    ASSERT_EQ(controller.violations(), 0U) << "step " << i;
  }
  request(0x11);
  configure_mailbox();
  request(0x12);
  ASSERT_EQ(controller.al_status(), 0x02U);
  EXPECT_EQ(to_hex(sdo("40 00 10 00 00 00 00 00")), "43 00 10 00 92 01 FC FF");
  EXPECT_GT(stack.statistics().mailbox_received, 0U);
}

TEST_P(MailboxFuzz, AnyStatesAndSettings_LeaveTheSlaveReachable) {
  for (int i = 0; i < 2'000; ++i) {
    switch (random.below(6)) {
      case 0:
        request(static_cast<unsigned>(random.below(64)));
        break;
      case 1:
        controller.set_sync_manager(static_cast<unsigned>(random.below(4)),
                                    static_cast<std::uint16_t>(0x1000 + random.below(0x2000)),
                                    static_cast<std::uint16_t>(random.below(200)), any(),
                                    random.below(4) != 0);
        break;
      case 2:
        configure_mailbox();
        break;
      case 3:
        configure_process_data();
        break;
      case 4:
        controller.expire_watchdog();
        break;
      default:
        now = now + base::SimDuration(1'000'000);
        break;
    }
    process();
    stack.publish_inputs(now);
    ASSERT_TRUE(to_al_state(controller.al_status() & 0x0F));
    ASSERT_EQ((controller.al_status() & 0x10) != 0, controller.al_status_code() != 0);
  }
  controller.set_word(0x0440, 1);
  request(0x11);
  go_operational();
}

INSTANTIATE_TEST_SUITE_P(Seeds, MailboxFuzz, testing::Range(1, 6));

}  // namespace
}  // namespace stator::ethercat::test
