// Functors of the elements with a memory: hysteresis, friction,
// viscoelasticity. Each takes deformation and rate and gives one force, as in
// elements.h. All are for AutoDiffLaw. Their right-hand sides are continuous,
// so that no integration step has to be cut.

#ifndef PINODE_DYNAMICS_MEMORY_LAWS_H_
#define PINODE_DYNAMICS_MEMORY_LAWS_H_

#include <cmath>

namespace pinode {

// |x|^p with a derivative that stays finite at x = 0, where Jets would
// compute 0 * inf. The tiny shift is far below anything measurable.
template <typename T>
T SafePower(const T& magnitude, const T& exponent) {
  using std::pow;
  return pow(magnitude + 1e-30, exponent);
}

template <typename T>
T Magnitude(const T& x) {
  return x < T(0.0) ? T(-x) : x;
}

// x - clamp(x, -gap, gap).
template <typename T>
T BeyondGap(const T& x, const T& gap) {
  if (x > gap) return x - gap;
  if (x < -gap) return x + gap;
  return T(0.0);
}

// Rate of the elongation z of a spring behind a slider that yields at |z| =
// slip: w, less w (|z| / slip)^n where |z| grows. Only a start or a step that
// is too long leads beyond the slip; there the power goes on along its tangent,
// since the power itself would throw z to infinity in one step.
template <typename T>
T SliderRate(const T& w, const T& z, const T& slip, const T& n) {
  const bool outwards = (w < T(0.0)) == (z < T(0.0));
  if (!outwards) return w;
  const T ratio = Magnitude(z) / slip;
  const T share =
      ratio > T(1.0) ? T(T(1.0) + n * (ratio - T(1.0))) : SafePower(ratio, n);
  return w - w * share;
}

struct BoucWen {
  template <typename T>
  void operator()(const T* q, const T* z, const T* p, T* result) const {
    const T& w = q[1];
    const T power = SafePower(Magnitude(z[0]), p[4]);
    // |z|^(n-1) z = sign(z) |z|^n
    const T signed_power = z[0] < T(0.0) ? T(-power) : power;
    result[0] = p[0] * z[0];
    result[1] = p[1] * w -
                p[5] * (p[2] * Magnitude(w) * signed_power + p[3] * w * power);
  }
};

// Bouc-Wen's law with degradation and pinching (T. T. Baber and M. N. Noori
// 1985; pinching as in G. C. Foliente 1995). z is the force over f, e the work
// done on z over f^2 / k, so that all parameters but k and f are numbers:
//
//   dz/dt = (k w / f) (1 - nu h |z|^n) pinching / eta,   de/dt = (k w / f) z
//   h = 1 where |z| grows, else 1 - 2 s
//   nu = 1 + strength e,   eta = 1 + stiffness e
//   pinching = 1 - zeta1 exp(-((z sign(w) - level nu^(-1/n)) / zeta2)^2)
//   zeta1 = pinch (1 - exp(-rate e)),  zeta2 = (width + spread e) (mix + zeta1)
struct BaberNoori {
  template <typename T>
  void operator()(const T* q, const T* z, const T* p, T* result) const {
    using std::exp;
    const T& w = q[1];
    const T& n = p[3];
    // A shooting segment may start from less than no energy.
    const T e = z[1] > T(0.0) ? z[1] : T(0.0);
    const T strength = T(1.0) + p[4] * e;
    const T stiffness = T(1.0) + p[5] * e;
    const T zeta1 = p[6] * (T(1.0) - exp(-p[7] * e));
    const T zeta2 = (p[9] + p[10] * e) * (p[11] + zeta1);
    const T limit = SafePower(strength, T(T(-1.0) / n));
    const T from_pinch =
        ((w < T(0.0) ? T(-z[0]) : z[0]) - p[8] * limit) / zeta2;
    const T pinching = T(1.0) - zeta1 * exp(-from_pinch * from_pinch);
    const T power = SafePower(Magnitude(z[0]), n);
    const bool outwards = (w < T(0.0)) == (z[0] < T(0.0));
    const T share = outwards ? T(1.0) : T(T(1.0) - T(2.0) * p[2]);
    const T elastic = w * p[0] / p[1];
    result[0] = p[1] * z[0];
    result[1] =
        pinching / stiffness * elastic * (T(1.0) - strength * share * power);
    result[2] = elastic * z[0];
  }
};

struct BacklashFriction {
  template <typename T>
  void operator()(const T* q, const T* z, const T* p, T* result) const {
    const T& k = p[0];
    const T& gap = p[2];
    result[0] = k * BeyondGap(z[0], gap);
    result[1] = SliderRate(q[1], z[0], T(gap + p[1] / k), p[3]);
  }
};

// Spring and dashpot in series. z is the elongation of the spring.
struct Maxwell {
  template <typename T>
  void operator()(const T* q, const T* z, const T* p, T* result) const {
    result[0] = p[0] * z[0];
    result[1] = q[1] - p[0] / p[1] * z[0];
  }
};

// C. Canudas de Wit, H. Olsson, K. J. Astrom and P. Lischinsky 1995. z is the
// elongation of the bristles.
struct LuGre {
  template <typename T>
  void operator()(const T* q, const T* z, const T* p, T* result) const {
    using std::exp;
    const T& w = q[1];
    const T ratio = w / p[3];
    const T sliding = p[1] * (T(1.0) + p[2] * exp(-ratio * ratio));
    const T rate = w - p[0] * Magnitude(w) * z[0] / sliding;
    result[0] = p[0] * z[0] + p[4] * rate + p[5] * w;
    result[1] = rate;
  }
};

// D. J. Segalman's four-parameter Iwan model (2005) with kSliders sliders
// behind springs in parallel, z their elongations. Slider m stands for the
// sliding limits between two edges; it has their stiffness and their force.
// Stiffness and force of all together are then k and f exactly.
struct Iwan {
  static constexpr int kSliders = 6;
  // Ratio of two neighbouring edges, and sharpness of the slip. Measured for
  // chi = -0.4 and beta = 0.3 at amplitudes of 0.1, 0.2, 0.4 and 0.8 of the
  // widest limit: the work of a cycle is 15, 3, -1 and 1 % above the continuous
  // model's. With a sharpness of 6 it is 16, 5, 2 and 5 %, with a ratio of 1.6
  // besides 58, 12, 6 and 6 %.
  static constexpr double kEdgeRatio = 1.8;
  static constexpr double kSharpness = 8.0;

