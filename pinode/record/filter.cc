#include "pinode/record/filter.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;

constexpr int kLargestOrder = 10;
// Histories that run through the recursion in parallel. A single history is
// limited by the latency of its own chain of additions.
constexpr int kLanes = 8;

// Computes the roots of s^2 + b s + c for complex b, c.
void Roots(Complex b, Complex c, Complex* first, Complex* second) {
  const Complex discriminant = std::sqrt(b * b - 4.0 * c);
  // The root without cancellation first.
  const Complex sum = std::real(std::conj(b) * discriminant) >= 0.0
                          ? b + discriminant
                          : b - discriminant;
  *first = -0.5 * sum;
  *second = c / *first;
}

// Bilinear transform with s measured in units of 2 / dt.
Complex ToDiscrete(Complex s) { return (1.0 + s) / (1.0 - s); }

}  // namespace

bool FilterOptions::IsValid(double sampling_step, std::string* error) const {
  CHECK(error != nullptr);
  CHECK_GT(sampling_step, 0.0);
  const double nyquist = 0.5 / sampling_step;
  const size_t num_corners = type == FilterType::kBandPass ? 2 : 1;
  if (corner_frequencies.size() != num_corners) {
    *error = "filter: " + std::to_string(corner_frequencies.size()) +
             " corner frequencies, expected " + std::to_string(num_corners) +
             " for this type";
    return false;
  }
  for (const double corner : corner_frequencies) {
    if (!(corner > 0.0) || !(corner < nyquist)) {
      *error = "filter: corner frequency " + FormatNumber(corner, 6) +
               ", expected one above 0 and below half the sampling rate (" +
               FormatNumber(nyquist, 6) + ")";
      return false;
    }
  }
  if (num_corners == 2 && !(corner_frequencies[0] < corner_frequencies[1])) {
    *error = "filter: corner frequencies " +
             FormatNumber(corner_frequencies[0], 6) + " and " +
             FormatNumber(corner_frequencies[1], 6) +
             ", expected the lower one first";
    return false;
  }
  if (order < 1 || order > kLargestOrder) {
    *error = "filter: order " + std::to_string(order) + ", expected 1 to " +
             std::to_string(kLargestOrder);
    return false;
  }
  return true;
}

ZeroPhaseFilter::ZeroPhaseFilter(const FilterOptions& options,
                                 double sampling_step)
    : sampling_step_(sampling_step) {
  std::string error;
  CHECK(options.IsValid(sampling_step, &error)) << error;

  // Corners of the analog filter that the bilinear transform maps onto the
  // wanted ones.
  std::vector<double> warped;
  for (const double corner : options.corner_frequencies) {
    warped.push_back(std::tan(kPi * corner * sampling_step));
  }
  // Point of unit gain: the middle of the pass band on the unit circle.
  Complex unit_gain_at = 1.0;
  double center = 0.0;
  double bandwidth = 0.0;
  if (options.type == FilterType::kHighPass) {
    unit_gain_at = -1.0;
  } else if (options.type == FilterType::kBandPass) {
    center = std::sqrt(warped[0] * warped[1]);
    bandwidth = warped[1] - warped[0];
    unit_gain_at = ToDiscrete(Complex(0.0, center));
  }

  // One section of two analog poles, either conjugate or both real.
  auto add_section = [&](Complex pole1, Complex pole2) {
    const Complex z1 = ToDiscrete(pole1);
    const Complex z2 = ToDiscrete(pole2);
    Section section{};
    section.a1 = -std::real(z1 + z2);
    section.a2 = std::real(z1 * z2);
    switch (options.type) {
      case FilterType::kLowPass:  // (z + 1)^2
        section.b0 = 1.0, section.b1 = 2.0, section.b2 = 1.0;
        break;
      case FilterType::kHighPass:  // (z - 1)^2
        section.b0 = 1.0, section.b1 = -2.0, section.b2 = 1.0;
        break;
      case FilterType::kBandPass:  // (z + 1) (z - 1)
        section.b0 = 1.0, section.b1 = 0.0, section.b2 = -1.0;
        break;
    }
    sections_.push_back(section);
  };
  auto add_first_order_section = [&](double pole) {
    Section section{};
    section.a1 = -std::real(ToDiscrete(pole));
    section.b0 = 1.0;
    section.b1 = options.type == FilterType::kLowPass ? 1.0 : -1.0;
    sections_.push_back(section);
  };

  for (int k = 0; 2 * k < options.order; ++k) {
    // Poles of the prototype, on the left half of the unit circle: those of
    // the upper quadrant, and the real one of odd orders (the last one).
    const double angle =
        kPi * (2 * k + 1 + options.order) / (2.0 * options.order);
    const bool real = 2 * k + 1 == options.order;
    const Complex pole =
        real ? Complex(-1.0, 0.0) : Complex(std::cos(angle), std::sin(angle));
    if (options.type == FilterType::kBandPass) {
      // s -> (s^2 + center^2) / (bandwidth s).
      Complex first, second;
      Roots(-bandwidth * pole, center * center, &first, &second);
      if (real) {
        add_section(first, second);
      } else {
        add_section(first, std::conj(first));
        add_section(second, std::conj(second));
      }
      continue;
    }
    const Complex scaled = options.type == FilterType::kLowPass
                               ? warped[0] * pole
                               : warped[0] / pole;
    if (real) {
      add_first_order_section(scaled.real());
    } else {
      add_section(scaled, std::conj(scaled));
    }
  }

  double cascade_gain = 1.0;
  for (Section& section : sections_) {
    const Complex z = unit_gain_at;
    const double gain =
        std::abs((section.b0 * z * z + section.b1 * z + section.b2) /
                 (z * z + section.a1 * z + section.a2));
    section.b0 /= gain;
    section.b1 /= gain;
    section.b2 /= gain;
    // Steady state under the constant that reaches this section.
    const double static_gain = (section.b0 + section.b1 + section.b2) /
                               (1.0 + section.a1 + section.a2);
    section.state2 = cascade_gain * (section.b2 - section.a2 * static_gain);
    section.state1 =
        cascade_gain * (section.b1 - section.a1 * static_gain) + section.state2;
    cascade_gain *= static_gain;
  }

  // Three times the number of coefficients of the equivalent single section.
  const bool has_first_order_section =
      options.type != FilterType::kBandPass && options.order % 2 == 1;
  padding_ = 3 * (2 * static_cast<int>(sections_.size()) + 1 -
                  (has_first_order_section ? 1 : 0));
}

