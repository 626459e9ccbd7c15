#pragma once

#include <optional>
#include <utility>

#include "stator/base/sim_time.hpp"

namespace stator::rack {

/// A master inside this process that takes part in a network of a running rack for as long as
/// nobody speaks over the network's link.
class ResidentMaster {
 public:
  ResidentMaster() = default;
  ResidentMaster(const ResidentMaster&) = delete;
  ResidentMaster& operator=(const ResidentMaster&) = delete;
  virtual ~ResidentMaster() = default;

  /// Somebody spoke over the link at `now`: from this call on the network is theirs. The rack is
  /// held.
  virtual void make_way(base::SimTime now) = 0;
};

/// Who is the master of a network of a running rack: whoever is behind its link, or a resident
/// master. Guarded by the rack's mutex.
class MasterSeat {
 public:
  /// For so long a link must have been silent before a resident master is let in.
  static constexpr base::SimDuration kSilence{1'000'000'000};

  /// Something came over the link at `now`, and nobody has answered it yet.
  void hear(base::SimTime now) {
    heard_ = now;
    if (ResidentMaster* const resident = std::exchange(resident_, nullptr); resident != nullptr) {
      resident->make_way(now);
    }
  }
  /// False: somebody has spoken over the link within kSilence, or another resident master is there.
  [[nodiscard]] bool take(ResidentMaster& master, base::SimTime now) {
    if (resident_ != nullptr || (heard_ && now - *heard_ < kSilence)) {
      return false;
    }
    resident_ = &master;
    return true;
  }
  /// Does nothing if `master` had to make way already.
  void leave(const ResidentMaster& master) {
    if (resident_ == &master) {
      resident_ = nullptr;
    }
  }

 private:
  ResidentMaster* resident_ = nullptr;
  std::optional<base::SimTime> heard_;
};

}  // namespace stator::rack
