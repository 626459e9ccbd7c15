// An incremental encoder on the shaft of a motor.

#include <algorithm>
#include <array>
#include <cmath>

#include "stator/board/peripheral/peripheral.hpp"
#include "stator/board/peripheral/peripheral_types.hpp"

namespace stator::board {

namespace {

// Pins: A, B and N, then their inverted lines in the same order.
constexpr std::size_t kA = 0;
constexpr std::size_t kAn = 3;

/// Turns the motion of a shaft into edges, each at the moment at which the disc meets it: within a
/// step of the plant the shaft is taken to turn evenly.
class Encoder final : public Peripheral, public ShaftObserver {
 public:
  explicit Encoder(const Settings& settings)
      : counts_per_revolution_(settings.integer("counts_per_revolution")),
        index_position_(settings.integer("index_position") % counts_per_revolution_),
        offset_(settings.number("offset")),
        reversed_(settings.flag("reversed")) {}

  bool connect(std::size_t /*connection*/, Peripheral& other) override {
    shaft_ = other.shaft();
    if (shaft_ != nullptr) {
      shaft_->attach(*this);
    }
    return shaft_ != nullptr;
  }

  void begin(base::SimTime now) override {
    count_ = count_at(shaft_->position());
    place_ = modulo(count_, counts_per_revolution_);
    power_on_ = count_;
    show(now, kEveryLine);
  }

  void moves(const ShaftMotion& motion) override {
    // An edge that the last motion put on its very end.
    for (const std::int64_t begin = count_at(motion.from); count_ != begin;) {
      turn(motion.begin, count_ < begin);
    }
    motion_ = motion;
    target_ = count_at(motion.to);
    begin_ = within(motion.from);
    way_ = static_cast<double>((motion.to.turns - motion.from.turns) * counts_per_revolution_) +
           within(motion.to) - begin_;
    schedule_edge();
  }

  void advance(base::SimTime now) override {
    if (now >= edge_at_) {
      turn(now, count_ < target_);
      schedule_edge();
    } else if (glitches_ != 0) {
      const std::int64_t direction = glitches_ > 0 ? 1 : -1;
      glitches_ -= direction;
      false_counts_ += direction;
      show(now);
      schedule_next(now);
    }
  }

  std::vector<base::Signal> signals() const override {
    return {{"count", "count", base::SignalReader::bind<&Encoder::count>(*this)}};
  }
  std::vector<base::Input> inputs() override {
    using Set = base::Delegate<void(double)>;
    return {
        {"lost", "", 0.0, 1.0, Set::bind<&Encoder::lose<7U>>(*this), base::InputGroup::sensors},
        {"a_lost", "", 0.0, 1.0, Set::bind<&Encoder::lose<1U>>(*this), base::InputGroup::sensors},
        {"b_lost", "", 0.0, 1.0, Set::bind<&Encoder::lose<2U>>(*this), base::InputGroup::sensors},
        {"index_lost", "", 0.0, 1.0, Set::bind<&Encoder::lose<4U>>(*this),
         base::InputGroup::sensors},
        {"false_counts", "count", -1e5, 1e5, Set::bind<&Encoder::disturb>(*this),
         base::InputGroup::sensors}};
  }

 private:
  static constexpr unsigned kEveryLine = 7;

  static constexpr std::int64_t modulo(std::int64_t value, std::int64_t divisor) {
    const std::int64_t rest = value % divisor;
    return rest < 0 ? rest + divisor : rest;
  }
  [[nodiscard]] double count() const {
    const std::int64_t counts = count_ - power_on_;
    return static_cast<double>(reversed_ ? -counts : counts);
  }
  /// Place on the disc in counts beyond the begin of the turn.
  [[nodiscard]] double within(const ShaftPosition& position) const {
    return position.fraction * static_cast<double>(counts_per_revolution_) + offset_;
  }
  [[nodiscard]] std::int64_t count_at(const ShaftPosition& position) const {
    return position.turns * counts_per_revolution_ +
           static_cast<std::int64_t>(std::floor(within(position)));
  }

