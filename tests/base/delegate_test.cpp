// Member functions bound to objects: const ones, references as arguments, size, emptiness.
#include "stator/base/delegate.hpp"

#include <string>

#include <gtest/gtest.h>

namespace stator::base {
namespace {

class Counter {
 public:
  int add(int amount) { return sum_ += amount; }
  [[nodiscard]] int sum() const { return sum_; }
  void append_to(std::string& text) const { text += std::to_string(sum_); }

 private:
  int sum_ = 0;
};

TEST(Delegate, IsEmptyUntilBound) {
  EXPECT_FALSE(static_cast<bool>(Delegate<int(int)>()));
  Counter counter;
  EXPECT_TRUE(static_cast<bool>(Delegate<int(int)>::bind<&Counter::add>(counter)));
}

TEST(Delegate, CallsTheMemberOfTheObjectItWasBoundTo) {
  Counter first;
  Counter second;
  const auto add_to_first = Delegate<int(int)>::bind<&Counter::add>(first);
  const auto add_to_second = Delegate<int(int)>::bind<&Counter::add>(second);
  EXPECT_EQ(add_to_first(5), 5);
  EXPECT_EQ(add_to_first(5), 10);
  EXPECT_EQ(add_to_second(1), 1);
  EXPECT_EQ(first.sum(), 10);
}

TEST(Delegate, CallsConstMembers) {
  Counter counter;
  counter.add(4);
  EXPECT_EQ(Delegate<int()>::bind<&Counter::sum>(counter)(), 4);
}

TEST(Delegate, PassesReferencesOn) {
  Counter counter;
  counter.add(4);
  std::string text = "sum ";
  Delegate<void(std::string&)>::bind<&Counter::append_to>(counter)(text);
  EXPECT_EQ(text, "sum 4");
}

TEST(Delegate, IsTwoWords) {
  EXPECT_EQ(sizeof(Delegate<int(int)>), 2 * sizeof(void*));
}

}  // namespace
}  // namespace stator::base
