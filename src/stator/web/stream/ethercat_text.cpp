#include "stator/web/stream/ethercat_text.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/controller/frame_text.hpp"
#include "stator/ethercat/stack/coe.hpp"
#include "stator/ethercat/standard/al_status_text.hpp"
#include "stator/ethercat/standard/mailbox_protocol.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"
#include "stator/web/stream/object_text.hpp"
#include "stator/web/stream/sdo_text.hpp"

namespace stator::web {

namespace {

using ethercat::Command;
using ethercat::DatagramView;

/// Datagrams named in the summary at most.
constexpr std::size_t kSummarised = 3;
constexpr std::uint16_t kProcessMemory = 0x1000;
constexpr std::size_t kCoeHeader = 2;

bool logical(Command command) {
  return command == Command::lrd || command == Command::lwr || command == Command::lrw;
}

bool reads(Command command) {
  switch (command) {
    case Command::nop:
    case Command::apwr:
    case Command::fpwr:
    case Command::bwr:
    case Command::lwr:
      return false;
    default:
      return true;
  }
}

bool writes(Command command) {
  switch (command) {
    case Command::nop:
    case Command::aprd:
    case Command::fprd:
    case Command::brd:
    case Command::lrd:
      return false;
    default:
      return true;
  }
}

/// The slave that a physical command is for; null: several, or nobody knows.
const SlaveMap* addressed(const DatagramView& datagram, const std::vector<SlaveMap>& slaves,
                          bool answer) {
  switch (datagram.command) {
    case Command::fprd:
    case Command::fpwr:
    case Command::fprw:
    case Command::frmw: {
      const auto found = std::ranges::find(slaves, datagram.adp(), &SlaveMap::station);
      return found != slaves.end() ? &*found : nullptr;
    }
    case Command::aprd:
    case Command::apwr:
    case Command::aprw:
    case Command::armw: {
      // Each slave that has passed has added one.
      const auto position = static_cast<std::uint16_t>(answer ? slaves.size() - datagram.adp()
                                                              : std::size_t{0} - datagram.adp());
      return position < slaves.size() ? &slaves[position] : nullptr;
    }
    default:
      return nullptr;
  }
}

std::string_view state_name(unsigned number) {
  return to_text(static_cast<ethercat::AlState>(number & 0x0F));
}

/// The value of registers that tell of state changes, in words.
std::string register_value(std::uint16_t address, std::span<const std::byte> bytes) {
  namespace registers = ethercat::register_address;
  constexpr unsigned kError = 0x10;
  if (bytes.empty()) {
    return {};
  }
  const auto low = std::to_integer<unsigned>(bytes[0]);
  if (address == registers::kAlControl) {
    return fmt::format("{} requested{}", state_name(low),
                       (low & kError) != 0 ? ", error acknowledged" : "");
  }
  if (address == registers::kAlStatus) {
    std::string text = fmt::format("{}{}", state_name(low), (low & kError) != 0 ? ", error" : "");
    constexpr std::size_t kCodeOffset = registers::kAlStatusCode - registers::kAlStatus;
    if (bytes.size() >= kCodeOffset + 2 && (low & kError) != 0) {
      const auto code = base::load_le<std::uint16_t>(bytes, kCodeOffset);
      text += fmt::format(", {:04X}h {}", code, to_text(static_cast<ethercat::AlStatusCode>(code)));
    }
    return text;
  }
  if (address == registers::kAlStatusCode && bytes.size() >= 2) {
    const auto code = base::load_le<std::uint16_t>(bytes, 0);
    return fmt::format("{:04X}h {}", code, to_text(static_cast<ethercat::AlStatusCode>(code)));
  }
  return {};
}

std::string_view mailbox_name(ethercat::MailboxType type) {
  switch (type) {
    case ethercat::MailboxType::error:
      return "error";
    case ethercat::MailboxType::aoe:
      return "AoE";
    case ethercat::MailboxType::eoe:
      return "EoE";
    case ethercat::MailboxType::coe:
      return "CoE";
    case ethercat::MailboxType::foe:
      return "FoE";
    case ethercat::MailboxType::soe:
      return "SoE";
    case ethercat::MailboxType::voe:
      return "VoE";
  }
  return "of an unknown protocol";
}

std::string emergency(std::span<const std::byte> bytes, DecodedFrame& decoded) {
  if (bytes.size() < 8) {
    return "emergency, too short";
  }
  const auto code = base::load_le<std::uint16_t>(bytes, 0);
  decoded.add("emergency", fmt::format("code {:04X}h, error register {:02X}h, {}", code,
                                       std::to_integer<unsigned>(bytes[2]),
                                       hexadecimal_text(bytes.subspan(3, 5))));
  return fmt::format("emergency {:04X}h", code);
}

std::string coe(std::span<const std::byte> message, const SlaveMap& slave, DecodedFrame& decoded) {
  if (message.size() < kCoeHeader) {
    return "CoE, too short";
  }
  const auto service =
      static_cast<ethercat::CoeService>(base::load_le<std::uint16_t>(message, 0) >> 12U);
  const std::span<const std::byte> body = message.subspan(kCoeHeader);
  switch (service) {
    case ethercat::CoeService::emergency:
      return emergency(body, decoded);
    case ethercat::CoeService::sdo_request:
      return describe_sdo(body, true, slave.objects, decoded);
    case ethercat::CoeService::sdo_response:
      return describe_sdo(body, false, slave.objects, decoded);
    case ethercat::CoeService::sdo_information:
      return "SDO information";
    default:
      return "CoE";
  }
}

std::string mailbox(std::span<const std::byte> bytes, const SlaveMap& slave,
                    DecodedFrame& decoded) {
  if (bytes.size() < ethercat::kMailboxHeaderSize) {
    return {};
  }
  const auto header = ethercat::MailboxHeader::decode(bytes);
  const std::size_t room = bytes.size() - ethercat::kMailboxHeaderSize;
  if (header.length == 0 || header.length > room) {
    return {};
  }
  decoded.add("mailbox", fmt::format("{}, counter {}, {} bytes", mailbox_name(header.type),
                                     header.counter, header.length));
  const auto message = bytes.subspan(ethercat::kMailboxHeaderSize, header.length);
  if (header.type == ethercat::MailboxType::coe) {
    return coe(message, slave, decoded);
  }
  return fmt::format("{} message", mailbox_name(header.type));
}

/// The mapped objects whose bits lie in `bytes`, the first of which is at `first_bit` of the area.
void add_objects(const SlaveMap& slave, const std::vector<MappedObject>& objects,
                 std::span<const std::byte> bytes, std::int64_t first_bit, DecodedFrame& decoded) {
  for (const MappedObject& object : objects) {
    const std::int64_t bit = static_cast<std::int64_t>(object.bit) - first_bit;
    const auto end = bit + static_cast<std::int64_t>(object.bits);
    if (object.index == 0 || object.bits == 0 || object.bits > 64 || bit < 0 ||
        end > static_cast<std::int64_t>(8 * bytes.size())) {
      continue;
    }
    std::array<std::byte, 8> value{};
    ethercat::copy_bits(value.data(), 0, bytes.data(), static_cast<std::size_t>(bit), object.bits);
    decoded.add(slave.name + " " + object_text(slave.objects, object.index, object.subindex),
                value_text(slave.objects, object.index, object.subindex,
                           std::span(value).first((object.bits + 7) / 8)));
  }
}

/// Outputs before the slaves, inputs behind them.
void add_process_data(const DatagramView& datagram, bool answer,
                      const std::vector<SlaveMap>& slaves, DecodedFrame& decoded) {
  const std::span<const std::byte> bytes(datagram.data, datagram.length);
  const auto first = static_cast<std::int64_t>(datagram.address) * 8;
  for (const SlaveMap& slave : slaves) {
    for (const ethercat::Fmmu& fmmu : slave.fmmus) {
      const bool outputs = !answer && fmmu.writes && writes(datagram.command);
      const bool inputs = answer && fmmu.reads && reads(datagram.command);
      const MailboxArea& area = slave.areas[outputs ? 2 : 3];
      const bool overlaps =
          static_cast<std::int64_t>(fmmu.end_bit()) > first &&
          static_cast<std::int64_t>(fmmu.first_bit()) < first + 8 * std::int64_t{datagram.length};
      if ((outputs || inputs) && overlaps && area.contains(fmmu.physical_start)) {
        // The logical bit at which the area would begin.
        const std::int64_t begin = static_cast<std::int64_t>(fmmu.first_bit()) -
                                   fmmu.physical_start_bit -
                                   std::int64_t{8} * (fmmu.physical_start - area.start);
        add_objects(slave, outputs ? slave.outputs : slave.inputs, bytes, first - begin, decoded);
      }
    }
  }
}

std::string address_text(const DatagramView& datagram, const SlaveMap* slave) {
  if (logical(datagram.command)) {
    return fmt::format("{:08X}h", datagram.address);
  }
  const std::string_view quote = slave != nullptr ? " " : "";
  const std::string_view name = slave != nullptr ? std::string_view(slave->name) : "";
  switch (datagram.command) {
    case Command::nop:
      return {};
    case Command::brd:
    case Command::bwr:
    case Command::brw:
      return fmt::format("{:04X}h", datagram.ado());
    default:
      return fmt::format("{:04X}h{}{} {:04X}h", datagram.adp(), quote, name, datagram.ado());
  }
}

std::string describe(const DatagramView& datagram, bool answer, const std::vector<SlaveMap>& slaves,
                     DecodedFrame& decoded) {
  const SlaveMap* slave = addressed(datagram, slaves, answer);
  const std::span<const std::byte> bytes(datagram.data, datagram.length);
  std::string text = fmt::format("{} {}", to_text(datagram.command), address_text(datagram, slave));
  std::string meaning;
  const bool physical = !logical(datagram.command) && datagram.command != Command::nop;
  // Data that are written are shown on their way to the slaves, data that are read on their way
  // back.
  const bool shown =
      answer ? reads(datagram.command) && datagram.working_counter != 0 : writes(datagram.command);
  if (physical && datagram.ado() < kProcessMemory) {
    const std::string name = ethercat::register_name(datagram.ado());
    text += name.empty() ? "" : " " + name;
    meaning = shown ? register_value(datagram.ado(), bytes) : "";
  } else if (physical && shown && slave != nullptr &&
             slave->areas[answer ? 1 : 0].contains(datagram.ado())) {
    meaning = mailbox(bytes, *slave, decoded);
  }
  text += fmt::format(", {} bytes", datagram.length);
  text += answer ? fmt::format(", WKC {}", datagram.working_counter) : "";
  text += meaning.empty() ? "" : ": " + meaning;
  return text;
}

std::string_view error_text(ethercat::FrameError error) {
  switch (error) {
    case ethercat::FrameError::none:
      return "";
    case ethercat::FrameError::too_short:
      return "too short for EtherCAT";
    case ethercat::FrameError::other_ether_type:
      return "no EtherCAT";
    case ethercat::FrameError::other_header_type:
      return "an EtherCAT header without datagrams";
    case ethercat::FrameError::length_overrun:
      return "the EtherCAT length runs past the frame";
    case ethercat::FrameError::datagram_overrun:
      return "a datagram runs past the frame";
  }
  return "";
}

}  // namespace

DecodedFrame describe_ethercat(std::span<const std::byte> frame, bool answer,
                               const std::vector<SlaveMap>& slaves) {
  DecodedFrame decoded;
  // DatagramCursor needs bytes that it could change.
  std::vector<std::byte> copy(frame.begin(), frame.end());
  ethercat::DatagramCursor cursor(copy);
  std::size_t datagrams = 0;
  while (const auto datagram = cursor.next()) {
    const std::size_t place = decoded.fields.size();
    const std::string text = describe(*datagram, answer, slaves, decoded);
    if (++datagrams <= kSummarised) {
      decoded.summary += (datagrams > 1 ? "; " : "") + text;
    }
    if (place < DecodedFrame::kMostFields) {
      decoded.fields.emplace(decoded.fields.begin() + static_cast<std::ptrdiff_t>(place),
                             fmt::format("datagram {}", datagrams), text);
    }
    if (logical(datagram->command)) {
      add_process_data(*datagram, answer, slaves, decoded);
    }
  }
  if (datagrams > kSummarised) {
    decoded.summary += fmt::format("; {} more", datagrams - kSummarised);
  }
  if (cursor.error() != ethercat::FrameError::none) {
    decoded.summary += (datagrams > 0 ? "; " : "") + std::string(error_text(cursor.error()));
  }
  return decoded;
}

}  // namespace stator::web
