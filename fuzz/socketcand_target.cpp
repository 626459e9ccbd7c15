// The server's end of socketcand: any text in any pieces, in all modes.

#include <tuple>

#include "can_text.hpp"
#include "stator/link/can/socketcand_session.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  stator::link::SocketcandSession session;
  if (size % 2 == 0) {
    std::string answers;
    std::ignore = session.take("< open can0 >", stator::link::MachineTime(), answers);
  }
  stator::fuzz::feed(session, {data, size}, [](const stator::can::Frame&) {});
  return 0;
}
