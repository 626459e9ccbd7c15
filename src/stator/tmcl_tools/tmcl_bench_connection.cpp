#include "stator/tmcl_tools/tmcl_bench_connection.hpp"

#include <thread>

#include "stator/tmcl_tools/failure.hpp"

namespace stator::tmcl_tools {

void TmclBenchConnection::catch_up() {
  const std::chrono::nanoseconds elapsed = std::chrono::steady_clock::now() - start_;
  bench_.advance_to(clock_ == BenchClock::machine
                        ? base::SimTime(base::SimDuration(elapsed.count()))
                        : bench_.now() + kCommandTime);
}

base::Expected<TmclReply, TmclConnection::Error> TmclBenchConnection::execute(
    const tmcl::Instruction& instruction) {
  catch_up();
  const tmcl::HostAnswer answer =
      bench_.firmware().execute(instruction, tmcl::Origin::serial, bench_.now());
  if (answer.event_mask != 0) {
    event_mask_ = answer.event_mask;
  }
  TmclReply reply{.status = answer.status, .value = answer.value, .version = {}, .cell = {}};
  if (answer.form == tmcl::ReplyForm::version_text) {
    reply.version = bench_.firmware().description().version_text;
  } else if (answer.form == tmcl::ReplyForm::instruction) {
    reply.cell = answer.instruction;
  }
  return reply;
}

bool TmclBenchConnection::take_event() {
  if (event_mask_ == 0 || !bench_.firmware().targets_reached(event_mask_)) {
    return false;
  }
  event_mask_ = 0;
  return true;
}

bool TmclBenchConnection::pass(base::SimDuration duration) {
  if (clock_ == BenchClock::machine) {
    std::this_thread::sleep_for(std::chrono::nanoseconds(duration.nanoseconds()));
    catch_up();
  } else {
    bench_.advance_to(bench_.now() + duration);
  }
  return take_event();
}

base::Expected<void, TmclConnection::Error> TmclBenchConnection::set_input(
    const std::string& assignment) {
  try {
    const InputChange change = parse_input_change(assignment, base::SimTime());
    bench_.set_input(change.input, change.value);
  } catch (const Failure& failure) {
    return base::Unexpected{std::string(failure.what())};
  }
  return {};
}

}  // namespace stator::tmcl_tools
