#include "stator/web/api/program_job.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/tmcl/assembler/disassembler.hpp"
#include "stator/tmcl/interpreter/firmware.hpp"
#include "stator/web/json_text.hpp"
#include "stator/web/problem.hpp"

namespace stator::web {

namespace {

using Json = nlohmann::ordered_json;

/// Cells copied in one look at the task queue.
constexpr std::size_t kCellsAtOnce = 512;

class ProgramJob final : public LookJob {
 public:
  explicit ProgramJob(const DeviceRecord& device) : device_(device) {}

  bool look(const rack::View& rack, base::SimTime /*now*/) override {
    firmware_ = rack.device(device_.address).tmcl_firmware();
    if (firmware_ == nullptr) {
      return true;
    }
    const auto cells = firmware_->memory().cells();
    const std::size_t count = std::min(kCellsAtOnce, cells.size() - program_.size());
    const auto part = cells.subspan(program_.size(), count);
    program_.insert(program_.end(), part.begin(), part.end());
    running_ = firmware_->state().application == tmcl::ApplicationStatus::run;
    counter_ = firmware_->state().program_counter;
    return program_.size() == cells.size();
  }

  Response response() override {
    if (firmware_ == nullptr) {
      return problem(404, fmt::format("{} runs no TMCL programs", device_.name));
    }
    while (!program_.empty() && program_.back() == tmcl::Instruction()) {
      program_.pop_back();
    }
    Json lines = Json::array();
    const std::string text = disassemble(program_, firmware_->description());
    std::string_view rest(text);
    for (std::size_t address = 0; address < program_.size(); ++address) {
      const std::size_t end = std::min(rest.find('\n'), rest.size());
      lines.push_back({{"address", address}, {"text", rest.substr(0, end)}});
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return json_response({{"running", running_},
                          {"line", program_.empty() ? Json(nullptr) : Json(counter_)},
                          {"lines", std::move(lines)}});
  }

 private:
  const DeviceRecord& device_;
  const tmcl::Firmware* firmware_ = nullptr;
  std::vector<tmcl::Instruction> program_;
  bool running_ = false;
  std::size_t counter_ = 0;
};

}  // namespace

std::unique_ptr<Job> make_program_job(const DeviceRecord& device) {
  return std::make_unique<ProgramJob>(device);
}

}  // namespace stator::web
