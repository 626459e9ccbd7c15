#include "stator/canopen/pdo/pdo_service.hpp"

#include <algorithm>
#include <utility>

namespace stator::canopen {

namespace {

using base::SimTime;

// Emergency error codes (CiA 301 table 26).
constexpr std::uint16_t kTooShort = 0x8210;
constexpr std::uint16_t kTooLong = 0x8220;
constexpr std::uint16_t kTimeout = 0x8250;
/// "Data in a received PDO is wrong": a code of the class "software, data set".
constexpr std::uint16_t kParameterError = 0x6320;
constexpr std::uint8_t kErrorRegisterProfile = 0x20;

bool has_object(const dictionary::Dictionary& dictionary, unsigned index) {
  return dictionary.find(static_cast<std::uint16_t>(index)) != nullptr;
}

template <typename Pdo>
Pdo* find_pdo(std::vector<Pdo>& pdos, std::uint16_t number) {
  const auto found = std::ranges::lower_bound(pdos, number, {}, &Pdo::number);
  return found != pdos.end() && found->number() == number ? &*found : nullptr;
}

/// Tells PDOs, and within a PDO its objects, apart in emergencies. Products with more than 32 PDOs
/// of 8 entries see some of them as one cause.
std::uint8_t cause_of(const ReceivePdo& pdo) {
  return static_cast<std::uint8_t>(pdo.number());
}
std::uint8_t cause_of(const ReceivePdo& pdo, const PdoMapping::Item& item) {
  const auto position = static_cast<unsigned>(&item - pdo.mapping().items().data());
  return static_cast<std::uint8_t>(pdo.number() * 8U + position % 8U);
}

}  // namespace

PdoService::PdoService(dictionary::Dictionary& dictionary, can::Transmitter& transmitter,
                       EmergencySink& emergencies, base::EventReporter reporter,
                       const PdoRules& rules)
    : dictionary_(dictionary), emergencies_(emergencies), reporter_(reporter), rules_(rules) {
  for (std::uint16_t number = 0; number < kMaximumPdos; ++number) {
    if (has_object(dictionary, kReceivePdoCommunication + number) &&
        has_object(dictionary, kReceivePdoMapping + number)) {
      receive_.emplace_back(dictionary, number, rules_);
    }
    if (has_object(dictionary, kTransmitPdoCommunication + number) &&
        has_object(dictionary, kTransmitPdoMapping + number)) {
      transmit_.emplace_back(dictionary, number, transmitter, rules_);
    }
  }
  for (const dictionary::Object& object : dictionary.objects()) {
    install_hooks(object);
  }
}

void PdoService::start(SimTime now) {
  operational_ = false;
  statistics_ = {};
  if (rules_.one_pdo) {
    close_further_pdos();
  }
  for (TransmitPdo& pdo : transmit_) {
    pdo.reset();
  }
  follow_all(now);
}

void PdoService::close_further_pdos() {
  for (const std::uint16_t first : {kReceivePdoCommunication, kTransmitPdoCommunication}) {
    for (std::uint16_t number = 1; number < kMaximumPdos; ++number) {
      constexpr std::uint8_t kCobIdSubindex = 1;
      if (dictionary::Entry* cob_id =
              dictionary_.find(static_cast<std::uint16_t>(first + number), kCobIdSubindex)) {
        cob_id->set_value(cob_id->value() | kCobIdInvalid);
      }
    }
  }
}

void PdoService::on_state(NmtState state, SimTime now) {
  if (state == NmtState::initialisation) {
    // Errors of frames before the reset are not reported again after the boot-up message.
    for (ReceivePdo& pdo : receive_) {
      clear_errors(pdo, now);
    }
  }
  const bool operational = state == NmtState::operational;
  if (operational == operational_) {
    return;
  }
  operational_ = operational;
  if (operational) {
    begin_process_data(now);
  } else {
    end_process_data();
  }
}

void PdoService::begin_process_data(SimTime now) {
  follow_all(now);
  window_end_ = SimTime::never();
  for (TransmitPdo& pdo : transmit_) {
    pdo.start(now);
  }
}

void PdoService::end_process_data() {
  for (ReceivePdo& pdo : receive_) {
    pdo.stop();
  }
  for (TransmitPdo& pdo : transmit_) {
    pdo.stop();
  }
}

/// Process data begin anew.
void PdoService::follow_all(SimTime now) {
  for (ReceivePdo& pdo : receive_) {
    clear_errors(pdo, now);
    pdo.stop();
    pdo.changed = true;
  }
  for (TransmitPdo& pdo : transmit_) {
    pdo.changed = true;
  }
  const bool operational = std::exchange(operational_, false);
  follow_changes(now);
  operational_ = operational;
}

void PdoService::follow_changes(SimTime now) {
  changed_ = false;
  for (ReceivePdo& pdo : receive_) {
    if (std::exchange(pdo.changed, false)) {
      if (pdo.becomes_another()) {
        clear_errors(pdo, now);
      }
      pdo.configure();
      if (!pdo.supervised()) {
        clear_timeout(pdo, now);
      }
    }
  }
  rebuild_filter();
  for (TransmitPdo& pdo : transmit_) {
    if (std::exchange(pdo.changed, false) && pdo.configure(now) && operational_) {
      pdo.start(now);
    }
  }
}

void PdoService::rebuild_filter() {
  data_can_ids_.reset();
  for (const ReceivePdo& pdo : receive_) {
    if (pdo.valid()) {
      data_can_ids_.set(pdo.can_id());
    }
  }
}

bool PdoService::receive(const can::Frame& frame, SimTime now) {
  if (!operational_ || frame.extended || frame.identifier > kCanIdMask) {
    return false;
  }
  if (frame.remote) {
    const auto found = std::ranges::find_if(transmit_, [&frame](const TransmitPdo& pdo) {
      return pdo.answers_remote_frames() && pdo.can_id() == frame.identifier;
    });
    if (found == transmit_.end()) {
      return false;
    }
    found->on_remote_frame(now);
    return true;
  }
  if (!data_can_ids_[frame.identifier]) {
    return false;
  }
  for (ReceivePdo& pdo : receive_) {
    if (pdo.valid() && pdo.can_id() == frame.identifier) {
      receive_data(pdo, frame, now);
    }
  }
  return true;
}

void PdoService::receive_data(ReceivePdo& pdo, const can::Frame& frame, SimTime now) {
  ++statistics_.received;
  if (pdo.synchronous() && now > window_end_) {
    ++statistics_.outside_window;
    return;
  }
  clear_timeout(pdo, now);
  const ReceivePdo::Reception reception = pdo.receive(frame, now, refused_hook(pdo, now));
  if (reception != ReceivePdo::Reception::no_mapping) {
    check_length(pdo, frame, now);
  }
  if (reception == ReceivePdo::Reception::written) {
    process_data_have_come(now);
  }
}

void PdoService::check_length(ReceivePdo& pdo, const can::Frame& frame, SimTime now) {
  const std::uint8_t expected = pdo.mapping().bytes();
  std::uint16_t error = 0;
  if (frame.length < expected) {
    error = kTooShort;
  } else if (frame.length > expected && rules_.long_pdo != LongPdo::process) {
    error = kTooLong;
  }
  statistics_.length_errors += error != 0 ? 1U : 0U;
  if (error == pdo.length_error) {
    return;
  }
  if (pdo.length_error != 0) {
    emergencies_.clear(pdo.length_error, cause_of(pdo), now);
  }
  pdo.length_error = error;
  if (error != 0) {
    const bool taken = error == kTooLong && rules_.long_pdo == LongPdo::process_and_report;
    reporter_.report(
        now, rules::kPdoLength,
        {kReceivePdoCommunication + int{pdo.number()}, int{expected}, int{frame.length},
         taken ? base::StaticText("the mapped ones were taken")
               : base::StaticText("nothing was taken")});
    emergencies_.raise(
        {.code = error, .error_register = kErrorRegisterCommunication, .cause = cause_of(pdo)},
        now);
  }
}

void PdoService::clear_errors(ReceivePdo& pdo, SimTime now) {
  if (const std::uint16_t error = std::exchange(pdo.length_error, std::uint16_t{0}); error != 0) {
    emergencies_.clear(error, cause_of(pdo), now);
  }
  clear_timeout(pdo, now);
  for (const PdoMapping::Item& item : pdo.mapping().items()) {
    if (item.refused) {
      emergencies_.clear(kParameterError, cause_of(pdo, item), now);
    }
  }
  pdo.mapping().forget_refusals();
}

void PdoService::clear_timeout(ReceivePdo& pdo, SimTime now) {
  if (std::exchange(pdo.timed_out, false)) {
    emergencies_.clear(kTimeout, cause_of(pdo), now);
  }
}

PdoMapping::RefusedHook PdoService::refused_hook(const ReceivePdo& pdo, SimTime now) {
  unpacking_ = &pdo;
  unpacking_time_ = now;
  return PdoMapping::RefusedHook::bind<&PdoService::on_refused>(*this);
}

void PdoService::on_refused(const PdoMapping::Item& item, const dictionary::Refusal* refusal,
                            std::uint64_t raw) {
  const std::uint8_t cause = cause_of(*unpacking_, item);
  if (refusal == nullptr) {
    emergencies_.clear(kParameterError, cause, unpacking_time_);
    return;
  }
  ++statistics_.refused_values;
  reporter_.report(unpacking_time_, rules::kPdoValueRefused,
                   {kReceivePdoCommunication + int{unpacking_->number()}, int{item.entry->index()},
                    int{item.entry->subindex()}, raw, static_cast<std::uint32_t>(refusal->code)});
  emergencies_.raise(
      {.code = kParameterError, .error_register = kErrorRegisterProfile, .cause = cause},
      unpacking_time_);
}

void PdoService::process_data_have_come(SimTime now) {
  if (process_data_) {
    process_data_(now);
  }
}

void PdoService::on_sync(const Sync& sync) {
  if (!operational_) {
    return;
  }
  window_end_ = sync.window_end;
  for (TransmitPdo& pdo : transmit_) {
    pdo.on_sync(sync.counter, sync.time);
  }
  bool applied = false;
  for (ReceivePdo& pdo : receive_) {
    applied |= pdo.apply(refused_hook(pdo, sync.time));
  }
  if (applied) {
    process_data_have_come(sync.time);
  }
}

void PdoService::values_may_have_changed(SimTime now) {
  if (!operational_) {
    return;
  }
  bool event = false;
  for (TransmitPdo& pdo : transmit_) {
    event |= pdo.values_may_have_changed(now);
  }
  if (event) {
    deadline_changed();
  }
}

void PdoService::request(std::uint16_t number, SimTime now) {
  if (TransmitPdo* pdo = find_pdo(transmit_, number); pdo != nullptr) {
    pdo->request(now);
    deadline_changed();
  }
}

void PdoService::advance(SimTime now) {
  if (changed_) {
    follow_changes(now);
  }
  if (!operational_) {
    return;
  }
  for (TransmitPdo& pdo : transmit_) {
    pdo.advance(now);
  }
  check_timeouts(now);
}

void PdoService::check_timeouts(SimTime now) {
  for (ReceivePdo& pdo : receive_) {
    if (now >= pdo.deadline()) {
      pdo.expire();
      pdo.timed_out = true;
      emergencies_.raise(
          {.code = kTimeout, .error_register = kErrorRegisterCommunication, .cause = cause_of(pdo)},
          now);
    }
  }
}

SimTime PdoService::next_deadline() const {
  if (changed_) {
    return {};
  }
  SimTime deadline = SimTime::never();
  if (operational_) {
    for (const TransmitPdo& pdo : transmit_) {
      deadline = std::min(deadline, pdo.next_deadline());
    }
    for (const ReceivePdo& pdo : receive_) {
      deadline = std::min(deadline, pdo.deadline());
    }
  }
  return deadline;
}

void PdoService::mark_changed(PdoDirection direction, std::uint16_t number) {
  if (direction == PdoDirection::receive) {
    if (ReceivePdo* pdo = find_pdo(receive_, number); pdo != nullptr) {
      pdo->changed = true;
    }
  } else if (TransmitPdo* pdo = find_pdo(transmit_, number); pdo != nullptr) {
    pdo->changed = true;
  }
  changed_ = true;
  deadline_changed();
}

const PdoMapping* PdoService::mapping_of(PdoDirection direction, std::uint16_t number) {
  if (direction == PdoDirection::receive) {
    const ReceivePdo* pdo = find_pdo(receive_, number);
    return pdo == nullptr ? nullptr : &pdo->mapping();
  }
  const TransmitPdo* pdo = find_pdo(transmit_, number);
  return pdo == nullptr ? nullptr : &pdo->mapping();
}

}  // namespace stator::canopen
