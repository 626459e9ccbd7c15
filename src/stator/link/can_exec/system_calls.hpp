#pragma once

#include <dlfcn.h>

namespace stator::link::can_exec {

/// The C library's function of that name, behind the one of the preloaded library.
template <typename Function>
Function* system_function(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

}  // namespace stator::link::can_exec

/// Calls the C library's `function`, looked up once.
#define STATOR_SYSTEM(function)                                                   \
  ([] {                                                                           \
    static auto* const in_c_library =                                             \
        stator::link::can_exec::system_function<decltype(::function)>(#function); \
    return in_c_library;                                                          \
  }())
