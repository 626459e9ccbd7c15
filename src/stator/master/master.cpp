#include "stator/master/master.hpp"

#include <algorithm>
#include <numeric>

#include "stator/master/bus.hpp"
#include "stator/master/cyclic_exchange.hpp"
#include "stator/master/distributed_clocks.hpp"
#include "stator/master/mailbox_client.hpp"
#include "stator/master/process_data.hpp"
#include "stator/master/registers.hpp"
#include "stator/master/scan.hpp"
#include "stator/master/sdo_client.hpp"
#include "stator/master/sdo_information_client.hpp"
#include "stator/master/text.hpp"

namespace stator::master {

using ethercat::AlState;

namespace {

constexpr std::uint16_t kInitWithAcknowledge = 0x11;
constexpr std::size_t kSmallestMailbox = 16;  // mailbox, CoE and SDO header

bool has_coe(const SlaveInformation& information) {
  return information.coe && information.receive_mailbox.length >= kSmallestMailbox &&
         information.transmit_mailbox.length >= kSmallestMailbox;
}

std::vector<std::size_t> all_positions(std::span<const Slave> slaves) {
  std::vector<std::size_t> positions(slaves.size());
  std::iota(positions.begin(), positions.end(), std::size_t{0});
  return positions;
}

/// What the master keeps for a slave with a mailbox.
struct Communication {
  Communication(Bus& bus, const Slave& slave, const Idle& idle)
      : mailbox(bus, station_of(slave), slave.information, idle) {}

  MailboxClient mailbox;
  SdoClient sdo{mailbox};
  SdoInformationClient information{mailbox};
};

}  // namespace

struct Master::State {
  State(FramePort& port_to_use, const MasterOptions& options_to_use)
      : options(options_to_use), bus(port_to_use, options) {}
  State(FramePort& port_to_use, const State& other);

  Result<void> idle();
  Result<Slave*> slave_at(std::size_t position);
  Result<Communication*> communication_with(std::size_t position);
  Result<void> start_mailbox(Slave& slave);
  Result<void> set(std::span<const std::size_t> positions, AlState state);