  /// Breaks or mends lines (as of levels()), which keep their level while they are broken.
  template <unsigned kLines>
  void lose(double lost) {
    broken_ = lost >= 0.5 ? broken_ | kLines : broken_ & ~kLines;
    show(now());
  }
  /// So many edges that no disc made come soon after each other.
  void disturb(double counts) {
    glitches_ += static_cast<std::int64_t>(counts);
    schedule_next(now());
  }
  void schedule_next(base::SimTime now) {
    constexpr base::SimDuration kBetweenGlitches(1'000);
    schedule(glitches_ == 0 ? edge_at_ : std::min(edge_at_, now + kBetweenGlitches));
  }

  void schedule_edge() {
    edge_at_ = base::SimTime::never();
    if (count_ == target_) {
      schedule_next(now());
      return;
    }
    // Upwards the edge lies at the begin of the next count, downwards at the begin of this one.
    const std::int64_t edge = count_ < target_ ? count_ + 1 : count_;
    const double to_edge =
        static_cast<double>(edge - motion_.from.turns * counts_per_revolution_) - begin_;
    const double share = std::clamp(to_edge / way_, 0.0, 1.0);
    const auto after = static_cast<std::int64_t>(
        std::floor(share * static_cast<double>(motion_.duration.nanoseconds()) + 0.5));
    edge_at_ = motion_.begin + base::SimDuration(after);
    schedule_next(now());
  }

  void turn(base::SimTime now, bool up) {
    count_ += up ? 1 : -1;
    place_ += up ? 1 : -1;
    if (place_ == counts_per_revolution_) {
      place_ = 0;
    } else if (place_ < 0) {
      place_ += counts_per_revolution_;
    }
    show(now);
  }

  /// Levels of the lines A, B, N, as bits 0 to 2.
  [[nodiscard]] unsigned levels() const {
    const std::int64_t quarter = modulo((reversed_ ? -count_ : count_) + false_counts_, 4);
    const bool a = quarter == 1 || quarter == 2;
    const bool b = quarter >= 2;
    const bool n = place_ == index_position_;
    return (a ? 1U : 0U) | (b ? 2U : 0U) | (n ? 4U : 0U);
  }
  void show(base::SimTime now) { show(now, levels() ^ shown_); }
  void show(base::SimTime now, unsigned changed) {
    changed &= ~broken_;
    shown_ = (shown_ & ~changed) | (levels() & changed);
    for (std::size_t line = 0; line < 3; ++line) {
      if ((changed >> line & 1U) != 0) {
        const bool level = (shown_ >> line & 1U) != 0;
        drive(now, kA + line, level);
        drive(now, kAn + line, !level);
      }
    }
  }

  std::int64_t counts_per_revolution_;
  std::int64_t index_position_;
  double offset_;
  bool reversed_;
  Shaft* shaft_ = nullptr;
  ShaftMotion motion_;
  double begin_ = 0.0;       ///< of motion_, as within() counts
  double way_ = 0.0;         ///< of motion_ in counts
  std::int64_t count_ = 0;   ///< the lines show it
  std::int64_t place_ = 0;   ///< count_ on the disc: modulo its revolution
  std::int64_t target_ = 0;  ///< at the end of motion_
  std::int64_t power_on_ = 0;
  unsigned shown_ = 0;                              ///< levels() as driven
  unsigned broken_ = 0;                             ///< lines that stand as they are
  base::SimTime edge_at_ = base::SimTime::never();  ///< of the disc
  std::int64_t glitches_ = 0;      ///< false edges still to come, forward if positive
  std::int64_t false_counts_ = 0;  ///< that came
};

constexpr std::array<PinDeclaration, 6> kPins{
    {{"a", PinUse::drives, false, "leads B while the shaft turns forward"},
     {"b", PinUse::drives, false, ""},
     {"n", PinUse::drives, true, "high for one count in each revolution"},
     {"an", PinUse::drives, true, "the inverted signals of a differential encoder"},
     {"bn", PinUse::drives, true, ""},
     {"nn", PinUse::drives, true, ""}}};

constexpr std::array<ParameterDeclaration, 4> kParameters{
    {{"counts_per_revolution", "", 1.0, 1e8, 4000.0, "edges of A and B together"},
     {"index_position", "count", 0.0, 1e8, 0.0, "within the revolution, where N is high"},
     {"offset", "count", -1e8, 1e8, 0.5, "by which the disc is turned against the shaft"},
     {"reversed", "", 0.0, 1.0, 0.0, "1: A lags B while the shaft turns forward"}}};

constexpr std::array<ConnectionDeclaration, 1> kConnections{
    {{"shaft", ConnectionKind::shaft, false, "the motor it sits on"}}};

}  // namespace

constinit const PeripheralType kEncoder{
    "encoder",
    "incremental encoder on a motor's shaft",
    kPins,
    kParameters,
    kConnections,
    [](const Settings& settings) -> std::unique_ptr<Peripheral> {
      return std::make_unique<Encoder>(settings);
    }};

}  // namespace stator::board
