#pragma once

#include "stator/base/sim_time.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/ethercat/standard/al_state.hpp"

namespace stator::ethercat {

/// What a device implements on top of the slave stack: its reaction to the bus. The stack calls it
/// from SlaveStack::process() and SlaveStack::publish_inputs() only, never re-entrantly.
class SlaveApplication {
 public:
  SlaveApplication() = default;
  SlaveApplication(const SlaveApplication&) = delete;
  SlaveApplication& operator=(const SlaveApplication&) = delete;
  virtual ~SlaveApplication() = default;

  /// May refuse one step of a state change that the stack itself would allow, by any code but
  /// no_error (e.g. dc_invalid_sync_cycle_time). Asked on the way up only; steps down always
  /// happen.
  [[nodiscard]] virtual AlStatusCode permit_state(AlState /*from*/, AlState /*to*/,
                                                  base::SimTime /*now*/) {
    return AlStatusCode::no_error;
  }
  /// True: it has raised an event with the reason of each refusal, and the stack says no more.
  [[nodiscard]] virtual bool explains_refusals() const { return false; }

  /// The state has changed. Changes over several states come step by step: Operational to Init is
  /// told as O->S, S->P, P->I (ETG.1000.6 §6.4.1.3), so that each step is handled in one place.
  virtual void on_state(AlState from, AlState to, base::SimTime now) = 0;

  /// New process data of the master are in the dictionary; only in Operational.
  virtual void on_outputs(base::SimTime now) = 0;

  /// SYNC0 has come while the device is synchronised with it; outputs that came before are in the
  /// dictionary (on_outputs() was called). In Safe-Operational and Operational.
  virtual void on_sync0(base::SimTime /*now*/) {}

  /// Bring every object that may stand in a TxPDO up to date; the stack packs them right after.
  virtual void before_inputs(base::SimTime now) = 0;

  /// A mapped object did not take the value that came by process data and keeps its old one. Told
  /// once per object until it takes a value again (for EMCY 6320h).
  virtual void on_output_refused(const dictionary::Entry& /*entry*/,
                                 const dictionary::Refusal& /*refusal*/, base::SimTime /*now*/) {}
};

}  // namespace stator::ethercat
