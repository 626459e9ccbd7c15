#pragma once

#include <string_view>

#include "stator/base/delegate.hpp"
#include "stator/ethercat/standard/al_state.hpp"
#include "stator/ethercat/standard/al_status_text.hpp"
#include "stator/master/bus.hpp"

namespace stator::master {

/// AL status and AL status code of one slave (registers 0130h and 0134h).
struct AlStatus {
  ethercat::AlState state = ethercat::AlState::init;
  bool error = false;
  ethercat::AlStatusCode code = ethercat::AlStatusCode::no_error;
};

/// What the master does while it waits: lets time pass or keeps process data running.
using Idle = base::Delegate<Result<void>()>;

[[nodiscard]] Result<AlStatus> read_al_status(Bus& bus, const Station& station);

/// Acknowledges an indicated error, requests `state` and waits for it (ETG.1000.6 §6.4).
/// ErrorCode::state_refused with the AL status code in `detail` if the slave indicates an error,
/// ErrorCode::state_timeout if nothing happens.
[[nodiscard]] Result<void> request_al_state(Bus& bus, const Station& station,
                                            ethercat::AlState state, const Idle& idle);

}  // namespace stator::master
