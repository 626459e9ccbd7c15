// When a device's hooks for reads and writes are called, and which writes never reach them.
#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "small_drive.hpp"

namespace stator::dictionary {
namespace {

constexpr base::EventRule kTooFar{"test-too-far", base::Severity::refusal, "{0:x4} too far"};

/// Firmware that owns the target position and notes what the dictionary asks of it.
class Firmware {
 public:
  explicit Firmware(Dictionary& dictionary) {
    dictionary.on_check(0x607A, 0, Entry::CheckHook::bind<&Firmware::check>(*this));
    dictionary.on_written(0x607A, 0, Entry::WrittenHook::bind<&Firmware::written>(*this));
    dictionary.on_read(0x607A, 0, Entry::ReadHook::bind<&Firmware::read>(*this));
  }

  Verdict check(const Entry& entry, std::uint64_t bits) {
    calls.push_back("check " + std::to_string(static_cast<std::int64_t>(bits)) + " over " +
                    std::to_string(entry.signed_value()));
    if (refuses) {
      return refuse(AbortCode::local_control, kTooFar, {int{entry.index()}});
    }
    return {};
  }
  void written(const Entry& entry) {
    calls.push_back("written " + std::to_string(entry.signed_value()));
  }
  void read(Entry& entry) {
    calls.emplace_back("read");
    entry.set_value(static_cast<std::uint64_t>(std::int64_t{-42}));
  }

  bool refuses = false;
  std::vector<std::string> calls;
};

using Calls = std::vector<std::string>;

TEST(DictionaryHooks, CheckSeesTheOldValueAndWrittenTheNewOne) {
  const auto dictionary = make_small_drive();
  Firmware firmware(*dictionary);
  ASSERT_TRUE(write(*dictionary, 0x607A, std::int32_t{-5}).has_value());
  EXPECT_EQ(firmware.calls, (Calls{"check -5 over -7", "written -5"}));
}

TEST(DictionaryHooks, WrittenIsToldOfTheSameValueAgain) {
  const auto dictionary = make_small_drive();
  Firmware firmware(*dictionary);
  ASSERT_TRUE(write(*dictionary, 0x607A, std::int32_t{-7}).has_value());
  EXPECT_EQ(firmware.calls, (Calls{"check -7 over -7", "written -7"}));
}

TEST(DictionaryHooks, ARefusalOfTheCheckHookLeavesTheValueAlone) {
  const auto dictionary = make_small_drive();
  Firmware firmware(*dictionary);
  firmware.refuses = true;
  const Verdict verdict = write(*dictionary, 0x607A, std::int32_t{5});
  ASSERT_FALSE(verdict.has_value());
  EXPECT_EQ(verdict.error().code, AbortCode::local_control);
  EXPECT_EQ(sentence(verdict.error()), "607Ah too far");
  EXPECT_EQ(dictionary->find(0x607A, 0)->signed_value(), -7);
  EXPECT_EQ(firmware.calls, (Calls{"check 5 over -7"}));
}

TEST(DictionaryHooks, ValuesTheDeclarationRefusesNeverReachTheFirmware) {
  const auto dictionary = make_small_drive();
  Firmware firmware(*dictionary);
  EXPECT_FALSE(write(*dictionary, 0x607A, std::int32_t{5000}).has_value());
  EXPECT_FALSE(write(*dictionary, 0x607A, std::int16_t{5}).has_value());
  EXPECT_EQ(firmware.calls, Calls{});
}

TEST(DictionaryHooks, ReadBringsTheValueUpToDateFirst) {
  const auto dictionary = make_small_drive();
  Firmware firmware(*dictionary);
  std::array<std::byte, 4> out{};
  ASSERT_TRUE(dictionary->read(*dictionary->find(0x607A, 0), out).has_value());
  EXPECT_EQ(base::load_le<std::int32_t>(out), -42);
  EXPECT_EQ(firmware.calls, (Calls{"read"}));
}

TEST(DictionaryHooks, ReadDoesSoAlsoForWhoMayOnlyLook) {
  const auto dictionary = make_small_drive();
  Firmware firmware(*dictionary);
  const Dictionary& seen = *dictionary;
  const Entry& target = *seen.find(0x607A, 0);
  EXPECT_EQ(target.signed_value(), -7) << "as it lies";
  ASSERT_TRUE(seen.prepare_read(target).has_value());
  EXPECT_EQ(target.signed_value(), -42);
  EXPECT_EQ(firmware.calls, (Calls{"read"}));
}

TEST(DictionaryHooks, ResetAndTheOwnersOwnWritesCallNone) {
  const auto dictionary = make_small_drive();
  Firmware firmware(*dictionary);
  dictionary->reset_values();
  dictionary->find(0x607A, 0)->set_value(1);
  dictionary->variable<std::int32_t>(0x607A).set(2);
  EXPECT_EQ(firmware.calls, Calls{});
}

TEST(DictionaryHooks, OfAnEntryThatDoesNotExistAreRejected) {
  const auto dictionary = make_small_drive();
  EXPECT_THROW(dictionary->on_written(0x7777, 0, {}), std::logic_error);
  EXPECT_THROW(dictionary->on_check(0x7777, 0, {}), std::logic_error);
  EXPECT_THROW(dictionary->on_read(0x1018, 1, {}), std::logic_error);
}

class TextOwner {
 public:
  void written(const Entry& entry) { last = entry.text(); }
  std::string last;
};

TEST(DictionaryHooks, WrittenIsToldOfTextsToo) {
  const auto dictionary = make_small_drive();
  TextOwner owner;
  dictionary->on_written(0x2001, 0, Entry::WrittenHook::bind<&TextOwner::written>(owner));
  const std::string text = "Ada";
  ASSERT_TRUE(dictionary->write(*dictionary->find(0x2001, 0), std::as_bytes(std::span(text)), {})
                  .has_value());
  EXPECT_EQ(owner.last, "Ada");
}

}  // namespace
}  // namespace stator::dictionary
