#include "stator/rack/faults/fault_mailbox.hpp"

#include <algorithm>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/stack/coe.hpp"

namespace stator::rack {

namespace {

// Of an SDO request behind its CoE header (ETG.1000.6 §5.6.2).
constexpr std::size_t kCommand = 2;
constexpr std::size_t kIndex = 3;
constexpr std::size_t kSubindex = 5;
constexpr std::size_t kSdoLength = 6;  ///< up to the subindex
constexpr unsigned kDownloadSegment = 0;
constexpr unsigned kInitiateDownload = 1;
constexpr unsigned kInitiateUpload = 2;
constexpr unsigned kUploadSegment = 3;

bool is_sdo_request(const ethercat::MailboxHeader& header, std::span<const std::byte> request) {
  return header.type == ethercat::MailboxType::coe && request.size() >= kSdoLength &&
         base::load_le<std::uint16_t>(request) >> 12U ==
             static_cast<unsigned>(ethercat::CoeService::sdo_request);
}

}  // namespace

MailboxFault mailbox_stall(const FaultConfiguration& fault) {
  using Kind = MailboxFault::Kind;
  return {.kind = fault.values.get<std::string>("mode") == "full" ? Kind::full : Kind::silent,
          .count = fault.count,
          .probability = fault.probability,
          .seed = fault.seed};
}

MailboxFault mailbox_abort(const FaultConfiguration& fault) {
  MailboxFault mailbox{.kind = MailboxFault::Kind::abort,
                       .count = fault.count,
                       .probability = fault.probability,
                       .seed = fault.seed,
                       .code = static_cast<std::uint32_t>(fault.values.whole("code"))};
  if (const auto object = fault.values.find<std::string>("object")) {
    mailbox.object = parse_fault_object(*object);
  }
  return mailbox;
}

std::uint64_t MailboxFaults::inject(const MailboxFault& fault) {
  faults_.push_back(
      {++newest_, fault, base::Recurrence(fault.count, fault.probability, fault.seed)});
  return newest_;
}

void MailboxFaults::withdraw(std::uint64_t number) {
  std::erase_if(faults_, [number](const Fault& fault) { return fault.number == number; });
}

std::optional<std::uint64_t> MailboxFaults::hits(std::uint64_t number) const {
  const auto found = std::ranges::find(faults_, number, &Fault::number);
  return found == faults_.end() || found->recurrence.over()
             ? std::nullopt
             : std::optional(found->recurrence.times());
}

// A request that is not taken stays there until the end, so it is no matter of count or chance.
bool MailboxFaults::takes_requests() {
  return std::ranges::none_of(
      faults_, [](const Fault& fault) { return fault.fault.kind == MailboxFault::Kind::full; });
}

bool MailboxFaults::handles(const ethercat::MailboxHeader& header,
                            std::span<const std::byte> request, base::SimTime now) {
  follow(header, request, now);
  for (Fault& fault : faults_) {
    if (fault.fault.kind == MailboxFault::Kind::silent && fault.recurrence.next()) {
      return false;
    }
  }
  return true;
}

void MailboxFaults::follow(const ethercat::MailboxHeader& header,
                           std::span<const std::byte> request, base::SimTime now) {
  MailboxStep step{.time = now};
  if (is_sdo_request(header, request)) {
    const unsigned command = std::to_integer<unsigned>(request[kCommand]) >> 5U;
    if (command == kInitiateDownload || command == kInitiateUpload) {
      transfer_ = FaultObject{base::load_le<std::uint16_t>(request, kIndex),
                              std::to_integer<std::uint8_t>(request[kSubindex])};
      segments_ = 0;
    } else if (command == kDownloadSegment || command == kUploadSegment) {
      step.segment = ++segments_;
    }
    step.object = transfer_;
  }
  if (listener_) {
    listener_(*this, step);
  }
}

std::optional<std::uint32_t> MailboxFaults::aborts_sdo(std::uint16_t index, std::uint8_t subindex) {
  for (Fault& fault : faults_) {
    if (fault.fault.kind == MailboxFault::Kind::abort &&
        (!fault.fault.object || fault.fault.object->matches(index, subindex)) &&
        fault.recurrence.next()) {
      return fault.fault.code;
    }
  }
  return std::nullopt;
}

}  // namespace stator::rack
