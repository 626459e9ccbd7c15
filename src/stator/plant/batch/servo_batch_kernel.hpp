#pragma once

#include "stator/base/lanes.hpp"
#include "stator/base/lanes_trigonometry.hpp"
#include "stator/plant/batch/servo_batch_block.hpp"
#include "stator/plant/mechanics/rotation_lanes.hpp"

// The usual step of a servo axis over lanes of any width: what ServoAxis::turn(),
// SynchronousMotor::turn(), Supply::draw() and CurrentSensing::measure() do, operation by
// operation, so that a lane of doubles ends in the same bits. The comments that explain the
// formulas stand there. Included only by the files that compile it for one instruction set each.

namespace stator::plant::servo_batch {

/// The motors of the lanes from `at` on.
template <typename L, typename N>
[[nodiscard]] [[gnu::always_inline]] inline ServoBatchMotor<typename L::Value> motors_of(
    const ServoBatchMotors<N>& block, std::size_t at) {
  using V = typename L::Value;
  const auto lanes = [at](const N* from) __attribute__((always_inline)) {
    return base::load<V>(from + at);
  };
  const auto& of = block.of;
  return {
      .largest_speed = lanes(of.largest_speed),
      .rate = lanes(of.rate),
      .decay = lanes(of.decay),
      .gain = lanes(of.gain),
      .from_begin = lanes(of.from_begin),
      .from_end = lanes(of.from_end),
      .square = lanes(of.square),
      .fourth = lanes(of.fourth),
      .yield = lanes(of.yield),
      .lift = lanes(of.lift),
      .mean_begin = lanes(of.mean_begin),
      .mean_end = lanes(of.mean_end),
      .opposition = lanes(of.opposition),
      .opposition_by_direct = lanes(of.opposition_by_direct),
      .opposition_by_rise = lanes(of.opposition_by_rise),
      .inverse_inductance = lanes(of.inverse_inductance),
      .flux_current = lanes(of.flux_current),
      .flux_mobility = lanes(of.flux_mobility),
      .mobility = lanes(of.mobility),
      .damping = lanes(of.damping),
      .constant_torque = lanes(of.constant_torque),
      .coulomb_friction = lanes(of.coulomb_friction),
      .stribeck_rise = lanes(of.stribeck_rise),
      .ripple_by_supply = lanes(of.ripple_by_supply),
      .ripple_by_drop = lanes(of.ripple_by_drop),
  };
}

/// What a step reads of its lanes.
template <typename L>
struct Begin {
  using V = typename L::Value;
  V current_alpha, current_beta, speed, angle, voltage_alpha, voltage_beta, torque;
  Turn<L> direction;
};

/// NearbyCogging.
template <typename L>
struct Cogging {
  using V = typename L::Value;
  V torque{}, slope{}, square{}, cube{};
};

template <typename L, typename N>
[[nodiscard]] [[gnu::always_inline]] inline Cogging<L> cogging_around(
    const ServoBatchConstants<N>& k, const Turn<L>& direction, const typename L::Value& x) {
  using V = typename L::Value;
  Cogging<L> nearby;
  if (k.cogging_count == 0) {
    return nearby;
  }
  const typename L::Mask near = (x < k.cogging_reach) & (-x < k.cogging_reach);
  if (!base::any(near)) {
    return nearby;
  }
  const Turn<L> six = doubled<L, N>(tripled<L, N>(direction));
  for (std::size_t n = 0; n < k.cogging_count; ++n) {
    const auto& harmonic = k.cogging[n];
    const Turn<L> here = multiple<L, N>(harmonic.of_six ? six : direction, harmonic.times);
    const V torque = harmonic.sine * here.sine + harmonic.cosine * here.cosine;
    const V slope = harmonic.order * (harmonic.sine * here.cosine - harmonic.cosine * here.sine);
    nearby.torque += torque;
    nearby.slope += slope;
    nearby.square += harmonic.half_square * torque;
    nearby.cube += harmonic.sixth_square * slope;
  }
  nearby.torque = base::select(near, nearby.torque, V{});
  nearby.slope = base::select(near, nearby.slope, V{});
  nearby.square = base::select(near, nearby.square, V{});
  nearby.cube = base::select(near, nearby.cube, V{});
  return nearby;
}

/// SynchronousMotor::EvenTurn.
template <typename L>
struct Even {
  using V = typename L::Value;
  V x, alpha, beta, direct0, direct1, quadrature0, quadrature1, forward0, forward1, outward1;
  Turn<L> direction;
};

template <typename L, typename N, typename T>
[[nodiscard]] [[gnu::always_inline]] inline Even<L> turn_evenly(const ServoBatchConstants<N>& k,
                                                                const ServoBatchMotor<T>& m,
                                                                const Begin<L>& at,
                                                                const typename L::Value& w0) {
  using V = typename L::Value;
  const Turn<L>& z = at.direction;
  const V& ua = at.voltage_alpha;
  const V& ub = at.voltage_beta;
  Even<L> even{};
  even.x = k.h * w0;
  even.direction = sum<L>(z, small_turn<L, N>(even.x));
  const Turn<L>& z1 = even.direction;
  const V square = even.x * even.x;
  const V both = square * (m.square + square * m.fourth);
  const V by_begin = m.from_begin + both;
  const V by_end = m.from_end + both;
  even.alpha =
      (m.decay * at.current_alpha + m.gain * ua) + (by_begin * z.cosine + by_end * z1.cosine);
  even.beta = (m.decay * at.current_beta + m.gain * ub) + (by_begin * z.sine + by_end * z1.sine);
  even.direct0 = z.cosine * at.current_alpha + z.sine * at.current_beta;
  even.direct1 = z1.cosine * even.alpha + z1.sine * even.beta;
  even.quadrature0 = z.cosine * at.current_beta - z.sine * at.current_alpha;
  even.quadrature1 = z1.cosine * even.beta - z1.sine * even.alpha;
  even.forward0 = z.cosine * ub - z.sine * ua;
  even.forward1 = z1.cosine * ub - z1.sine * ua;
  even.outward1 = z1.cosine * ua + z1.sine * ub;
  return even;
}

/// Dry friction beyond Coulomb's at `speed`, with the sign `sign`, where the shaft creeps.
template <typename L, typename N, typename T>
[[nodiscard]] [[gnu::always_inline]] inline typename L::Value stribeck(
    const ServoBatchConstants<N>& k, const ServoBatchMotor<T>& m, const typename L::Value& speed,
    const typename L::Value& sign) {
  const typename L::Value ratio = speed * k.inverse_stribeck_speed;
  return sign * (m.stribeck_rise / (N(1.0) + ratio * ratio));
}

/// SynchronousMotor::Gain.
template <typename L>
struct Gain {
  typename L::Value speed, angle;
};

template <typename L, typename N, typename T>
[[nodiscard]] [[gnu::always_inline]] inline Gain<L> gain(const ServoBatchConstants<N>& k,
                                                         const ServoBatchMotor<T>& m,
                                                         const Begin<L>& at, const Even<L>& even,
                                                         const typename L::Value& w0) {
  using V = typename L::Value;
  const V& x = even.x;
  const V quadrature = (m.mean_begin * even.quadrature0 + m.mean_end * even.quadrature1) +
                       k.twelfth * (m.inverse_inductance * (even.forward0 - even.forward1) +
                                    w0 * (even.direct1 - even.direct0));
  const Cogging<L> cogging = cogging_around<L, N>(k, at.direction, x);
  const V sign = base::select(at.speed > N(0.0), base::all<L>(N(1.0)), base::all<L>(N(-1.0)));
  const V outside = m.constant_torque + at.torque;
  const V steady = outside - sign * m.coulomb_friction;
  const V ratio = at.speed * k.inverse_stribeck_speed;
  const typename L::Mask creeps = ratio * ratio <= N(1e4);
  const bool any_creeps = base::any(creeps);
  V rise{};
  if (any_creeps) {
    rise = base::select(creeps, stribeck<L, N>(k, m, at.speed, sign), V{});
  }
  const V drag = m.damping * w0;
  const V gained = k.h * ((m.flux_mobility * even.quadrature0 - drag) +
                          m.mobility * ((steady - rise) + cogging.torque));
  const V rising = (m.inverse_inductance * even.forward0 - m.rate * even.quadrature0) -
                   w0 * (m.flux_current + even.direct0);
  const V bend = k.bend * (m.flux_mobility * rising + m.mobility * cogging.slope * w0);
  if (any_creeps) {
    const V later = (w0 + N(0.5) * gained) * k.inverse_pole_pairs;
    rise = base::select(creeps, stribeck<L, N>(k, m, later, sign), V{});
  }
  const T push = k.h * m.flux_mobility;
  const V opposition = push * ((m.opposition + m.opposition_by_direct * even.direct1) -
                               m.opposition_by_rise *
                                   (w0 * even.quadrature1 + m.inverse_inductance * even.outward1)) +
                       N(0.5) * k.h * m.damping;
  const V mean = cogging.torque + x * (N(0.5) * cogging.slope + x * (N(1.0 / 3.0) * cogging.square +
                                                                     x * (N(0.25) * cogging.cube)));
  const V evenly = push * quadrature + k.h * (m.mobility * ((steady - rise) + mean) - drag);
  const V speed = evenly - gained * opposition;
  return {speed, k.quarter * (speed + gained) + bend};
}

/// turned(): the angle stays in 0..2 pi, whole periods are counted.
template <typename L, typename N>
[[gnu::always_inline]] inline void turn_by(typename L::Value& angle, typename L::Integers& periods,
                                           const typename L::Value& delta) {
  using V = typename L::Value;
  constexpr N kTwoPi = N(2.0 * 3.14159265358979323846);
  const V sum = angle + delta;
  const typename L::Mask over = sum >= kTwoPi;
  const typename L::Mask under = sum < N(0.0);
  const V raised = sum + kTwoPi;
  const typename L::Mask again =
      under & (raised >= kTwoPi);  // a tiny negative angle rounds up to a period
  const V from_below = base::select(again, V{}, raised);
  angle = base::select(over, sum - kTwoPi, base::select(under, from_below, sum));
  periods = periods + base::ones<L>(over) - base::ones<L>(under) + base::ones<L>(again);
}

/// Supply::draw().
template <typename L, typename N>
[[gnu::always_inline]] inline typename L::Value draw(const ServoBatchConstants<N>& k,
                                                     const typename L::Value& voltage,
                                                     const typename L::Value& source,
                                                     const typename L::Value& power,
                                                     const typename L::Mask& chopping) {
  using V = typename L::Value;
  const V current = power * (N(1.0) / base::larger(voltage, base::all<L>(k.lowest_voltage)));
  const V charge = voltage - k.of_current * current;
  const V of_alone = base::select(chopping, base::all<L>(k.alone_chopping), base::all<L>(k.alone));
  const V of_both =
      base::select(chopping, base::all<L>(k.supplied_chopping), base::all<L>(k.supplied));
  const V alone = charge * of_alone;
  const V supplied = (charge + k.feed * source) * of_both;
  return base::larger(base::select(alone < source, supplied, alone), V{});
}

/// What the sensors tell of the currents and the angle.
template <typename L, typename N>
[[gnu::always_inline]] inline void sense(const ServoBatchConstants<N>& k,
                                         base::ServoLanes<N>& signals, std::size_t at,
                                         const typename L::Value& alpha,
                                         const typename L::Value& beta,
                                         const typename L::Value& angle,
                                         const typename L::Value& supply) {
  using V = typename L::Value;
  const V half = N(0.5) * alpha;
  const V side = N(0.86602540378443864676) * beta;
  const V phases[3] = {alpha, side - half, -side - half};
  for (std::size_t n = 0; n < 3; ++n) {
    V value = phases[n];
    if (!k.exact_sensing) {
      value = k.sense_gain[n] * (value + k.sense_offset[n]);
      value = base::within(value, base::all<L>(-k.sense_range), base::all<L>(k.sense_range));
      if (k.quantised) {
        value = base::whole<V>(value * k.inverse_resolution) * k.resolution;
      }
    }
    base::store(&signals.phase_current[n][at], value);
  }
  V seen = angle;
  if (k.counts_per_radian > N(0.0)) {
    seen = (base::whole_below<V>(angle * k.counts_per_radian) + N(0.5)) * k.radians_per_count;
  }
  base::store(&signals.angle[at], seen);
  base::store(&signals.supply_voltage[at], supply);
}

/// dead_time_drop(): takes the drop from the voltages; the result is the power lost in diodes, W.
template <typename L, typename N, typename T>
[[nodiscard]] [[gnu::always_inline]] inline typename L::Value drop_voltage(
    const ServoBatchConstants<N>& k, const ServoBatchMotor<T>& m, Begin<L>& begin,
    const typename L::Value& supply) {
  using V = typename L::Value;
  const V drop = supply * k.dead_share + k.drop_by_diodes;
  const V share_of_ripple =
      N(1.0) / base::larger(supply * m.ripple_by_supply, drop * m.ripple_by_drop);
  const V half = N(0.5) * begin.current_alpha;
  const V side = N(0.86602540378443864676) * begin.current_beta;
  V phases[3] = {begin.current_alpha, side - half, -side - half};
  V lost{};
  for (V& phase : phases) {
    lost += k.drop_by_diodes * base::select(phase < N(0.0), -phase, phase);
    phase =
        drop * base::within(phase * share_of_ripple, base::all<L>(N(-1.0)), base::all<L>(N(1.0)));
  }
  begin.voltage_alpha -= (N(2.0) * phases[0] - phases[1] - phases[2]) * N(1.0 / 3.0);
  begin.voltage_beta -= (phases[1] - phases[2]) * N(0.57735026918962576451);
  return lost;
}

/// Shares of the period that a half bridge makes of the duties from there on.
template <typename V, typename N>
[[nodiscard]] [[gnu::always_inline]] inline V duty_at(const N* from) {
  return base::within(base::load<V>(from), V{}, V{} + N(1.0));
}

/// What a step of the lanes from `at` on begins with; `supply` in V.
template <typename L, typename N>
[[nodiscard]] [[gnu::always_inline]] inline Begin<L> begin_of(const ServoBatchBlock<N>& block,
                                                              const base::ServoLanes<N>& signals,
                                                              std::size_t at,
                                                              const typename L::Value& supply) {
  using V = typename L::Value;
  const V u = duty_at<V>(&signals.duty[0][at]);
  const V v = duty_at<V>(&signals.duty[1][at]);
  const V w = duty_at<V>(&signals.duty[2][at]);
  const V share_alpha = (N(2.0) * u - v - w) * N(1.0 / 3.0);
  const V share_beta = (v - w) * N(0.57735026918962576451);
  Begin<L> begin{};
  begin.current_alpha = base::load<V>(&block.current_alpha[at]);
  begin.current_beta = base::load<V>(&block.current_beta[at]);
  begin.speed = base::load<V>(&block.speed[at]);
  begin.angle = base::load<V>(&block.angle[at]);
  begin.direction = {base::load<V>(&block.sine[at]), base::load<V>(&block.cosine[at])};
  begin.voltage_alpha = supply * share_alpha;
  begin.voltage_beta = supply * share_beta;
  begin.torque = base::load<V>(&block.torque[at]);
  return begin;
}

/// One step of the lanes from `at` on; the result holds for those that need more.
template <typename L, typename N, typename T>
[[gnu::always_inline]] inline typename L::Mask step_lanes(const ServoBatchConstants<N>& k,
                                                          const ServoBatchMotor<T>& m,
                                                          ServoBatchBlock<N>& block,
                                                          base::ServoLanes<N>& signals,
                                                          std::size_t at) {
  using V = typename L::Value;
  using I = typename L::Integers;
  const V supply = base::load<V>(&block.supply_voltage[at]);
  Begin<L> begin = begin_of<L, N>(block, signals, at, supply);
  V lost_power{};
  if (k.dead_time) {
    lost_power = drop_voltage<L, N>(k, m, begin, supply);
  }

  const V w0 = begin.speed * k.pole_pairs;
  const Even<L> even = turn_evenly<L, N>(k, m, begin, w0);
  const Gain<L> gained = gain<L, N>(k, m, begin, even, w0);
  const Turn<L>& z1 = even.direction;
  const V& further = gained.angle;
  const V shift = m.yield * further;
  const V lift = further * (N(0.5) * m.flux_current * further + m.lift * even.x);
  const V alpha = even.alpha + (shift * z1.sine + lift * z1.cosine);
  const V beta = even.beta - (shift * z1.cosine - lift * z1.sine);
  const V shorter = N(1.0) - N(0.5) * further * further;
  const V w1 = w0 + gained.speed;
  const V speed = w1 * k.inverse_pole_pairs;
  const V mean_alpha = m.mean_begin * begin.current_alpha + m.mean_end * alpha;
  const V mean_beta = m.mean_begin * begin.current_beta + m.mean_end * beta;
  const V power =
      N(1.5) * ((begin.voltage_alpha * mean_alpha + begin.voltage_beta * mean_beta) +
                k.twelfth * m.flux_current * (w1 * even.forward1 - w0 * even.forward0)) +
      lost_power;

  // A shaft that stands or turns round, or is too fast for one step.
  const typename L::Mask left_over =
      (begin.speed * speed <= N(0.0)) | (begin.speed > m.largest_speed) |
      (-begin.speed > m.largest_speed) | (speed > N(1e4)) | (-speed > N(1e4));
  V angle = begin.angle;
  const I periods_before = base::load<I>(&block.periods[at]);
  I periods = periods_before;
  turn_by<L, N>(angle, periods, even.x + further);
  const V source = base::load<V>(&block.supply_source[at]);
  V voltage = source;
  const I chopper = base::load<I>(&block.chopper_conducts[at]);
  I chops = chopper;
  if (!k.ideal_supply) {
    const typename L::Mask on = supply >= k.chopper_on_voltage;
    const typename L::Mask stays = (supply >= k.chopper_off_voltage) & base::holds<L>(chopper);
    const typename L::Mask chopping = on | stays;
    chops = base::ones<L>(chopping);
    voltage = draw<L, N>(k, supply, source, power, chopping);
  }

  const auto kept = [&left_over](const auto& before, const auto& after)
      __attribute__((always_inline)) {
    return base::select(left_over, before, after);
  };
  const V sine = shorter * z1.sine + further * z1.cosine;
  const V cosine = shorter * z1.cosine - further * z1.sine;
  base::store(&block.current_alpha[at], kept(begin.current_alpha, alpha));
  base::store(&block.current_beta[at], kept(begin.current_beta, beta));
  base::store(&block.speed[at], kept(begin.speed, speed));
  base::store(&block.sine[at], kept(begin.direction.sine, sine));
  base::store(&block.cosine[at], kept(begin.direction.cosine, cosine));
  base::store(&block.angle[at], kept(begin.angle, angle));
  base::store(&block.periods[at], kept(periods_before, periods));
  base::store(&block.supply_voltage[at], kept(supply, voltage));
  base::store(&block.chopper_conducts[at], kept(chopper, chops));
  base::store(&block.supply_power[at], power);
  base::store(&block.left_over[at], base::ones<L>(left_over));
  sense<L, N>(k, signals, at, alpha, beta, angle, voltage);
  return left_over;
}

template <typename N, int kBytes>
[[gnu::always_inline]] inline bool step_blocks(const ServoBatchConstants<N>& k,
                                               const ServoBatchPlants<N>& plants,
                                               ServoBatchBlock<N>* blocks,
                                               base::ServoLanes<N>* signals, std::size_t count) {
  using L = base::Lanes<N, kBytes>;
  typename L::Mask left_over{};
  if (plants.own == nullptr) {
    for (std::size_t b = 0; b < count; ++b) {
      for (std::size_t at = 0; at < ServoBatchBlock<N>::kLanes; at += L::kCount) {
        left_over |= step_lanes<L, N>(k, plants.common, blocks[b], signals[b], at);
      }
    }
    return base::any(left_over);
  }
  for (std::size_t b = 0; b < count; ++b) {
    for (std::size_t at = 0; at < ServoBatchBlock<N>::kLanes; at += L::kCount) {
      const auto own = motors_of<L, N>(plants.own[b], at);
      left_over |= step_lanes<L, N>(k, own, blocks[b], signals[b], at);
    }
  }
  return base::any(left_over);
}

/// What the sensors tell of the lanes as they are.
template <typename N>
inline void sense_lane(const ServoBatchConstants<N>& k, const ServoBatchBlock<N>& block,
                       base::ServoLanes<N>& signals, std::size_t at) {
  sense<base::Lanes<N, sizeof(N)>, N>(k, signals, at, block.current_alpha[at],
                                      block.current_beta[at], block.angle[at],
                                      block.supply_voltage[at]);
}

/// refresh_blocks() of one lane.
template <typename N>
inline void refresh_lane(ServoBatchBlock<N>& block, std::size_t at) {
  const auto direction = base::sine_cosine_lanes<base::Lanes<N, sizeof(N)>>(block.angle[at]);
  block.sine[at] = direction.sine;
  block.cosine[at] = direction.cosine;
}

template <typename N, int kBytes>
[[gnu::always_inline]] inline void refresh_blocks(ServoBatchBlock<N>* blocks, std::size_t count) {
  using L = base::Lanes<N, kBytes>;
  for (std::size_t b = 0; b < count; ++b) {
    for (std::size_t at = 0; at < ServoBatchBlock<N>::kLanes; at += L::kCount) {
      const Turn<L> direction =
          base::sine_cosine_lanes<L>(base::load<typename L::Value>(&blocks[b].angle[at]));
      base::store(&blocks[b].sine[at], direction.sine);
      base::store(&blocks[b].cosine[at], direction.cosine);
    }
  }
}

}  // namespace stator::plant::servo_batch
