#pragma once

namespace stator::base {

template <typename Signature>
class Delegate;

/// A member function bound to its object: two words, no allocation, no ownership. The object must
/// outlive the delegate. An empty delegate must not be called.
template <typename Result, typename... Arguments>
class Delegate<Result(Arguments...)> {
 public:
  constexpr Delegate() = default;

  /// `Delegate<void(int)>::bind<&Class::method>(object)`.
  template <auto Method, typename Object>
  static constexpr Delegate bind(Object& object) {
    Delegate delegate;
    delegate.object_ = &object;
    delegate.call_ = [](void* target, Arguments... arguments) -> Result {
      return (static_cast<Object*>(target)->*Method)(arguments...);
    };
    return delegate;
  }

  explicit constexpr operator bool() const { return call_ != nullptr; }
  Result operator()(Arguments... arguments) const { return call_(object_, arguments...); }

 private:
  void* object_ = nullptr;
  Result (*call_)(void*, Arguments...) = nullptr;
};

}  // namespace stator::base
