#pragma once

#include <cstdint>

#include "stator/base/sim_time.hpp"
#include "stator/link/system/file_descriptor.hpp"

namespace stator::link {

/// Sleeps until one of several descriptors can be read, until a moment of the machine's clock, or
/// until woken.
class DescriptorWait {
 public:
  /// Throws std::runtime_error when the system has no descriptors left.
  DescriptorWait();

  /// Waits for `descriptor` from now on, which must stay open. Throws std::runtime_error if the
  /// system cannot wait for it.
  void add(int descriptor);
  /// Leaves `descriptor` aside, or minds it again.
  void mind(int descriptor, bool minded);

  /// Sleeps `time` at most, with the resolution of the machine's timers (some 50 us); not at all if
  /// it is 0 or less.
  void sleep(base::SimDuration time);

  /// Ends the present sleep or the next one. From any thread.
  void wake() noexcept;

 private:
  FileDescriptor epoll_;
  FileDescriptor timer_;
  FileDescriptor wake_;
};

}  // namespace stator::link
