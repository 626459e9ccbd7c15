// Time until a change of a kept file is on the disk, beside that of a whole file in its place,
// which every change took before there were records. The disk is that of the directory for
// temporary files; set TMPDIR for another one. Limit: a change takes no longer than half of a whole
// file.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "stator/rack/kept/kept_file_writer.hpp"

namespace stator::rack {
namespace {

class KeptFileBenchmark : public benchmark::Fixture {
 public:
  void SetUp(const benchmark::State& state) override {
    std::string name = (std::filesystem::temp_directory_path() / "stator-bench-XXXXXX").string();
    path_ = ::mkdtemp(name.data());
    directory_ = std::make_unique<StateDirectory>(path_);
    content_ = {"eeprom", "TMCM-3315",
                std::vector<std::byte>(static_cast<std::size_t>(state.range(0)))};
  }
  void TearDown(const benchmark::State& /*state*/) override {
    directory_.reset();
    std::filesystem::remove_all(path_);
  }

 protected:
  /// As many bytes differ as the benchmark's second argument says.
  void change(const benchmark::State& state) {
    ++count_;
    for (std::int64_t i = 0; i < state.range(1); ++i) {
      content_.content[static_cast<std::size_t>(i + state.range(0) / 4)] =
          static_cast<std::byte>(count_);
    }
  }

  std::string path_;
  std::unique_ptr<StateDirectory> directory_;
  KeptFile content_;
  unsigned count_ = 0;
};

BENCHMARK_DEFINE_F(KeptFileBenchmark, Change)(benchmark::State& state) {
  KeptFileWriter writer(*directory_, "file");
  writer.write(content_);
  for (auto iteration : state) {
    change(state);
    writer.write(content_);
  }
}

BENCHMARK_DEFINE_F(KeptFileBenchmark, WholeFile)(benchmark::State& state) {
  for (auto iteration : state) {
    change(state);
    directory_->replace("file", encode(content_.kind, content_.product, content_.content));
  }
}

/// Bytes of content, and how many of them change: a word of an SII, parameters of a TMCC160, a
/// coordinate in the EEPROM of a TMCM-142, a program there, a firmware image.
void sizes(benchmark::internal::Benchmark* benchmark) {
  benchmark->Args({4096, 2})
      ->Args({700, 100})
      ->Args({16384, 4})
      ->Args({16384, 8192})
      ->Args({1 << 20, 1 << 19})
      ->Unit(benchmark::kMicrosecond)
      ->UseRealTime();
}
BENCHMARK_REGISTER_F(KeptFileBenchmark, Change)->Apply(sizes);
BENCHMARK_REGISTER_F(KeptFileBenchmark, WholeFile)->Apply(sizes);

}  // namespace
}  // namespace stator::rack
