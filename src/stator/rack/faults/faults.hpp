// Faults of a target, each from armed over active to done, and what is shown of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "stator/base/expected.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/rack/faults/fault_configuration.hpp"
#include "stator/rack/faults/fault_effects.hpp"
#include "stator/rack/faults/fault_mailbox.hpp"
#include "stator/rack/faults/fault_watch.hpp"
#include "stator/rack/faults/target.hpp"

namespace stator::rack {

enum class FaultState : std::uint8_t {
  armed,   ///< waits for its begin
  active,  ///< does its harm
  done,    ///< over
};
[[nodiscard]] std::string_view to_text(FaultState state);

/// A fault as people see it.
struct FaultStatus {
  std::uint64_t id = 0;
  std::string name;
  std::string_view kind;
  std::string target;
  FaultState state = FaultState::armed;
  std::string remaining;  ///< what it waits for, or how long it goes on, in words; empty when done
  std::optional<base::SimTime> begun{};
  std::optional<base::SimTime> ended{};
  std::optional<base::SimDuration> remaining_time{};  ///< of one that ends after a time
  std::optional<std::uint64_t> remaining_count{};     ///< of one that ends after a count
  std::uint64_t hits = 0;                             ///< of one whose kind counts
};

/// The faults of a target: each waits for its begin, does its harm and ends. Passive: whoever owns
/// it calls act() when it is due. While there are no faults nothing is due and nobody is watched.
class Faults {
 public:
  /// States and signals are looked at this often while a fault waits for one.
  static constexpr base::SimDuration kLookPeriod{250'000};
  /// Faults that are over and still listed.
  static constexpr std::size_t kDoneKept = 100;

  /// `target` must outlive the faults.
  explicit Faults(faults::Target& target) : target_(target), watch_(target) {}
  Faults(const Faults&) = delete;
  Faults& operator=(const Faults&) = delete;
  ~Faults();

  /// Arms a fault at `now`, to which the rack has been brought; one without a condition begins.
  /// Returns its number, or why it cannot be.
  base::Expected<std::uint64_t, std::string> inject(const FaultConfiguration& fault,
                                                    base::SimTime now);
  /// Ends a fault or takes it back. False: there is none of that number.
  bool clear(std::uint64_t id, base::SimTime now);
  /// Does that to all, and returns to how many.
  std::size_t clear_all(base::SimTime now);
  /// All that wait or are active, and the last ones that are over; the oldest first.
  [[nodiscard]] std::vector<FaultStatus> list(base::SimTime now) const;

  /// When act() is due.
  [[nodiscard]] base::SimTime next() const { return next_; }
  /// Something is watched that may have happened with what came from a network.
  [[nodiscard]] bool looking() const { return looking_; }
  /// Begins and ends what is due at `now`.
  void act(base::SimTime now);

 private:
  struct Record {
    std::uint64_t id = 0;
    FaultConfiguration configuration;
    FaultState state = FaultState::armed;
    std::unique_ptr<FaultEffect> effect;
    std::unique_ptr<FaultWatch> watch;  ///< of one that waits for a milestone
    base::SimTime begins = base::SimTime::never();
    base::SimTime ends = base::SimTime::never();
    std::optional<base::SimTime> begun{};
    std::optional<base::SimTime> ended{};
    std::uint64_t hits = 0;
  };

  bool step(Record& record, base::SimTime now);
  void begin(Record& record, base::SimTime now);
  void end(Record& record, base::SimTime now);
  void plan(base::SimTime now);
  void forget_old();
  void report(const Record& record, base::SimTime now, bool begins);
  [[nodiscard]] const Record* find(const std::string& name) const;
  [[nodiscard]] MailboxFaults& mailbox_of(DeviceAddress device);
  void on_mailbox(const MailboxFaults& mailbox, const MailboxStep& step);
  void arm_watch(Record& record, base::SimTime now);
  [[nodiscard]] std::string remaining(const Record& record, base::SimTime now) const;

  faults::Target& target_;
  std::map<DeviceAddress, std::unique_ptr<MailboxFaults>> mailboxes_;
  SlaveOverrides held_;
  FaultWatches watch_;
  std::deque<Record> records_;
  std::uint64_t newest_ = 0;
  base::SimTime next_ = base::SimTime::never();
  bool looking_ = false;
};

}  // namespace stator::rack
