// Why the EtherCAT master could not do what was asked: a code for programs and a sentence for
// people.
#pragma once

#include <cstdint>
#include <string>

#include "stator/base/expected.hpp"

namespace stator::master {

enum class ErrorCode : std::uint8_t {
  port,             ///< the port could not send or receive; the text is the port's own
  timeout,          ///< no answer to a frame, after all retries
  working_counter,  ///< a datagram came back, but not from as many slaves as it should
  no_slaves,        ///< nobody answers on the segment
  sii,              ///< the slave's SII cannot be read or makes no sense
  state_refused,    ///< the slave refused a state change; `detail` is the AL status code
  state_timeout,    ///< the slave neither changed state nor refused
  mailbox,          ///< the slave has no mailbox, did not answer, or answered with an error
  sdo_aborted,      ///< `detail` is the SDO abort code
  protocol,         ///< an answer came that the protocol does not allow here
  configuration,    ///< the slave's description cannot be used, e.g. a PDO mapping out of range
  drive_fault,      ///< the drive is in Fault; `detail` is the error code 603Fh
  drive_timeout,    ///< the drive did not reach a state or target in time
  argument,         ///< the caller asked for something that does not exist
};

/// Why the master could not do what was asked. `text` is one sentence for people: what, where, what
/// was expected and what to do.
struct Error {
  ErrorCode code = ErrorCode::protocol;
  std::uint32_t detail = 0;
  std::string text;
};

template <typename T>
using Result = base::Expected<T, Error>;

[[nodiscard]] inline base::Unexpected<Error> fail(ErrorCode code, std::string text,
                                                  std::uint32_t detail = 0) {
  return base::Unexpected<Error>{Error{code, detail, std::move(text)}};
}

}  // namespace stator::master
