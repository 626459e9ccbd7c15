#include "stator/ethercat/stack/foe.hpp"

#include <algorithm>

#include "stator/base/byte_order.hpp"

namespace stator::ethercat {

namespace {

using base::EventArgument;

/// Operation code, a reserved byte, and password, packet number, error code or progress.
constexpr std::size_t kFoeHeaderSize = 6;
constexpr std::uint16_t kEntire = 100;  ///< progress is told in percent

MailboxReply write(std::span<std::byte> reply, FoeOperation operation, std::uint32_t number,
                   std::string_view text = {}) {
  const std::size_t length = std::min(text.size(), reply.size() - kFoeHeaderSize);
  reply[0] = static_cast<std::byte>(operation);
  reply[1] = std::byte{0};
  base::store_le(reply, 2, number);
  std::ranges::copy(std::as_bytes(std::span(text)).first(length), reply.begin() + kFoeHeaderSize);
  return {.length = kFoeHeaderSize + length};
}

std::string_view as_text(std::span<const std::byte> bytes) {
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  // Names are not terminated; masters that do it all the same mean the text before.
  return text.substr(0, text.find('\0'));
}

}  // namespace

base::StaticText to_text(FoeError error) {
  switch (error) {
    case FoeError::none:
      return "no error";
    case FoeError::not_defined:
      return "not defined";
    case FoeError::not_found:
      return "not found";
    case FoeError::access_denied:
      return "access denied";
    case FoeError::disk_full:
      return "disk full";
    case FoeError::illegal:
      return "illegal";
    case FoeError::packet_number_wrong:
      return "packet number wrong";
    case FoeError::already_exists:
      return "already exists";
    case FoeError::no_user:
      return "no user";
    case FoeError::bootstrap_only:
      return "bootstrap only";
    case FoeError::not_in_bootstrap:
      return "not in bootstrap";
    case FoeError::no_rights:
      return "no rights";
    case FoeError::program_error:
      return "program error";
    case FoeError::checksum_wrong:
      return "checksum wrong";
    case FoeError::firmware_does_not_fit:
      return "firmware does not fit for hardware";
  }
  return "unknown error";
}

void FoeServer::start(AlState state, std::size_t receive_room, std::size_t transmit_room) {
  bootstrap_ = state == AlState::bootstrap;
  download_packet_ = receive_room - kFoeHeaderSize;
  upload_packet_ = std::min(receive_room, transmit_room) - kFoeHeaderSize;
}

void FoeServer::reset() {
  abandon_transfer(last_message_);
}

void FoeServer::abandon_transfer(base::SimTime now) {
  if (transfer_ == Transfer::writing) {
    reporter_.report(now, rules::kFoeAbandoned, {EventArgument(offset_)});
  }
  end_transfer();
}

void FoeServer::end_transfer() {
  if (transfer_ == Transfer::reading || transfer_ == Transfer::writing) {
    files_.abort();
  }
  transfer_ = Transfer::none;
}

MailboxReply FoeServer::handle(std::span<const std::byte> request, std::span<std::byte> reply,
                               base::SimTime now) {
  if (request.size() < kFoeHeaderSize) {
    return MailboxReply::refuse(MailboxErrorCode::size_too_short);
  }
  last_message_ = now;
  const auto operation = static_cast<FoeOperation>(request[0]);
  switch (operation) {
    case FoeOperation::read_request:
    case FoeOperation::write_request:
      return open(operation, request.subspan(2), reply, now);
    case FoeOperation::data:
      return take_data(request.subspan(2), reply, now);
    case FoeOperation::acknowledge:
      return take_acknowledge(base::load_le<std::uint32_t>(request, 2), reply, now);
    case FoeOperation::busy:
      return take_busy(reply, now);
    case FoeOperation::error:
      abandon_transfer(now);
      return MailboxReply::none();
  }
  return MailboxReply::refuse(MailboxErrorCode::invalid_header);
}

FoeError FoeServer::check(std::uint32_t password) const {
  if (options_.bootstrap_only && !bootstrap_) {
    return FoeError::bootstrap_only;
  }
  return password == options_.password ? FoeError::none : FoeError::no_rights;
}

MailboxReply FoeServer::open(FoeOperation operation, std::span<const std::byte> body,
                             std::span<std::byte> reply, base::SimTime now) {
  abandon_transfer(now);
  switch (const FoeError error = check(base::load_le<std::uint32_t>(body)); error) {
    case FoeError::none:
      break;
    case FoeError::bootstrap_only:
      return refuse(reply, error, "go to Init, then to Bootstrap, and ask again", now);
    default:
      return refuse(reply, error, "the password is wrong", now);
  }
  const std::string_view name = as_text(body.subspan(4));
  packet_ = 0;
  offset_ = 0;
  if (operation == FoeOperation::read_request) {
    if (const FoeError error = files_.open_for_reading(name); error != FoeError::none) {
      return refuse(reply, error, "the file cannot be read", now);
    }
    transfer_ = Transfer::reading;
    packet_ = 1;
    return send_data(reply, now);
  }
  if (const FoeError error = files_.open_for_writing(name); error != FoeError::none) {
    return refuse(reply, error, "the file cannot be written", now);
  }
  transfer_ = Transfer::writing;
  ready_ = now + options_.erase_time;
  checksum_ = {};
  return acknowledge(reply);
}

MailboxReply FoeServer::take_data(std::span<const std::byte> body, std::span<std::byte> reply,
                                  base::SimTime now) {
  const auto packet = base::load_le<std::uint32_t>(body);
  const auto data = body.subspan(4);
  switch (transfer_) {
    case Transfer::writing:
      break;
    case Transfer::committing:
      return packet == packet_ ? take_last(reply, now)
                               : refuse(reply, FoeError::packet_number_wrong,
                                        "the last packet of the file has come already", now);
    case Transfer::written:
      if (packet == packet_) {
        return acknowledge(reply);
      }
      [[fallthrough]];
    case Transfer::none:
      return refuse(reply, FoeError::not_defined,
                    "no transfer is open; begin with a read or write request", now);
    case Transfer::reading:
      return refuse(reply, FoeError::illegal, "data came while the master reads a file", now);
  }
  if (packet != packet_ + 1) {
    if (packet == packet_ && packet != 0) {
      return acknowledge(reply);  // comes again because its acknowledge was lost
    }
    return refuse(reply, FoeError::packet_number_wrong,
                  "packets count from 1 without gaps; begin the transfer again", now);
  }
  const bool last = data.size() < download_packet_;
  if (last && offset_ == 0 && data.empty()) {
    return refuse(reply, FoeError::illegal, "the file is empty; the old one stays", now);
  }
  if (now < ready_) {
    const std::int64_t left = (ready_ - now).nanoseconds() * kEntire;
    const std::int64_t percent = kEntire - left / options_.erase_time.nanoseconds();
    return busy(reply, static_cast<std::uint16_t>(std::clamp<std::int64_t>(percent, 0, 99)),
                kEntire, "erasing");
  }
  if (const FoeError error = files_.append(data); error != FoeError::none) {
    return refuse(reply, error, "the file does not fit into the device; the old one stays", now);
  }
  packet_ = packet;
  offset_ += data.size();
  checksum_.add(data);
  if (!last) {
    return acknowledge(reply);
  }
  transfer_ = Transfer::committing;
  reporter_.report(now, rules::kFoeReceived,
                   {EventArgument(offset_), EventArgument(checksum_.value())});
  return take_last(reply, now);
}

MailboxReply FoeServer::take_last(std::span<std::byte> reply, base::SimTime now) {
  const FileStore::Commit commit = files_.commit();
  if (commit.in_progress) {
    return busy(reply, 0, kEntire, "storing");
  }
  if (commit.error != FoeError::none) {
    return refuse(reply, commit.error, "the file could not be stored; the old one stays", now);
  }
  transfer_ = Transfer::written;
  return acknowledge(reply);
}

MailboxReply FoeServer::take_acknowledge(std::uint32_t packet, std::span<std::byte> reply,
                                         base::SimTime now) {
  if (transfer_ != Transfer::reading) {
    return refuse(reply, FoeError::not_defined, "an acknowledge came, but no file is being read",
                  now);
  }
  if (packet + 1 == packet_) {
    return send_data(reply, now);  // asks for what was sent last once more
  }
  if (packet != packet_) {
    return refuse(reply, FoeError::packet_number_wrong,
                  "the acknowledge is not for the packet sent last; begin the transfer again", now);
  }
  const std::size_t sent = std::min(upload_packet_, files_.size() - offset_);
  offset_ += sent;
  if (sent < upload_packet_) {
    end_transfer();
    return MailboxReply::none();
  }
  ++packet_;
  return send_data(reply, now);
}

MailboxReply FoeServer::take_busy(std::span<std::byte> reply, base::SimTime now) {
  if (transfer_ != Transfer::reading) {
    return refuse(reply, FoeError::not_defined, "a busy message came, but no file is being read",
                  now);
  }
  return send_data(reply, now);
}

MailboxReply FoeServer::send_data(std::span<std::byte> reply, base::SimTime now) {
  const std::size_t count = std::min(upload_packet_, files_.size() - offset_);
  const FoeError error = files_.read(offset_, reply.subspan(kFoeHeaderSize, count));
  if (error != FoeError::none) {
    return refuse(reply, error, "the file changed while it was read; begin again", now);
  }
  const MailboxReply header = write(reply, FoeOperation::data, packet_);
  return {.length = header.length + count};
}

MailboxReply FoeServer::acknowledge(std::span<std::byte> reply) const {
  return write(reply, FoeOperation::acknowledge, packet_);
}

MailboxReply FoeServer::busy(std::span<std::byte> reply, std::uint16_t done, std::uint16_t entire,
                             std::string_view text) const {
  return write(reply, FoeOperation::busy, done | std::uint32_t{entire} << 16, text);
}

MailboxReply FoeServer::refuse(std::span<std::byte> reply, FoeError error, base::StaticText reason,
                               base::SimTime now) {
  end_transfer();
  reporter_.report(now, rules::kFoeRefused,
                   {EventArgument(static_cast<std::uint32_t>(error)), EventArgument(to_text(error)),
                    EventArgument(reason)});
  return write(reply, FoeOperation::error, static_cast<std::uint32_t>(error), to_text(error));
}

}  // namespace stator::ethercat
