// The mailbox of a complete device: any messages in any state, torn accesses, repeat requests and
// state changes between them. Whatever came, the master gets the device back to Pre-Operational and
// an answer to an SDO request.

#include <array>
#include <cstdint>

#include "bus.hpp"
#include "input.hpp"
#include "stator/base/byte_order.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"

namespace {

using namespace stator;
using namespace stator::ethercat;
using stator::fuzz::Bus;
using stator::fuzz::Input;
using stator::fuzz::require;

constexpr std::uint32_t kAlControl = physical_address(0, 0x0120);
constexpr std::uint32_t kAlStatus = physical_address(0, 0x0130);
constexpr std::size_t kMailboxHeader = 6;

/// The device on a cable of its own, and the moves of a master.
class Session {
 public:
  Session() : bus_(segment_) {
    segment_.append(device_.controller());
    settle();
  }

  /// Time enough for the firmware, little for the physics, which are not what is tested.
  void settle() { wait(base::SimDuration(50'000)); }
  void wait(base::SimDuration duration) {
    bus_.wait(duration);
    device_.advance(bus_.now());
  }
  unsigned transfer(Command command, std::uint32_t address, std::span<std::byte> data) {
    const unsigned working_counter = bus_.transfer(command, address, data);
    device_.handle_bus_events(bus_.now());
    return working_counter;
  }
  unsigned write(std::uint16_t address, std::span<std::byte> data) {
    return transfer(Command::apwr, physical_address(0, address), data);
  }
  unsigned read(std::uint16_t address, std::span<std::byte> data) {
    return transfer(Command::aprd, physical_address(0, address), data);
  }

  void request_state(std::uint8_t control) {
    std::array<std::byte, 2> data{std::byte{control}};
    transfer(Command::apwr, kAlControl, data);
    settle();
  }
  unsigned state() {
    std::array<std::byte, 2> data{};
    transfer(Command::aprd, kAlStatus, data);
    return std::to_integer<unsigned>(data[0]);
  }

  /// Sets SM0 and SM1 as the SII says, for Bootstrap or for the other states.
  void configure_mailbox(bool bootstrap) {
    const DeviceDescription& description = device_.description();
    receive_ = bootstrap ? description.bootstrap_receive_mailbox : description.receive_mailbox;
    transmit_ = bootstrap ? description.bootstrap_transmit_mailbox : description.transmit_mailbox;
    set_sync_manager(0x0800, receive_, 0x26);
    set_sync_manager(0x0808, transmit_, 0x22);
  }
  void open(bool bootstrap) {
    request_state(0x11);
    configure_mailbox(bootstrap);
    request_state(bootstrap ? 0x13 : 0x12);
  }

  unsigned send_message(std::span<std::byte> message) { return write(receive_.offset, message); }
  unsigned fetch_message(std::span<std::byte> message) { return read(transmit_.offset, message); }
  [[nodiscard]] const MailboxArea& receive_mailbox() const { return receive_; }
  [[nodiscard]] const MailboxArea& transmit_mailbox() const { return transmit_; }

 private:
  void set_sync_manager(std::uint16_t address, const MailboxArea& area, std::uint8_t control) {
    std::array<std::byte, 8> registers{};
    write(static_cast<std::uint16_t>(address + 6), std::span(registers).first(1));
    base::store_le(registers, 0, area.offset);
    base::store_le(registers, 2, area.length);
    registers[4] = std::byte{control};
    registers[6] = std::byte{area.length != 0};
    write(address, registers);
  }

  static devices::Tmcm3315Configuration everything() {
    devices::Tmcm3315Configuration configuration;
    configuration.coe.ethernet_over_ethercat = true;
    configuration.coe.firmware_erase_time = base::SimDuration(1'000'000);
    return configuration;
  }

  devices::Tmcm3315 device_{everything()};
  Segment segment_;
  Bus bus_;
  MailboxArea receive_;
  MailboxArea transmit_;
};

void send_message(Input& input, Session& session, bool well_formed) {
  std::array<std::byte, 1024> message{};
  const std::size_t mailbox = session.receive_mailbox().length;
  std::size_t payload = input.word() % 600;
  const std::span<std::byte> body = std::span(message).subspan(kMailboxHeader, payload);
  if (well_formed) {
    base::store_le(message, 0, static_cast<std::uint16_t>(payload));
    message[5] = std::byte{input.byte()};
    input.fill(body);
  } else {
    input.fill(std::span(message).first(kMailboxHeader + payload));
  }
  session.send_message(std::span(message).first(mailbox));
}

void run_step(Input& input, Session& session) {
  std::array<std::byte, 1024> data{};
  switch (input.below(10)) {
    case 0:
      send_message(input, session, false);
      break;
    case 1:
    case 2:
    case 3:
      send_message(input, session, true);
      session.settle();
      break;
    case 4:
    case 5:
      session.fetch_message(std::span(data).first(session.transmit_mailbox().length));
      break;
    case 6: {  // part of a mailbox, or any other memory
      const std::uint16_t address = static_cast<std::uint16_t>(0x1000 + input.word() % 0x1400);
      const std::span<std::byte> part = std::span(data).first(1 + input.below(64));
      input.fill(part);
      input.below(2) == 0 ? session.read(address, part) : session.write(address, part);
      break;
    }
    case 7: {  // any bits of a sync manager's activate register: repeat request, off, on
      data[0] = std::byte{input.byte()};
      session.write(static_cast<std::uint16_t>(0x0806 + 8 * input.below(4)),
                    std::span(data).first(1));
      break;
    }
    case 8:
      session.request_state(input.byte());
      break;
    default:
      session.wait(base::SimDuration(std::int64_t{input.byte()} * 1'000'000));
      break;
  }
}

/// An upload of the device type, as a master does it after a restart.
void require_answer(Session& session) {
  session.open(false);
  require(session.state() == 0x02);
  std::array<std::byte, 1024> message{};
  const std::span<std::byte> request = std::span(message).first(session.receive_mailbox().length);
  base::store_le(request, 0, std::uint16_t{10});
  request[5] = std::byte{0x13};
  base::store_le(request, kMailboxHeader, std::uint16_t{0x2000});
  request[kMailboxHeader + 2] = std::byte{0x40};
  base::store_le(request, kMailboxHeader + 3, std::uint16_t{0x1000});
  require(session.send_message(request) == 1);
  for (int polls = 0; polls < 16; ++polls) {
    session.settle();
    const std::span<std::byte> answer = std::span(message).first(session.transmit_mailbox().length);
    if (session.fetch_message(answer) == 1 &&
        base::load_le<std::uint16_t>(answer, kMailboxHeader) == 0x3000) {
      require(base::load_le<std::uint16_t>(answer, kMailboxHeader + 3) == 0x1000);
      return;
    }
  }
  require(false);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input({data, size});
  Session session;
  session.open(input.below(4) == 3);
  while (!input.empty()) {
    run_step(input, session);
  }
  require_answer(session);
  return 0;
}
