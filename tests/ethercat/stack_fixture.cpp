#include "ethercat/stack_fixture.hpp"

namespace stator::ethercat::test {

namespace {

using namespace dictionary;

constexpr std::array<std::int64_t, 4> kModes{0, 1, 3, 8};
constexpr Range kByte{0, 255};

EntryDeclaration record_entry(std::uint16_t index, std::uint8_t subindex, std::string_view name,
                              DataType type, Access access, Default value) {
  EntryDeclaration entry;
  entry.index = index;
  entry.subindex = subindex;
  entry.name = name;
  entry.object_code = ObjectCode::record;
  entry.type = type;
  entry.access = access;
  entry.default_value = value;
  return entry;
}

EntryDeclaration variable(std::uint16_t index, std::string_view name, DataType type, Access access,
                          PdoMapping mapping, Default value) {
  EntryDeclaration entry = record_entry(index, 0, name, type, access, value);
  entry.object_code = ObjectCode::variable;
  entry.mapping = mapping;
  return entry;
}

void add_pdo(std::vector<EntryDeclaration>& out, std::uint16_t index, std::string_view name,
             std::uint8_t size, std::initializer_list<std::uint32_t> mapped) {
  EntryDeclaration count = record_entry(index, 0, "Number of mapped objects", DataType::unsigned8,
                                        Access::read_write, mapped.size());
  count.object_name = name;
  count.range = Range{0, size};
  count.write_states = kPreOperationalOnly;
  out.push_back(count);
  const auto* next = mapped.begin();
  for (std::uint8_t subindex = 1; subindex <= size; ++subindex) {
    const std::uint32_t value = next != mapped.end() ? *next++ : 0;
    EntryDeclaration entry = record_entry(index, subindex, "Mapping entry", DataType::unsigned32,
                                          Access::read_write, value);
    entry.write_states = kPreOperationalOnly;
    out.push_back(entry);
  }
}

void add_assignment(std::vector<EntryDeclaration>& out, std::uint16_t index, std::uint16_t pdo,
                    std::uint8_t size) {
  EntryDeclaration count =
      record_entry(index, 0, "Number of assigned PDOs", DataType::unsigned8, Access::read_write, 1);
  count.range = Range{0, size};
  out.push_back(count);
  for (std::uint8_t subindex = 1; subindex <= size; ++subindex) {
    out.push_back(record_entry(index, subindex, "Assigned PDO", DataType::unsigned16,
                               Access::read_write, subindex == 1 ? pdo : 0));
  }
}

void add_communication_objects(std::vector<EntryDeclaration>& out) {
  out.push_back(variable(0x1000, "Device type", DataType::unsigned32, Access::read_only,
                         PdoMapping::no, dictionary::hex(0xFFFC0192)));
  out.push_back(variable(0x1001, "Error register", DataType::unsigned8, Access::read_only,
                         PdoMapping::no, 0));
  out.push_back(variable(0x1008, "Manufacturer device name", DataType::visible_string,
                         Access::constant, PdoMapping::no, "TMCM-3315"));
  EntryDeclaration identity =
      record_entry(0x1018, 0, "Number of entries", DataType::unsigned8, Access::read_only, 3);
  identity.object_name = "Identity";
  out.push_back(identity);
  out.push_back(record_entry(0x1018, 1, "Vendor ID", DataType::unsigned32, Access::read_only,
                             dictionary::hex(0x286)));
  out.push_back(
      record_entry(0x1018, 2, "Product code", DataType::unsigned32, Access::read_only, 3315));
  out.push_back(record_entry(0x1018, 3, "Revision", DataType::unsigned32, Access::read_only,
                             dictionary::hex(0x00010009)));
  add_pdo(out, 0x1600, "RxPDO 1", 9,
          {0x60400010, 0x607A0020, 0x60FF0020, 0x68400010, 0x687A0020, 0x68FF0020, 0x70400010,
           0x707A0020, 0x70FF0020});
  add_pdo(out, 0x1601, "RxPDO 2", 4, {0x60600008});
  add_pdo(out, 0x1A00, "TxPDO 1", 9,
          {0x60410010, 0x60640020, 0x606C0020, 0x68410010, 0x68640020, 0x686C0020, 0x70410010,
           0x70640020, 0x706C0020});
  add_pdo(out, 0x1A01, "TxPDO 2", 4, {0x60610008});
  out.push_back(
      record_entry(0x1C00, 0, "Number of entries", DataType::unsigned8, Access::read_write, 4));
  for (std::uint8_t subindex = 1; subindex <= 4; ++subindex) {
    out.push_back(record_entry(0x1C00, subindex, "Sync manager type", DataType::unsigned8,
                               Access::read_write, subindex));
  }
  add_assignment(out, 0x1C12, 0x1600, 2);
  add_assignment(out, 0x1C13, 0x1A00, 2);
}

void add_axis_objects(std::vector<EntryDeclaration>& out) {
  for (const int offset : {0x0000, 0x0800, 0x1000}) {
    const auto at = [offset](int index) { return static_cast<std::uint16_t>(index + offset); };
    out.push_back(variable(at(0x6040), "Controlword", DataType::unsigned16, Access::read_write,
                           PdoMapping::receive, 0));
    out.push_back(variable(at(0x6041), "Statusword", DataType::unsigned16, Access::read_only,
                           PdoMapping::transmit, 0));
    out.push_back(variable(at(0x6064), "Position actual value", DataType::integer32,
                           Access::read_only, PdoMapping::transmit, 0));
    out.push_back(variable(at(0x606C), "Velocity actual value", DataType::integer32,
                           Access::read_only, PdoMapping::transmit, 0));
    out.push_back(variable(at(0x607A), "Target position", DataType::integer32, Access::read_write,
                           PdoMapping::receive, 0));
    out.push_back(variable(at(0x60FF), "Target velocity", DataType::integer32, Access::read_write,
                           PdoMapping::receive, 0));
  }
  EntryDeclaration mode = variable(0x6060, "Modes of operation", DataType::integer8,
                                   Access::read_write, PdoMapping::receive, 0);
  mode.legal_values = kModes;
  out.push_back(mode);
  out.push_back(variable(0x6061, "Modes of operation display", DataType::integer8,
                         Access::read_only, PdoMapping::transmit, 0));
}

void add_manufacturer_objects(std::vector<EntryDeclaration>& out) {
  EntryDeclaration resolution = variable(0x2000, "Microstep resolution", DataType::unsigned8,
                                         Access::read_write, PdoMapping::no, 8);
  resolution.range = Range{0, 8};
  out.push_back(resolution);
  EntryDeclaration current = variable(0x2003, "Maximum current", DataType::unsigned8,
                                      Access::read_write, PdoMapping::no, 128);
  current.range = kByte;
  out.push_back(current);
  EntryDeclaration switches = variable(0x2005, "Limit switches", DataType::unsigned32,
                                       Access::read_write, PdoMapping::no, 0);
  switches.range = Range{2, 63};
  switches.default_value = 3;
  switches.unit = "ms";
  out.push_back(switches);
  EntryDeclaration command =
      variable(0x2010, "Command", DataType::unsigned16, Access::write_only, PdoMapping::no, 0x55);
  out.push_back(command);
  out.push_back(variable(0x2011, "Label", DataType::visible_string, Access::read_write,
                         PdoMapping::no, "abc"));
  out.push_back(
      variable(0x2012, "Empty", DataType::visible_string, Access::read_only, PdoMapping::no, ""));
  out.push_back(variable(0x2013, "Clock", DataType::unsigned64, Access::read_write, PdoMapping::no,
                         dictionary::hex(0x1122334455667788)));
  EntryDeclaration state_bound =
      variable(0x2014, "Setting", DataType::unsigned16, Access::read_write, PdoMapping::no, 0);
  state_bound.write_states = kPreOperationalOnly;
  out.push_back(state_bound);
  out.push_back(
      variable(0x2015, "Switch", DataType::boolean, Access::read_write, PdoMapping::receive, 0));

  // A record with bits, a gap, a read-only and a write-only entry.
  out.push_back(
      record_entry(0x2020, 0, "Number of entries", DataType::unsigned8, Access::read_only, 7));
  out.push_back(record_entry(0x2020, 1, "Bit A", DataType::boolean, Access::read_write, 1));
  out.push_back(record_entry(0x2020, 2, "Bit B", DataType::boolean, Access::read_write, 0));
  out.push_back(record_entry(0x2020, 3, "Bit C", DataType::boolean, Access::read_write, 1));
  out.push_back(record_entry(0x2020, 4, "Word", DataType::unsigned16, Access::read_write,
                             dictionary::hex(0x1234)));
  out.push_back(record_entry(0x2020, 6, "Fixed", DataType::unsigned8, Access::read_only,
                             dictionary::hex(0x77)));
  out.push_back(record_entry(0x2020, 7, "Secret", DataType::unsigned16, Access::write_only,
                             dictionary::hex(0xBEEF)));

  EntryDeclaration count =
      record_entry(0x3000, 0, "Number of entries", DataType::unsigned8, Access::read_only, 200);
  count.object_code = ObjectCode::array;
  count.object_name = "Table";
  out.push_back(count);
  for (unsigned subindex = 1; subindex <= 200; ++subindex) {
    EntryDeclaration element =
        record_entry(0x3000, static_cast<std::uint8_t>(subindex), "Element", DataType::unsigned32,
                     Access::read_write, subindex * 0x01010101U);
    element.object_code = ObjectCode::array;
    out.push_back(element);
  }
}

const std::vector<EntryDeclaration>& declarations() {
  static const std::vector<EntryDeclaration> all = [] {
    std::vector<EntryDeclaration> out;
    add_communication_objects(out);
    add_manufacturer_objects(out);
    add_axis_objects(out);
    return out;
  }();
  return all;
}

}  // namespace

void FakeController::set_full(unsigned channel, bool full) {
  std::byte& status = memory_[0x0805 + channel * 8];
  status = full ? status | std::byte{8} : status & ~std::byte{8};
}

void FakeController::raise(std::uint32_t event, unsigned channel) {
  if ((memory_[0x0804 + channel * 8] & std::byte{0x20}) != std::byte{0}) {
    events_ |= event;
  }
}

void FakeController::read(std::uint16_t address, std::span<std::byte> out) {
  std::copy_n(memory_.begin() + address, out.size(), out.begin());
  const auto covers = [&](std::uint32_t at) { return at >= address && at < address + out.size(); };
  if (covers(0x0120)) {
    events_ &= ~al_event::kAlControl;
  }
  if (covers(0x0806)) {
    events_ &= ~al_event::kSyncManagerActivation;
  }
  if (covers(0x0440)) {
    events_ &= ~al_event::kProcessDataWatchdog;
  }
  if (length_of(0) != 0 && covers(start_of(0))) {
    violations_ += mailbox_full(0) ? 0 : 1;
    events_ &= ~al_event::sync_manager(0);
  }
  if (length_of(0) != 0 && covers(start_of(0) + length_of(0) - 1U)) {
    set_full(0, false);
  }
  if (length_of(2) != 0 && covers(start_of(2))) {
    events_ &= ~al_event::sync_manager(2);
    memory_[0x0815] &= ~std::byte{1};
  }
}

void FakeController::write(std::uint16_t address, std::span<const std::byte> data) {
  const auto covers = [&](std::uint32_t at) { return at >= address && at < address + data.size(); };
  const bool in_mailbox =
      length_of(1) != 0 && address >= start_of(1) && address < start_of(1) + length_of(1);
  if (in_mailbox && mailbox_full(1)) {
    ++violations_;  // the buffer belongs to the master
    return;
  }
  std::ranges::copy(data, memory_.begin() + address);
  if (in_mailbox && covers(start_of(1))) {
    events_ &= ~al_event::sync_manager(1);
  }
  if (in_mailbox && covers(start_of(1) + length_of(1) - 1U)) {
    set_full(1, true);
  }
  if (covers(0x080F) && (memory_[0x080F] & std::byte{1}) != std::byte{0}) {
    set_full(1, false);
  }
}

void FakeController::request_state(unsigned al_control) {
  set_word(0x0120, static_cast<std::uint16_t>(al_control));
  events_ |= al_event::kAlControl;
}

void FakeController::set_sync_manager(unsigned channel, std::uint16_t start, std::uint16_t length,
                                      std::uint8_t control, bool enable) {
  const auto base_address = static_cast<std::uint16_t>(0x0800 + channel * 8);
  set_word(base_address, start);
  set_word(static_cast<std::uint16_t>(base_address + 2), length);
  memory_[base_address + 4U] = static_cast<std::byte>(control);
  memory_[base_address + 5U] = std::byte{0};
  memory_[base_address + 6U] = static_cast<std::byte>(enable ? 1 : 0);
  events_ &= ~al_event::sync_manager(channel);
  events_ |= al_event::kSyncManagerActivation;
}

bool FakeController::write_mailbox(std::span<const std::byte> message) {
  if (mailbox_full(0)) {
    return false;
  }
  const auto area = std::span(memory_).subspan(start_of(0), length_of(0));
  std::ranges::fill(area, std::byte{0});
  std::ranges::copy(message.first(std::min(message.size(), area.size())), area.begin());
  set_full(0, true);
  raise(al_event::sync_manager(0), 0);
  return true;
}

Bytes FakeController::read_mailbox() {
  if (!mailbox_full(1)) {
    return {};
  }
  const auto area = std::span(memory_).subspan(start_of(1), length_of(1));
  const std::size_t length = 6U + base::load_le<std::uint16_t>(area, 0);
  EXPECT_LE(length, area.size()) << "a message longer than the mailbox";
  set_full(1, false);
  raise(al_event::sync_manager(1), 1);
  return {area.begin(), area.begin() + static_cast<std::ptrdiff_t>(std::min(length, area.size()))};
}

void FakeController::toggle_repeat_request() {
  memory_[0x080E] ^= std::byte{2};
  events_ |= al_event::kSyncManagerActivation;
}

void FakeController::write_outputs(std::span<const std::byte> data) {
  std::ranges::copy(data, memory_.begin() + start_of(2));
  memory_[0x0815] |= std::byte{1};
  raise(al_event::sync_manager(2), 2);
}

Bytes FakeController::read_inputs() const {
  return {memory_.begin() + start_of(3), memory_.begin() + start_of(3) + length_of(3)};
}

void FakeController::expire_watchdog() {
  set_word(0x0440, 0);
  events_ |= al_event::kProcessDataWatchdog;
}

std::vector<std::string> EventLog::sentences() const {
  std::vector<std::string> all;
  std::ranges::transform(events, std::back_inserter(all), base::to_sentence);
  return all;
}

std::string EventLog::last(std::string_view rule_id) const {
  const auto found = std::find_if(events.rbegin(), events.rend(), [&](const base::Event& event) {
    return event.rule->id == rule_id;
  });
  return found == events.rend() ? std::string() : base::to_sentence(*found);
}

DeviceDescription test_description() {
  DeviceDescription description;
  description.vendor_id = 0x286;
  description.vendor_name = "Trinamic";
  description.product_code = 3315;
  description.revision = 0x00010009;
  description.serial_number = 42;
  description.order_code = "TMCM-3315";
  description.name = "TMCM-3315 Three axis stepper";
  description.group = "Drives";
  description.station_alias = 0x1234;
  description.receive_mailbox = {0x1000, 128};
  description.transmit_mailbox = {0x1080, 128};
  description.output_offset = 0x1100;
  description.input_offset = 0x1400;
  description.coe = true;
  description.sdo_information = true;
  description.complete_access = true;
  description.pdo_assign = true;
  description.pdo_configuration = true;
  description.distributed_clocks = true;
  return description;
}

void fill_test_dictionary(dictionary::Dictionary& dictionary) {
  dictionary.add(declarations());
  dictionary.finish();
}

StackFixture::StackFixture(const DeviceDescription& device, const SlaveStackOptions& options)
    : description(device),
      stack((fill_test_dictionary(dictionary), controller), dictionary, description, application,
            base::EventReporter(&log, 0), options) {
  controller.set_word(0x0400, 0x09C2);
  controller.set_word(0x0420, 1000);
  controller.set_word(0x0440, 1);
}

void StackFixture::configure_mailbox() {
  controller.set_sync_manager(0, kReceiveStart, description.receive_mailbox.length, 0x26, true);
  controller.set_sync_manager(
      1, static_cast<std::uint16_t>(kReceiveStart + description.receive_mailbox.length),
      description.transmit_mailbox.length, 0x22, true);
}

void StackFixture::configure_process_data(std::uint16_t outputs, std::uint16_t inputs) {
  controller.set_sync_manager(2, 0x1800, outputs, 0x64, outputs != 0);
  controller.set_sync_manager(3, 0x1C00, inputs, 0x20, inputs != 0);
}

void StackFixture::go_pre_operational() {
  configure_mailbox();
  request(0x02);
  ASSERT_EQ(controller.al_status(), 0x02U) << testing::PrintToString(log.sentences());
}

void StackFixture::go_safe_operational() {
  go_pre_operational();
  configure_process_data();
  request(0x04);
  ASSERT_EQ(controller.al_status(), 0x04U) << testing::PrintToString(log.sentences());
}

void StackFixture::go_operational() {
  go_safe_operational();
  request(0x08);
  ASSERT_EQ(controller.al_status(), 0x08U) << testing::PrintToString(log.sentences());
}

Bytes StackFixture::message(unsigned type, const Bytes& payload, unsigned counter) {
  return concat(
      {le(static_cast<std::uint16_t>(payload.size())),
       {std::byte{0}, std::byte{0}, std::byte{0}, static_cast<std::byte>(type | counter << 4)},
       payload});
}

Bytes StackFixture::exchange(const Bytes& request) {
  EXPECT_TRUE(controller.write_mailbox(request));
  process();
  return controller.read_mailbox();
}

Bytes StackFixture::sdo(const Bytes& request) {
  counter_ = counter_ % 7 + 1;
  const Bytes reply = exchange(message(3, concat({hex("00 20"), request}), counter_));
  if (reply.size() < 8) {
    return {};
  }
  const bool abort = (reply.at(8) & std::byte{0xE0}) == std::byte{0x80};
  EXPECT_EQ(to_hex(part(reply, 6, 2)), abort ? "00 20" : "00 30") << "CoE header";
  return {reply.begin() + 8, reply.end()};
}

Bytes StackFixture::information(std::uint8_t opcode, const Bytes& body) {
  counter_ = counter_ % 7 + 1;
  fragments_left.clear();
  const Bytes header{static_cast<std::byte>(opcode), std::byte{0}, std::byte{0}, std::byte{0}};
  Bytes reply = exchange(message(3, concat({hex("00 80"), header, body}), counter_));
  Bytes all;
  while (reply.size() >= 12) {
    EXPECT_EQ(to_hex(part(reply, 6, 2)), "00 80");
    const unsigned left = base::load_le<std::uint16_t>(reply, 10);
    const bool incomplete = (reply[8] & std::byte{0x80}) != std::byte{0};
    EXPECT_EQ(incomplete, left != 0);
    fragments_left.push_back(left);
    if (all.empty()) {
      all.push_back(reply[8] & std::byte{0x7F});
    }
    all.insert(all.end(), reply.begin() + 12, reply.end());
    if (left == 0) {
      break;
    }
    process();
    reply = controller.read_mailbox();
  }
  return all;
}

std::uint32_t StackFixture::abort_code(const Bytes& reply) {
  return reply.size() == 8 && reply[0] == std::byte{0x80} ? base::load_le<std::uint32_t>(reply, 4)
                                                          : 0;
}

}  // namespace stator::ethercat::test