double ZeroPhaseFilter::Gain(double frequency) const {
  const Complex z = std::polar(1.0, 2.0 * kPi * frequency * sampling_step_);
  double gain = 1.0;
  for (const Section& section : sections_) {
    gain *= std::norm((section.b0 * z * z + section.b1 * z + section.b2) /
                      (z * z + section.a1 * z + section.a2));
  }
  return gain;
}

// One pass over `size` samples of kLanes histories each, sample after sample
// in memory; direction -1 runs from the last to the first.
template <int kNumLanes>
void ZeroPhaseFilter::Pass(double* work, Eigen::Index size,
                           int direction) const {
  using Lanes = Eigen::Array<double, kNumLanes, 1>;
  double* const begin = direction > 0 ? work : work + (size - 1) * kNumLanes;
  const std::ptrdiff_t step = direction * kNumLanes;
  const Lanes first = Eigen::Map<const Lanes>(begin);
  for (const Section& section : sections_) {
    Lanes state1 = section.state1 * first;
    Lanes state2 = section.state2 * first;
    double* sample = begin;
    for (Eigen::Index i = 0; i < size; ++i, sample += step) {
      Eigen::Map<Lanes> value(sample);
      const Lanes input = value;
      const Lanes output = section.b0 * input + state1;
      state1 = section.b1 * input - section.a1 * output + state2;
      state2 = section.b2 * input - section.a2 * output;
      value = output;
    }
  }
}

template <int kNumLanes>
void ZeroPhaseFilter::Filter(double* columns, Eigen::Index num_samples,
                             Eigen::Index stride) const {
  const Eigen::Index padding =
      std::min<Eigen::Index>(padding_, num_samples - 1);
  const Eigen::Index size = num_samples + 2 * padding;
  std::vector<double> work(static_cast<size_t>(size) * kNumLanes);
  auto at = [&work](Eigen::Index sample, int lane) -> double& {
    return work[static_cast<size_t>(sample) * kNumLanes +
                static_cast<size_t>(lane)];
  };
  for (int lane = 0; lane < kNumLanes; ++lane) {
    const double* column = columns + lane * stride;
    const double twice_first = 2.0 * column[0];
    const double twice_last = 2.0 * column[num_samples - 1];
    for (Eigen::Index i = 0; i < padding; ++i) {
      at(i, lane) = twice_first - column[padding - i];
      at(padding + num_samples + i, lane) =
          twice_last - column[num_samples - 2 - i];
    }
    for (Eigen::Index i = 0; i < num_samples; ++i)
      at(padding + i, lane) = column[i];
  }
  Pass<kNumLanes>(work.data(), size, 1);
  Pass<kNumLanes>(work.data(), size, -1);
  for (int lane = 0; lane < kNumLanes; ++lane) {
    double* column = columns + lane * stride;
    for (Eigen::Index i = 0; i < num_samples; ++i)
      column[i] = at(padding + i, lane);
  }
}

void ZeroPhaseFilter::ApplyToColumns(double* columns, Eigen::Index num_samples,
                                     Eigen::Index num_columns) const {
  if (num_samples == 0) return;
  Eigen::Index j = 0;
  for (; j + kLanes <= num_columns; j += kLanes) {
    Filter<kLanes>(columns + j * num_samples, num_samples, num_samples);
  }
  for (; j < num_columns; ++j) {
    Filter<1>(columns + j * num_samples, num_samples, num_samples);
  }
}

void ZeroPhaseFilter::Apply(Vector* values) const {
  CHECK(values != nullptr);
  CHECK(values->allFinite())
      << "a filter spreads a missing sample over the whole history: fill the "
         "gaps first (FillMissing)";
  ApplyToColumns(values->data(), values->size(), 1);
}

void ZeroPhaseFilter::Apply(Matrix* columns) const {
  CHECK(columns != nullptr);
  CHECK(columns->allFinite())
      << "a filter spreads a missing sample over the whole history: fill the "
         "gaps first (FillMissing)";
  ApplyToColumns(columns->data(), columns->rows(), columns->cols());
}

}  // namespace pinode
