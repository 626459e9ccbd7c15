#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace stator::tests {

/// What a master, a person or time does to a node.
enum class Action : std::uint8_t {
  wait,            ///< `a` ms
  nmt,             ///< command `a` to node `b`: 0 all, 1 this one, 2 another one
  nmt_malformed,   ///< command `a` in a message with `b` bytes
  read,            ///< initiate upload of object `a`
  write,           ///< expedited download of `c` to object `a`; `b` bytes too many or too few
  segment_up,      ///< upload segment; `a`: the wrong toggle bit
  begin_download,  ///< initiate segmented download to object `a`, `b` more bytes announced than
                   ///< it has; 100: no size
  segment_down,    ///< download segment with `b` bytes, the last one if `c`; `a`: wrong toggle bit
  abort,           ///< the client gives up
  block,           ///< initiate block download (`b`) or upload of object `a`
  request,         ///< any request with command byte `a` for object `b`
  request_short,   ///< a request with `a` bytes
  receive_pdo,     ///< RPDO `a` with `b` bytes more than mapped and the values of `c`
  remote_pdo,      ///< remote frame for TPDO `a`
  sync,            ///< with `a` bytes
  guard,           ///< guarding request
  heartbeat,       ///< of node `a`
  lss,             ///< command `a` with the byte `b`
  set_supply,      ///< the power stage has its supply voltage (`a`) or too little
  power_cycle,
};

struct Step {
  Action action = Action::wait;
  std::uint32_t a = 0;
  std::int32_t b = 0;
  std::uint32_t c = 0;
};

[[nodiscard]] std::string to_text(const Step& step);

/// `length` steps that follow from `seed` alone: legal and illegal ones, with the weights of a
/// configuration that goes on until something moves.
[[nodiscard]] std::vector<Step> random_sequence(std::uint64_t seed, std::size_t length);

}  // namespace stator::tests
