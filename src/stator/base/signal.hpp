#pragma once

#include <string>

namespace stator::base {

/// How a signal is read: a member function that only looks, bound to its object, which must outlive
/// How a signal is read: a const member function bound to its object, which must outlive the
/// reader. Code that holds a signal cannot change the object. An empty reader must not be called.
class SignalReader {
 public:
  constexpr SignalReader() = default;

  /// `SignalReader::bind<&Class::method>(object)`; a method that is not const does not compile.
  template <auto Method, typename Object>
  static constexpr SignalReader bind(const Object& object) {
    SignalReader reader;
    reader.object_ = &object;
    reader.read_ = [](const void* target) -> double {
      return (static_cast<const Object*>(target)->*Method)();
    };
    return reader;
  }

  double operator()() const { return read_(object_); }

 private:
  const void* object_ = nullptr;
  double (*read_)(const void*) = nullptr;
};

/// A named, unit-carrying value that can be recorded or plotted, e.g. "axis0.position_actual" in
/// "microstep".
struct Signal {
  std::string name;
  std::string unit;
  SignalReader read;
};

}  // namespace stator::base