  MasterOptions options;
  Bus bus;
  std::vector<Slave> slaves;
  std::vector<std::unique_ptr<Communication>> communications;  ///< null: no CoE
  std::vector<std::size_t> exchanging;  ///< positions of the slaves that have process data
  CyclicExchange cyclic{bus};
  bool operational = false;
};

Master::State::State(FramePort& port_to_use, const State& other)
    : options(other.options),
      bus(port_to_use, options),
      slaves(other.slaves),
      exchanging(other.exchanging),
      cyclic(bus, other.cyclic),
      operational(other.operational) {
  bus.go_on_from(other.bus);
  for (std::size_t i = 0; i < other.communications.size(); ++i) {
    const Communication* const known = other.communications[i].get();
    communications.push_back(
        known == nullptr
            ? nullptr
            : std::make_unique<Communication>(bus, slaves[i], Idle::bind<&State::idle>(*this)));
    if (known != nullptr) {
      communications.back()->mailbox.go_on_from(known->mailbox);
    }
  }
}

/// While something is waited for: process data go on if they run already.
Result<void> Master::State::idle() {
  if (operational) {
    return cyclic.run_cycle();
  }
  bus.port().wait(options.poll_interval);
  return {};
}

Result<Slave*> Master::State::slave_at(std::size_t position) {
  if (position < slaves.size()) {
    return &slaves[position];
  }
  return fail(ErrorCode::argument, "there is no slave " + std::to_string(position) + "; " +
                                       (slaves.empty() ? "scan first"
                                                       : "the segment has slaves 0 to " +
                                                             std::to_string(slaves.size() - 1)));
}

Result<Communication*> Master::State::communication_with(std::size_t position) {
  const auto slave = slave_at(position);
  if (!slave) {
    return base::Unexpected{slave.error()};
  }
  if (communications[position] == nullptr) {
    return fail(ErrorCode::mailbox, station_of(**slave).name() +
                                        " has no CoE mailbox according to its SII, so it has no "
                                        "objects to read or write");
  }
  return communications[position].get();
}

Result<void> Master::State::start_mailbox(Slave& slave) {
  const Station station = station_of(slave);
  const auto status = read_al_status(bus, station);
  if (!status) {
    return base::Unexpected{status.error()};
  }
  slave.state = status->state;
  if (status->state != AlState::init && status->state != AlState::bootstrap) {
    return {};
  }
  if (Communication* const communication = communications[slave.position].get();
      communication != nullptr) {
    if (auto done = communication->mailbox.configure(); !done) {
      return done;
    }
  }
  // From here on the EEPROM belongs to the slave's host, which may read its own settings.
  if (auto done = bus.write_number(station, registers::kSiiOwner, std::uint8_t{1}); !done) {
    return done;
  }
  auto done =
      request_al_state(bus, station, AlState::pre_operational, Idle::bind<&State::idle>(*this));
  if (done) {
    slave.state = AlState::pre_operational;
  }
  return done;
}

Result<void> Master::State::set(std::span<const std::size_t> positions, AlState state) {
  for (const std::size_t position : positions) {
    Slave& slave = slaves[position];
    if (auto done =
            request_al_state(bus, station_of(slave), state, Idle::bind<&State::idle>(*this));
        !done) {
      return done;
    }
    slave.state = state;
  }
  return {};
}

Master::Master(FramePort& port, const MasterOptions& options)
    : state_(std::make_unique<State>(port, options)) {}

Master::Master(FramePort& port, const Master& other)
    : state_(std::make_unique<State>(port, *other.state_)) {}

Master::Master(Master&& other) noexcept = default;
Master& Master::operator=(Master&& other) noexcept = default;
Master::~Master() = default;

const std::vector<Slave>& Master::slaves() const {
  return state_->slaves;
}

const CycleStatistics& Master::cycle_statistics() const {
  return state_->cyclic.statistics();
}

FramePort& Master::port() {
  return state_->bus.port();
}

const MasterOptions& Master::options() const {
  return state_->options;
}

bool Master::operational() const {
  return state_->operational;
}

bool Master::process_data_configured() const {
  return state_->cyclic.configured();
}

Result<void> Master::scan() {
  State& state = *state_;
  state.operational = false;
  state.communications.clear();
  state.slaves.clear();
  state.exchanging.clear();
  state.cyclic.clear();

  auto slaves = scan_segment(state.bus);
  if (!slaves) {
    return base::Unexpected{slaves.error()};
  }
  state.slaves = std::move(*slaves);
  for (const Slave& slave : state.slaves) {
    state.communications.push_back(
        has_coe(slave.information)
            ? std::make_unique<Communication>(state.bus, slave, Idle::bind<&State::idle>(state))
            : nullptr);
  }
  return state.set(all_positions(state.slaves), AlState::init);
}

Result<AlStatus> Master::al_status(std::size_t position) {
  const auto slave = state_->slave_at(position);
  return slave ? read_al_status(state_->bus, station_of(**slave)) : base::Unexpected{slave.error()};
}

Result<std::uint16_t> Master::al_status_of_all() {
  std::array<std::byte, 2> status{};
  const auto counter = state_->bus.execute(
      ethercat::Command::brd, ethercat::physical_address(0, registers::kAlStatus), status);
  return counter ? Result<std::uint16_t>(base::load_le<std::uint16_t>(status.data()))
                 : base::Unexpected{counter.error()};
}

Result<void> Master::read_registers(std::size_t position, std::uint16_t address,
                                    std::span<std::byte> out) {
  const auto slave = state_->slave_at(position);
  return slave ? state_->bus.read(station_of(**slave), address, out)
               : Result<void>(base::Unexpected{slave.error()});
}

Result<void> Master::request_state(std::size_t position, AlState al_state) {
  const auto slave = state_->slave_at(position);
  if (!slave) {
    return base::Unexpected{slave.error()};
  }
  state_->operational = state_->operational && al_state == AlState::operational;
  auto done = request_al_state(state_->bus, station_of(**slave), al_state,
                               Idle::bind<&State::idle>(*state_));
  if (done) {
    (*slave)->state = al_state;
  }
  return done;
}

Result<void> Master::start_mailbox(std::size_t position) {
  const auto slave = state_->slave_at(position);
  return slave ? state_->start_mailbox(**slave) : base::Unexpected{slave.error()};
}

Result<void> Master::configure_process_data() {
  if (state_->slaves.empty()) {
    return fail(ErrorCode::argument, "there are no slaves to configure; scan first");
  }
  return configure_process_data(all_positions(state_->slaves));
}

Result<void> Master::configure_process_data(std::span<const std::size_t> positions) {
  State& state = *state_;
  state.operational = false;
  state.exchanging.clear();
  std::vector<SlaveProcessData> process_data(state.slaves.size());
  for (const std::size_t position : positions) {
    const auto found = state.slave_at(position);
    if (!found) {
      return base::Unexpected{found.error()};
    }
    Slave& slave = **found;
    if (auto done = state.start_mailbox(slave); !done) {
      return done;
    }
    Communication* const communication = state.communications[slave.position].get();
    auto data = read_process_data(station_of(slave), slave.information,
                                  communication == nullptr ? nullptr : &communication->sdo);
    if (!data) {
      return base::Unexpected{data.error()};
    }
    process_data[position] = std::move(*data);
  }
  if (auto done = state.cyclic.configure(std::move(process_data)); !done) {
    return done;
  }
  for (const std::size_t position : positions) {
    if (auto done = state.cyclic.write_mapping(station_of(state.slaves[position])); !done) {
      return done;
    }
  }
  state.exchanging.assign(positions.begin(), positions.end());
  return state.set(state.exchanging, AlState::safe_operational);
}

Result<void> Master::go_operational() {
  State& state = *state_;
  if (!state.cyclic.configured()) {
    return fail(ErrorCode::argument, "process data are not configured");
  }
  // Outputs must be there before the request; from now on waiting means exchanging.
  state.operational = true;
  auto done = state.cyclic.run_cycle();
  if (done) {
    done = state.set(state.exchanging, AlState::operational);
  }
  state.operational = done.has_value();
  return done;
}

Result<void> Master::stop() {
  state_->operational = false;
  std::array<std::byte, 2> control{};
  base::store_le(control.data(), kInitWithAcknowledge);
  return state_->bus.broadcast(registers::kAlControl, control);
}

Result<void> Master::synchronize_clocks() {
  const auto reference = master::synchronize_clocks(state_->bus, state_->slaves);
  if (!reference) {
    return base::Unexpected{reference.error()};
  }
  state_->cyclic.set_reference_clock(*reference);
  return {};
}

Result<void> Master::exchange_process_data() {
  return state_->cyclic.exchange();
}

Result<void> Master::run_cycle() {
  return state_->cyclic.run_cycle();
}

std::span<std::byte> Master::outputs(std::size_t position) {
  return state_->cyclic.outputs(position);
}

std::span<const std::byte> Master::inputs(std::size_t position) const {
  return state_->cyclic.inputs(position);
}

std::span<const MappedEntry> Master::output_entries(std::size_t position) const {
  return state_->cyclic.output_entries(position);
}

std::span<const MappedEntry> Master::input_entries(std::size_t position) const {
  return state_->cyclic.input_entries(position);
}

Result<std::vector<std::byte>> Master::upload(std::size_t position, ObjectAddress object) {
  const auto slave = state_->communication_with(position);
  return slave ? (*slave)->sdo.upload(object) : base::Unexpected{slave.error()};
}

Result<void> Master::download(std::size_t position, ObjectAddress object,
                              std::span<const std::byte> data) {
  const auto slave = state_->communication_with(position);
  return slave ? (*slave)->sdo.download(object, data) : base::Unexpected{slave.error()};
}

Result<std::vector<std::uint16_t>> Master::object_list(std::size_t position, ObjectListType type) {
  const auto slave = state_->communication_with(position);
  return slave ? (*slave)->information.object_list(type) : base::Unexpected{slave.error()};
}

Result<ObjectDescription> Master::object_description(std::size_t position, std::uint16_t index) {
  const auto slave = state_->communication_with(position);
  return slave ? (*slave)->information.object_description(index) : base::Unexpected{slave.error()};
}

Result<EntryDescription> Master::entry_description(std::size_t position, std::uint16_t index,
                                                   std::uint8_t subindex) {
  const auto slave = state_->communication_with(position);
  return slave ? (*slave)->information.entry_description(index, subindex)
               : base::Unexpected{slave.error()};
}

Result<std::vector<Emergency>> Master::take_emergencies(std::size_t position) {
  const auto slave = state_->communication_with(position);
  if (!slave) {
    return base::Unexpected{slave.error()};
  }
  if (const auto done = (*slave)->mailbox.collect(); !done) {
    return base::Unexpected{done.error()};
  }
  return (*slave)->mailbox.take_emergencies();
}

Error Master::wrong_length(std::size_t position, ObjectAddress object, std::size_t expected,
                           std::size_t actual) const {
  return {ErrorCode::protocol, 0,
          "SDO read of " + to_text(object) + " from slave " + std::to_string(position) +
              ": the object has " + std::to_string(actual) + " bytes, " + std::to_string(expected) +
              " were expected"};
}

}  // namespace stator::master
