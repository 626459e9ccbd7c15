#include "stator/link/system/descriptor_wait.hpp"

#include <array>
#include <cerrno>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <system_error>

#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/timerfd.h>
#include <unistd.h>

namespace stator::link {

namespace {

FileDescriptor require(int descriptor) {
  if (descriptor < 0) {
    throw std::runtime_error(
        "cannot wait for descriptors: " + std::generic_category().message(errno) +
        "; raise the limit of open files (ulimit -n)");
  }
  return FileDescriptor(descriptor);
}

void control(int epoll, int operation, int descriptor, std::uint32_t events) {
  epoll_event event{};
  event.events = events;
  event.data.fd = descriptor;
  if (::epoll_ctl(epoll, operation, descriptor, &event) != 0) {
    throw std::runtime_error("cannot wait for a descriptor: " +
                             std::generic_category().message(errno));
  }
}

/// Takes what makes a timer or wake descriptor readable.
void consume(int descriptor) {
  std::uint64_t count = 0;
  static_cast<void>(!::read(descriptor, &count, sizeof count));
}

}  // namespace

DescriptorWait::DescriptorWait()
    : epoll_(require(::epoll_create1(EPOLL_CLOEXEC))),
      timer_(require(::timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK))),
      wake_(require(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK))) {
  add(timer_.get());
  add(wake_.get());
}

void DescriptorWait::add(int descriptor) {
  control(epoll_.get(), EPOLL_CTL_ADD, descriptor, EPOLLIN);
}

void DescriptorWait::mind(int descriptor, bool minded) {
  control(epoll_.get(), EPOLL_CTL_MOD, descriptor,
          minded ? static_cast<std::uint32_t>(EPOLLIN) : 0U);
}

void DescriptorWait::sleep(base::SimDuration time) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::int64_t nanoseconds = time.nanoseconds();
  if (nanoseconds > 0) {
    itimerspec setting{};
    setting.it_value = {nanoseconds / kSecond, nanoseconds % kSecond};
    ::timerfd_settime(timer_.get(), 0, &setting, nullptr);
  }
  std::array<epoll_event, 4> events{};
  const int count = ::epoll_wait(epoll_.get(), events.data(), static_cast<int>(events.size()),
                                 nanoseconds > 0 ? -1 : 0);
  for (int i = 0; i < count; ++i) {
    const int descriptor = events[static_cast<std::size_t>(i)].data.fd;
    if (descriptor == timer_.get() || descriptor == wake_.get()) {
      consume(descriptor);
    }
  }
}

void DescriptorWait::wake() noexcept {
  const std::uint64_t one = 1;
  static_cast<void>(!::write(wake_.get(), &one, sizeof one));
}

}  // namespace stator::link
