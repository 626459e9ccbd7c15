// How a program opens and looks for files by name; those that show interfaces are this library's.

#include <cstdarg>
#include <cstdio>
#include <string>

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

#include "stator/link/can_exec/interface_files.hpp"
#include "stator/link/can_exec/system_calls.hpp"

#define STATOR_EXPORT extern "C" __attribute__((visibility("default")))

namespace stator::link::can_exec {

namespace {

/// The third argument of open(), which is there if a file may be made.
mode_t take_mode(int flags, std::va_list& arguments) {
  return (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(arguments, mode_t) : mode_t{0};
}

/// Calls the C library's function of that name with `path` as it shall be found; `arguments` are
/// behind it.
template <typename Function, typename... Arguments>
auto call(Function* function, const char* path, Arguments... arguments) {
  std::string buffer;
  return function(interface_file(path, buffer), arguments...);
}

/// The same where a directory stands before the path.
template <typename Function, typename... Arguments>
auto call_at(Function* function, int directory, const char* path, Arguments... arguments) {
  std::string buffer;
  return function(directory, interface_file(path, buffer), arguments...);
}

}  // namespace

}  // namespace stator::link::can_exec

using namespace stator::link::can_exec;

// NOLINTBEGIN(readability-inconsistent-declaration-parameter-name): the C library's are no words

STATOR_EXPORT int open(const char* path, int flags, ...) {
  std::va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = take_mode(flags, arguments);
  va_end(arguments);
  return call(STATOR_SYSTEM(open), path, flags, mode);
}

STATOR_EXPORT int open64(const char* path, int flags, ...) {
  std::va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = take_mode(flags, arguments);
  va_end(arguments);
  return call(STATOR_SYSTEM(open64), path, flags, mode);
}

STATOR_EXPORT int openat(int directory, const char* path, int flags, ...) {
  std::va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = take_mode(flags, arguments);
  va_end(arguments);
  return call_at(STATOR_SYSTEM(openat), directory, path, flags, mode);
}

STATOR_EXPORT int openat64(int directory, const char* path, int flags, ...) {
  std::va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = take_mode(flags, arguments);
  va_end(arguments);
  return call_at(STATOR_SYSTEM(openat64), directory, path, flags, mode);
}

STATOR_EXPORT std::FILE* fopen(const char* path, const char* mode) {
  return call(STATOR_SYSTEM(fopen), path, mode);
}

STATOR_EXPORT std::FILE* fopen64(const char* path, const char* mode) {
  return call(STATOR_SYSTEM(fopen64), path, mode);
}

STATOR_EXPORT DIR* opendir(const char* path) {
  return call(STATOR_SYSTEM(opendir), path);
}

STATOR_EXPORT int scandir(const char* path, dirent*** entries, int (*selects)(const dirent*),
                          int (*compares)(const dirent**, const dirent**)) {
  return call(STATOR_SYSTEM(scandir), path, entries, selects, compares);
}

STATOR_EXPORT int scandir64(const char* path, dirent64*** entries, int (*selects)(const dirent64*),
                            int (*compares)(const dirent64**, const dirent64**)) {
  return call(STATOR_SYSTEM(scandir64), path, entries, selects, compares);
}

STATOR_EXPORT int stat(const char* path, struct stat* status) noexcept {
  return call(STATOR_SYSTEM(stat), path, status);
}

STATOR_EXPORT int stat64(const char* path, struct stat64* status) noexcept {
  return call(STATOR_SYSTEM(stat64), path, status);
}

STATOR_EXPORT int lstat(const char* path, struct stat* status) noexcept {
  return call(STATOR_SYSTEM(lstat), path, status);
}

STATOR_EXPORT int lstat64(const char* path, struct stat64* status) noexcept {
  return call(STATOR_SYSTEM(lstat64), path, status);
}

STATOR_EXPORT int fstatat(int directory, const char* path, struct stat* status,
                          int flags) noexcept {
  return call_at(STATOR_SYSTEM(fstatat), directory, path, status, flags);
}

STATOR_EXPORT int fstatat64(int directory, const char* path, struct stat64* status,
                            int flags) noexcept {
  return call_at(STATOR_SYSTEM(fstatat64), directory, path, status, flags);
}

STATOR_EXPORT int statx(int directory, const char* path, int flags, unsigned wanted,
                        struct statx* status) noexcept {
  return call_at(STATOR_SYSTEM(statx), directory, path, flags, wanted, status);
}

STATOR_EXPORT int access(const char* path, int mode) noexcept {
  return call(STATOR_SYSTEM(access), path, mode);
}

STATOR_EXPORT int faccessat(int directory, const char* path, int mode, int flags) noexcept {
  return call_at(STATOR_SYSTEM(faccessat), directory, path, mode, flags);
}

STATOR_EXPORT ssize_t readlink(const char* path, char* buffer, std::size_t size) noexcept {
  return call(STATOR_SYSTEM(readlink), path, buffer, size);
}

STATOR_EXPORT ssize_t readlinkat(int directory, const char* path, char* buffer,
                                 std::size_t size) noexcept {
  return call_at(STATOR_SYSTEM(readlinkat), directory, path, buffer, size);
}

STATOR_EXPORT ssize_t getxattr(const char* path, const char* name, void* value,
                               std::size_t size) noexcept {
  return call(STATOR_SYSTEM(getxattr), path, name, value, size);
}

STATOR_EXPORT ssize_t lgetxattr(const char* path, const char* name, void* value,
                                std::size_t size) noexcept {
  return call(STATOR_SYSTEM(lgetxattr), path, name, value, size);
}

// NOLINTEND(readability-inconsistent-declaration-parameter-name)

// What programs call instead that were built with _FORTIFY_SOURCE, or for a C library before 2.33.
// NOLINTBEGIN(*-reserved-identifier,cert-dcl*,*-identifier-naming): so they are called

STATOR_EXPORT int __open_2(const char* path, int flags) {
  return call(STATOR_SYSTEM(open), path, flags);
}

STATOR_EXPORT int __open64_2(const char* path, int flags) {
  return call(STATOR_SYSTEM(open64), path, flags);
}

STATOR_EXPORT int __openat_2(int directory, const char* path, int flags) {
  return call_at(STATOR_SYSTEM(openat), directory, path, flags);
}

STATOR_EXPORT int __openat64_2(int directory, const char* path, int flags) {
  return call_at(STATOR_SYSTEM(openat64), directory, path, flags);
}

STATOR_EXPORT int __xstat(int /*version*/, const char* path, struct stat* status) noexcept {
  return stat(path, status);
}

STATOR_EXPORT int __xstat64(int /*version*/, const char* path, struct stat64* status) noexcept {
  return stat64(path, status);
}

STATOR_EXPORT int __lxstat(int /*version*/, const char* path, struct stat* status) noexcept {
  return lstat(path, status);
}

STATOR_EXPORT int __lxstat64(int /*version*/, const char* path, struct stat64* status) noexcept {
  return lstat64(path, status);
}

// NOLINTEND(*-reserved-identifier,cert-dcl*,*-identifier-naming)
