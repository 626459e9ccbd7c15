#include "stator/ethercat/stack/sdo_information.hpp"

#include <algorithm>
#include <array>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/stack/pdo_configuration.hpp"

namespace stator::ethercat {

namespace {

using dictionary::AbortCode;
using dictionary::Entry;
using dictionary::EntryDeclaration;
using dictionary::Object;
using dictionary::PdoMapping;
using dictionary::Refusal;
using dictionary::Verdict;

/// Opcodes (ETG.1000.6 table 43); an answer has its request's opcode plus one.
enum class Opcode : std::uint8_t {
  list_request = 1,
  object_request = 3,
  entry_request = 5,
  error = 7,
};
constexpr unsigned kIncomplete = 0x80;  ///< further fragments follow
constexpr std::size_t kHeaderSize = 4;

/// Lists of object indices (ETG.1000.6 table 44).
enum class ListType : std::uint16_t {
  lengths = 0,
  all = 1,
  receive_mappable = 2,
  transmit_mappable = 3,
  stored_for_replacement = 4,
  startup_parameters = 5,
};
constexpr unsigned kListCount = 5;

/// Value info bits of an entry description (ETG.1000.6 table 49).
constexpr unsigned kInfoUnit = 0x08;
constexpr unsigned kInfoDefault = 0x10;
constexpr unsigned kInfoMinimum = 0x20;
constexpr unsigned kInfoMaximum = 0x40;

constexpr unsigned kAccessReadAllStates = 0x07;
constexpr unsigned kAccessWriteShift = 3;
constexpr unsigned kAccessReceiveMappable = 0x40;
constexpr unsigned kAccessTransmitMappable = 0x80;

// Data types of standard records (ETG.1000.6 §5.6.7.3).
constexpr std::uint16_t kTypePdoMapping = 0x0021;
constexpr std::uint16_t kTypeIdentity = 0x0023;

/// A unit as the standard codes it: SI prefix in the high byte, unit in the low one (CiA 303-2).
struct UnitCode {
  std::string_view text;
  std::uint16_t code;
};
constexpr std::array<UnitCode, 10> kUnitCodes{{{"s", 0x0003},
                                               {"ms", 0xFD03},
                                               {"us", 0xFA03},
                                               {"A", 0x0004},
                                               {"mA", 0xFD04},
                                               {"Hz", 0x0020},
                                               {"V", 0x0026},
                                               {"mV", 0xFD26},
                                               {"degC", 0x002D},
                                               {"%", 0xFE00}}};

std::uint16_t unit_code(std::string_view text) {
  const auto* found = std::ranges::find(kUnitCodes, text, &UnitCode::text);
  return found == kUnitCodes.end() ? std::uint16_t{0} : found->code;
}

bool receive_mappable(const Entry& entry) {
  const PdoMapping mapping = entry.declaration().mapping;
  return mapping == PdoMapping::receive || mapping == PdoMapping::both;
}

bool transmit_mappable(const Entry& entry) {
  const PdoMapping mapping = entry.declaration().mapping;
  return mapping == PdoMapping::transmit || mapping == PdoMapping::both;
}

bool in_list(const Object& object, ListType list) {
  switch (list) {
    case ListType::all:
      return true;
    case ListType::receive_mappable:
      return std::ranges::any_of(object.entries, receive_mappable);
    case ListType::transmit_mappable:
      return std::ranges::any_of(object.entries, transmit_mappable);
    default:
      return false;  // declarations name no objects for replacement or start-up
  }
}

std::uint16_t object_access(const Entry& entry) {
  unsigned access = entry.readable() ? kAccessReadAllStates : 0;
  if (entry.writable()) {
    access |= static_cast<unsigned>(entry.declaration().write_states) << kAccessWriteShift;
  }
  access |= receive_mappable(entry) ? kAccessReceiveMappable : 0;
  access |= transmit_mappable(entry) ? kAccessTransmitMappable : 0;
  return static_cast<std::uint16_t>(access);
}

/// Type of the elements for an array, of the whole for a record; 0 where the standard names none.
std::uint16_t object_type(const Object& object) {
  switch (object.code) {
    case dictionary::ObjectCode::domain_object:
    case dictionary::ObjectCode::variable:
      return static_cast<std::uint16_t>(object.entries.front().type());
    case dictionary::ObjectCode::array:
      return static_cast<std::uint16_t>(object.entries.back().type());
    case dictionary::ObjectCode::record:
      break;
  }
  if (pdo_direction(object.index)) {
    return kTypePdoMapping;
  }
  return object.index == 0x1018 ? kTypeIdentity : std::uint16_t{0};
}

/// Bytes of a request behind its header.
std::size_t body_size(Opcode opcode) {
  return opcode == Opcode::entry_request ? 4 : 2;
}

}  // namespace

SdoInformation::SdoInformation(dictionary::Dictionary& dictionary, base::EventReporter reporter,
                               SlaveStackStatistics& statistics)
    : dictionary_(dictionary), reporter_(reporter), statistics_(statistics) {
  std::size_t longest_name = 0;
  for (const Entry& entry : dictionary.entries()) {
    longest_name = std::max(longest_name, entry.name().size());
  }
  for (const Object& object : dictionary.objects()) {
    longest_name = std::max(longest_name, object.name.str().size());
  }
  constexpr std::size_t kLongestDescription = 64;  // fixed fields and three values of 8 bytes
  answer_.reserve(
      std::max(2 + 2 * dictionary.objects().size(), kLongestDescription + longest_name));
}

template <typename T>
void SdoInformation::append(T value) {
  const std::size_t end = answer_.size();
  answer_.resize(end + sizeof value);
  base::store_le(answer_, end, value);
}

void SdoInformation::append_text(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  answer_.insert(answer_.end(), bytes.begin(), bytes.end());
}

MailboxReply SdoInformation::handle(std::span<const std::byte> request, std::span<std::byte> reply,
                                    base::SimTime now) {
  if (request.size() < kHeaderSize) {
    return MailboxReply::refuse(MailboxErrorCode::size_too_short);
  }
  const auto code = std::to_integer<std::uint8_t>(request[0] & std::byte{0x7F});
  const auto body = request.subspan(kHeaderSize);
  const auto opcode = static_cast<Opcode>(code);
  if (body.size() < body_size(opcode)) {
    return MailboxReply::refuse(MailboxErrorCode::size_too_short);
  }
  answer_.clear();
  sent_ = 0;
  opcode_ = static_cast<std::uint8_t>(code + 1);
  Verdict verdict;
  switch (opcode) {
    case Opcode::list_request:
      verdict = answer_list(body);
      break;
    case Opcode::object_request:
      verdict = answer_object(body);
      break;
    case Opcode::entry_request:
      verdict = answer_entry(body);
      break;
    default:
      verdict = dictionary::refuse(AbortCode::command_specifier_unknown, rules::kInformationUnknown,
                                   {int{code}});
      break;
  }
  if (!verdict) {
    answer_.clear();
    sent_ = 0;
    return {.length = refuse(reply, verdict.error(), now)};
  }
  return {.length = next_fragment(reply)};
}

std::size_t SdoInformation::next_fragment(std::span<std::byte> reply) {
  const std::size_t room = reply.size() - kHeaderSize;
  const std::size_t now_sent = std::min(room, answer_.size() - sent_);
  std::ranges::copy(std::span(answer_).subspan(sent_, now_sent), reply.begin() + kHeaderSize);
  sent_ += now_sent;
  const std::size_t left = (answer_.size() - sent_ + room - 1) / room;
  reply[0] = static_cast<std::byte>(opcode_ | (left != 0 ? kIncomplete : 0U));
  reply[1] = std::byte{0};
  base::store_le(reply, 2, static_cast<std::uint16_t>(left));
  return kHeaderSize + now_sent;
}

Verdict SdoInformation::answer_list(std::span<const std::byte> request) {
  const auto type = base::load_le<std::uint16_t>(request);
  if (type > kListCount) {
    return dictionary::refuse(AbortCode::unsupported_access, rules::kInformationList, {int{type}});
  }
  append(type);
  if (static_cast<ListType>(type) == ListType::lengths) {
    for (unsigned list = 1; list <= kListCount; ++list) {
      const auto count = std::ranges::count_if(dictionary_.objects(), [list](const Object& object) {
        return in_list(object, static_cast<ListType>(list));
      });
      append(static_cast<std::uint16_t>(count));
    }
    return {};
  }
  for (const Object& object : dictionary_.objects()) {
    if (in_list(object, static_cast<ListType>(type))) {
      append(object.index);
    }
  }
  return {};
}

Verdict SdoInformation::answer_object(std::span<const std::byte> request) {
  const auto index = base::load_le<std::uint16_t>(request);
  if (const auto entry = dictionary_.require(index, 0); !entry) {
    return base::Unexpected{entry.error()};
  }
  const Object& object = *dictionary_.find(index);
  append(index);
  append(object_type(object));
  append(object.max_subindex());
  append(static_cast<std::uint8_t>(object.code));
  append_text(object.name.str());
  return {};
}

Verdict SdoInformation::answer_entry(std::span<const std::byte> request) {
  const auto index = base::load_le<std::uint16_t>(request);
  const auto subindex = std::to_integer<std::uint8_t>(request[2]);
  const auto requested = std::to_integer<unsigned>(request[3]);
  const auto found = dictionary_.require(index, subindex);
  if (!found) {
    return base::Unexpected{found.error()};
  }
  const Entry& entry = **found;
  const EntryDeclaration& declaration = entry.declaration();
  unsigned given = requested & 0x07;
  const bool numeric = !is_string(entry.type());
  given |= declaration.unit.empty() ? 0 : requested & kInfoUnit;
  given |= numeric && declaration.default_value.documented ? requested & kInfoDefault : 0;
  given |= numeric && declaration.range ? requested & (kInfoMinimum | kInfoMaximum) : 0;

  append(index);
  append(subindex);
  append(static_cast<std::uint8_t>(given));
  append(static_cast<std::uint16_t>(entry.type()));
  append(static_cast<std::uint16_t>(entry.bits()));
  append(object_access(entry));
  const auto append_value = [&](std::uint64_t value) {
    const std::size_t end = answer_.size();
    append(value);
    answer_.resize(end + entry.size());
  };
  if ((given & kInfoUnit) != 0) {
    append(unit_code(declaration.unit));
  }
  if ((given & kInfoDefault) != 0) {
    append_value(entry.default_bits());
  }
  if ((given & kInfoMinimum) != 0) {
    append_value(declaration.range->minimum.bits);
  }
  if ((given & kInfoMaximum) != 0) {
    append_value(declaration.range->maximum.bits);
  }
  append_text(entry.name());
  return {};
}

std::size_t SdoInformation::refuse(std::span<std::byte> reply, const Refusal& refusal,
                                   base::SimTime now) {
  ++statistics_.sdo_aborts;
  if (refusal.rule != nullptr) {
    reporter_.report(now, *refusal.rule, refusal.arguments);
  }
  reply[0] = static_cast<std::byte>(Opcode::error);
  std::ranges::fill(reply.subspan(1, kHeaderSize - 1), std::byte{0});
  base::store_le(reply, kHeaderSize, static_cast<std::uint32_t>(refusal.code));
  return kHeaderSize + sizeof(std::uint32_t);
}

}  // namespace stator::ethercat
