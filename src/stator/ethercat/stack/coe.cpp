#include "stator/ethercat/stack/coe.hpp"

#include "stator/base/byte_order.hpp"

namespace stator::ethercat {

namespace {

constexpr std::size_t kCoeHeaderSize = 2;

void write_header(std::span<std::byte> message, CoeService service) {
  base::store_le(message, 0, static_cast<std::uint16_t>(static_cast<unsigned>(service) << 12));
}

/// An abort is a request, whoever sends it (ETG.1000.6 §5.6.2.7): masters that find it in a
/// response take the transfer for done.
void write_sdo_header(std::span<std::byte> message, std::span<const std::byte> answer) {
  write_header(message,
               SdoServer::is_abort(answer) ? CoeService::sdo_request : CoeService::sdo_response);
}

}  // namespace

CoeServer::CoeServer(dictionary::Dictionary& dictionary, const Features& features,
                     base::EventReporter reporter, SlaveStackStatistics& statistics)
    : sdo_(dictionary, features.complete_access, reporter, statistics, features.quirks),
      information_(dictionary, reporter, statistics),
      information_enabled_(features.sdo_information && !features.quirks.no_sdo_information),
      statistics_(statistics) {}

void CoeServer::reset() {
  emergencies_.clear();
  sdo_.reset();
  information_.reset();
}

MailboxReply CoeServer::handle(std::span<const std::byte> request, std::span<std::byte> reply,
                               base::SimTime now) {
  if (request.size() < kCoeHeaderSize) {
    return MailboxReply::refuse(MailboxErrorCode::size_too_short);
  }
  const auto header = base::load_le<std::uint16_t>(request);
  const auto service = static_cast<CoeService>(header >> 12);
  const auto body = request.subspan(kCoeHeaderSize);
  const auto room = reply.subspan(kCoeHeaderSize);
  MailboxReply result;
  switch (service) {
    case CoeService::sdo_request:
      result = sdo_.handle(body, room, now);
      write_sdo_header(reply, room.first(result.length));
      break;
    case CoeService::sdo_information:
      if (!information_enabled_) {
        return MailboxReply::refuse(MailboxErrorCode::service_not_supported);
      }
      result = information_.handle(body, room, now);
      write_header(reply, CoeService::sdo_information);
      break;
    case CoeService::emergency:
    case CoeService::sdo_response:
    case CoeService::tx_pdo:
    case CoeService::rx_pdo:
    case CoeService::tx_pdo_remote_request:
    case CoeService::rx_pdo_remote_request:
      return MailboxReply::refuse(MailboxErrorCode::service_not_supported);
    default:
      return MailboxReply::refuse(MailboxErrorCode::invalid_header);
  }
  if (result.length != 0) {
    result.length += kCoeHeaderSize;
  }
  return result;
}

bool CoeServer::has_message() const {
  return !emergencies_.empty() || sdo_.completing() || information_.has_fragment();
}

std::size_t CoeServer::next_message(std::span<std::byte> message, base::SimTime now) {
  const auto room = message.subspan(kCoeHeaderSize);
  if (!emergencies_.empty()) {
    write_header(message, CoeService::emergency);
    emergencies_.pop().encode(room);
    ++statistics_.emergencies_sent;
    return kCoeHeaderSize + EmergencyMessage::kSize;
  }
  if (sdo_.completing()) {
    const std::size_t length = sdo_.answer_when_complete(room, now);
    write_sdo_header(message, room.first(length));
    return length == 0 ? 0 : kCoeHeaderSize + length;
  }
  write_header(message, CoeService::sdo_information);
  return kCoeHeaderSize + information_.next_fragment(room);
}

bool CoeServer::queue_emergency(const EmergencyMessage& message) {
  if (emergencies_.push(message)) {
    return true;
  }
  ++statistics_.emergencies_dropped;
  return false;
}

}  // namespace stator::ethercat
