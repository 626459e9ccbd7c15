// Compiled into each test program of a mutation campaign. With MUTANT_RECORD=FILE it writes a line
// per test: its name, whether it passed, the processor time it took in us, and the mutants that
// would have made a difference; before that, what is known of mutants before the first test.

#include <cstdio>
#include <cstring>
#include <ctime>

#include <gtest/gtest.h>

#include "schemata.hpp"

namespace {

class Recorder : public testing::EmptyTestEventListener {
 public:
  explicit Recorder(const char* path) : file_(std::fopen(path, "w")) {}

 private:
  void OnTestProgramStart(const testing::UnitTest& /*tests*/) override {
    std::fputs("inapplicable", file_);
    for (int i = 0; i < mutant::kCapacity; ++i) {
      if (mutant::inapplicable[i]) {
        std::fprintf(file_, " %d", i);
      }
    }
    std::fputs("\nstart", file_);
    write_notes();
  }

  void OnTestStart(const testing::TestInfo& /*test*/) override { began_ = std::clock(); }

  void OnTestEnd(const testing::TestInfo& test) override {
    const double seconds = static_cast<double>(std::clock() - began_) / CLOCKS_PER_SEC;
    std::fprintf(file_, "test %s.%s %s %.0f", test.test_suite_name(), test.name(),
                 test.result()->Passed() ? "passed" : "failed", seconds * 1e6);
    write_notes();
    std::fflush(file_);
  }

  void OnTestProgramEnd(const testing::UnitTest& /*tests*/) override { std::fclose(file_); }

  void write_notes() {
    for (int i = 0; i < mutant::kCapacity; ++i) {
      if (mutant::notes[i] != 0) {
        std::fprintf(file_, " %d:%d", i, int{mutant::notes[i]});
      }
    }
    std::fputs("\n", file_);
    std::memset(mutant::notes, 0, sizeof mutant::notes);
  }

  std::FILE* file_;
  std::clock_t began_ = 0;
};

[[maybe_unused]] const bool registered = [] {
  if (const char* path = std::getenv("MUTANT_RECORD"); path != nullptr) {
    testing::UnitTest::GetInstance()->listeners().Append(new Recorder(path));
  }
  return true;
}();

}  // namespace