  template <typename T>
  void operator()(const T* q, const T* z, const T* p, T* result) const {
    using std::pow;
    const T& chi = p[2];
    const T& beta = p[3];
    const T one = chi + T(1.0);
    const T two = chi + T(2.0);
    // Largest sliding limit, and stiffness of all but the sliders that begin
    // to slide there together.
    const T widest = p[1] * (T(1.0) + beta) / (p[0] * (beta + one / two));
    const T spread = p[0] / (T(1.0) + beta);
    result[0] = T(0.0);
    double upper = 1.0;
    T upper_one = T(1.0);
    T upper_two = T(1.0);
    for (int m = 0; m <= kSliders; ++m) {
      T stiffness = p[0] - spread;
      T slip = widest;
      if (m > 0) {
        const double lower = m < kSliders ? upper / kEdgeRatio : 0.0;
        const T lower_one = lower > 0.0 ? T(pow(T(lower), one)) : T(0.0);
        const T lower_two = lower > 0.0 ? T(pow(T(lower), two)) : T(0.0);
        stiffness = spread * (upper_one - lower_one);
        slip = widest * one / two * (upper_two - lower_two) /
               (upper_one - lower_one);
        upper = lower;
        upper_one = lower_one;
        upper_two = lower_two;
      }
      result[0] += stiffness * z[m];
      result[1 + m] = SliderRate(q[1], z[m], slip, T(kSharpness));
    }
  }
};

}  // namespace pinode

#endif  // PINODE_DYNAMICS_MEMORY_LAWS_H_
