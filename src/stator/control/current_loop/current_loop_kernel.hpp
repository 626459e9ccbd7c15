#pragma once

#include "stator/base/lanes.hpp"
#include "stator/base/lanes_trigonometry.hpp"
#include "stator/control/current_loop/current_loop_block.hpp"

// The current loop over lanes of any width. Included only by the files that compile it for one
// instruction set each.

namespace stator::control::current_loop {

template <typename L, typename N>
[[gnu::always_inline]] inline void step_lanes(const CurrentLoopConstants<N>& k,
                                              CurrentLoopBlock<N>& block,
                                              base::ServoLanes<N>& signals, std::size_t at) {
  using V = typename L::Value;
  const V u = base::load<V>(&signals.phase_current[0][at]);
  const V v = base::load<V>(&signals.phase_current[1][at]);
  const V w = base::load<V>(&signals.phase_current[2][at]);
  const V supply = base::load<V>(&signals.supply_voltage[at]);
  const auto z = base::sine_cosine_lanes<L>(base::load<V>(&signals.angle[at]));

  // Clarke, Park.
  const V alpha = (N(2.0) * u - (v + w)) * N(1.0 / 3.0);
  const V beta = (v - w) * N(0.57735026918962576451);
  const V direct = z.cosine * alpha + z.sine * beta;
  const V quadrature = z.cosine * beta - z.sine * alpha;

  const V direct_error = base::load<V>(&block.direct_target[at]) - direct;
  const V quadrature_error = base::load<V>(&block.quadrature_target[at]) - quadrature;
  const V direct_integral = base::load<V>(&block.direct_integral[at]);
  const V quadrature_integral = base::load<V>(&block.quadrature_integral[at]);
  const V ud = k.proportional * direct_error + direct_integral;
  const V uq = k.proportional * quadrature_error + quadrature_integral;

  // Back to the phases.
  const V ua = z.cosine * ud - z.sine * uq;
  const V ub = z.sine * ud + z.cosine * uq;
  const V half = N(-0.5) * ua;
  const V side = N(0.86602540378443864676) * ub;
  const V phases[3] = {ua, half + side, half - side};
  const V highest = base::larger(base::larger(phases[0], phases[1]), phases[2]);
  const V lowest = base::smaller(base::smaller(phases[0], phases[1]), phases[2]);
  const V span = highest - lowest;
  const V centre = N(-0.5) * (highest + lowest);
  const V scale = N(1.0) / base::larger(span, supply);
  for (std::size_t n = 0; n < 3; ++n) {
    V duty = N(0.5) + (phases[n] + centre) * scale;
    if (k.timer_steps > N(0.0)) {
      duty = base::whole<V>(duty * k.timer_steps) * k.inverse_timer_steps;
    }
    base::store(&signals.duty[n][at], duty);
  }

  const typename L::Mask limited = span > supply;
  base::store(&block.direct_integral[at],
              base::select(limited, direct_integral, direct_integral + k.integral * direct_error));
  base::store(&block.quadrature_integral[at],
              base::select(limited, quadrature_integral,
                           quadrature_integral + k.integral * quadrature_error));
  base::store(&block.direct_current[at], direct);
  base::store(&block.quadrature_current[at], quadrature);
}

template <typename N, int kBytes>
[[gnu::always_inline]] inline void step_blocks(const CurrentLoopConstants<N>& k,
                                               CurrentLoopBlock<N>* blocks,
                                               base::ServoLanes<N>* signals, std::size_t count) {
  using L = base::Lanes<N, kBytes>;
  for (std::size_t b = 0; b < count; ++b) {
    for (std::size_t at = 0; at < CurrentLoopBlock<N>::kLanes; at += L::kCount) {
      step_lanes<L, N>(k, blocks[b], signals[b], at);
    }
  }
}

}  // namespace stator::control::current_loop
