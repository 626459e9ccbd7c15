#include "signal_store.hpp"

#include <algorithm>
#include <span>
#include <utility>

namespace stator::python {

void Column::grow() {
  constexpr std::size_t kFirst = 1024;
  const std::size_t capacity = std::max(kFirst, 2 * capacity_);
  const auto larger = std::make_shared<double[]>(capacity);
  std::copy_n(values_.get(), size_, larger.get());
  values_ = larger;
  capacity_ = capacity;
}

SignalStore::SignalStore(rack::Rack& rack, std::vector<product::Signal> signals,
                         base::SimDuration period, base::SimTime now)
    : rack_(rack), tap_(std::move(signals), period, kWaitingRows), values_(tap_.signals().size()) {
  rack_.add(tap_, now);
}

SignalStore::~SignalStore() {
  rack_.remove(tap_);
}

void SignalStore::take() {
  const std::size_t rows = tap_.size();
  for (std::size_t row = 0; row < rows; ++row) {
    times_.append(tap_.time(row).seconds());
    const std::span<const double> sample = tap_.values(row);
    for (std::size_t i = 0; i < sample.size(); ++i) {
      values_[i].append(sample[i]);
    }
  }
  tap_.release(rows);
}

void SignalStore::clear() {
  take();
  times_.clear();
  for (Column& column : values_) {
    column.clear();
  }
}

}  // namespace stator::python
