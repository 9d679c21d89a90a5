#include "pinode/record/filter.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/constants.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

constexpr double kRate = 120.0;

struct ReferenceCase {
  FilterType type;
  std::vector<double> corners;
  int order;
  int num_samples;
  std::vector<double> every_fifth;
};

std::vector<ReferenceCase> ReferenceCases() {
  return {
#include "pinode/record/filter_reference.inc"
  };
}

// The history of tests/generators/zero_phase_filter.py.
Vector History(int num_samples) {
  Vector values(num_samples);
  for (int64_t i = 0; i < num_samples; ++i) {
    values[i] =
        static_cast<double>((i * i * 7919 + i * 104729 + 17) % 1001 - 500);
  }
  return values;
}

ZeroPhaseFilter MakeFilter(FilterType type, std::vector<double> corners,
                           int order, double rate = kRate) {
  return ZeroPhaseFilter({type, std::move(corners), order}, 1.0 / rate);
}

TEST(ZeroPhaseFilterTest, AgreesWithSciPy) {
  for (const ReferenceCase& c : ReferenceCases()) {
    Vector values = History(c.num_samples);
    MakeFilter(c.type, c.corners, c.order).Apply(&values);
    ASSERT_EQ(c.every_fifth.size(),
              static_cast<size_t>((c.num_samples + 4) / 5));
    for (size_t i = 0; i < c.every_fifth.size(); ++i) {
      // The history's values reach 500.
      EXPECT_NEAR(values[static_cast<Eigen::Index>(5 * i)], c.every_fifth[i],
                  500 * 1e-9)
          << "type " << static_cast<int>(c.type) << ", order " << c.order
          << ", sample " << 5 * i;
    }
  }
}

TEST(ZeroPhaseFilterTest, ColumnsOfAMatrixAreFilteredOneByOne) {
  const ZeroPhaseFilter filter =
      MakeFilter(FilterType::kBandPass, {0.8, 30.0}, 4);
  // More than one block of lanes and a rest.
  Matrix columns(200, 19);
  const Vector history = History(200 * 19);
  for (int j = 0; j < 19; ++j) columns.col(j) = history.segment(200 * j, 200);
  Matrix filtered = columns;
  filter.Apply(&filtered);
  for (int j = 0; j < 19; ++j) {
    Vector column = columns.col(j);
    filter.Apply(&column);
    EXPECT_LT((filtered.col(j) - column).norm(), 1e-12 * column.norm()) << j;
  }
}

TEST(ZeroPhaseFilterTest, IsLinear) {
  const ZeroPhaseFilter filter = MakeFilter(FilterType::kHighPass, {3.0}, 5);
  const Vector history = History(600);
  const Vector x = history.head(300);
  const Vector y = history.tail(300);
  Vector combined = 2.5 * x - 0.3 * y;
  Vector filtered_x = x;
  Vector filtered_y = y;
  filter.Apply(&combined);
  filter.Apply(&filtered_x);
  filter.Apply(&filtered_y);
  EXPECT_LT((combined - 2.5 * filtered_x + 0.3 * filtered_y).norm(),
            1e-11 * combined.norm());
}

// The gain for a sine in the middle of a long history follows the formula, and
// the phase is zero.
TEST(ZeroPhaseFilterTest, GainAndPhase) {
  const double step = 1.0 / kRate;
  auto warped = [step](double f) { return std::tan(kPi * f * step); };
  for (const int order : {1, 2, 3, 4, 7}) {
    const ZeroPhaseFilter low = MakeFilter(FilterType::kLowPass, {20.0}, order);
    const ZeroPhaseFilter high =
        MakeFilter(FilterType::kHighPass, {20.0}, order);
    const ZeroPhaseFilter band =
        MakeFilter(FilterType::kBandPass, {8.0, 20.0}, order);
    for (const double f : {0.5, 4.0, 8.0, 12.0, 20.0, 33.0, 55.0}) {
      const double w = warped(f);
      const double w_low = w / warped(20.0);
      const double w_band = (w * w - warped(8.0) * warped(20.0)) /
                            (w * (warped(20.0) - warped(8.0)));
      EXPECT_NEAR(low.Gain(f), 1.0 / (1.0 + std::pow(w_low, 2 * order)), 1e-10);
      EXPECT_NEAR(high.Gain(f), 1.0 / (1.0 + std::pow(w_low, -2 * order)),
                  1e-10);
      EXPECT_NEAR(band.Gain(f), 1.0 / (1.0 + std::pow(w_band * w_band, order)),
                  1e-10);
      for (const ZeroPhaseFilter* filter : {&low, &high, &band}) {
        Vector sine(4001);
        for (int i = 0; i < sine.size(); ++i) {
          sine[i] = std::sin(2.0 * kPi * f * step * (i - 2000) + 0.4);
        }
        Vector filtered = sine;
        filter->Apply(&filtered);
        EXPECT_LT((filtered - filter->Gain(f) * sine)
                      .segment(1800, 401)
                      .lpNorm<Eigen::Infinity>(),
                  1e-9)
            << "order " << order << ", " << f << " Hz";
      }
    }
    EXPECT_NEAR(low.Gain(20.0), 0.5, 1e-12);
    EXPECT_NEAR(band.Gain(8.0), 0.5, 1e-12);
  }
}

TEST(ZeroPhaseFilterTest, ASymmetricPulseStaysSymmetric) {
  Vector pulse = Vector::Zero(4001);
  pulse[2000] = 1.0;
  MakeFilter(FilterType::kBandPass, {2.0, 30.0}, 4).Apply(&pulse);
  Eigen::Index peak = 0;
  pulse.maxCoeff(&peak);
  EXPECT_EQ(peak, 2000);
  EXPECT_LT((pulse - pulse.reverse()).norm(), 1e-9 * pulse.norm());
}

TEST(ZeroPhaseFilterTest, ConstantsAndLinesPassALowPassUnharmedToTheEnds) {
  const ZeroPhaseFilter low = MakeFilter(FilterType::kLowPass, {10.0}, 4);
  Vector constant = Vector::Constant(50, 3.0);
  low.Apply(&constant);
  EXPECT_LT((constant.array() - 3.0).abs().maxCoeff(), 1e-12);
  // Odd reflection extends a line. The start-up of its slope decays only within
  // the padding.
  const Vector line = Vector::LinSpaced(500, 0.0, 1.0);
  Vector filtered = line;
  low.Apply(&filtered);
  EXPECT_LT((filtered - line).lpNorm<Eigen::Infinity>(), 1e-3);
  Vector high = Vector::Constant(50, 3.0);
  MakeFilter(FilterType::kHighPass, {1.0}, 4).Apply(&high);
  EXPECT_LT(high.lpNorm<Eigen::Infinity>(), 1e-8);
}

TEST(ZeroPhaseFilterTest, VeryShortHistories) {
  const ZeroPhaseFilter low = MakeFilter(FilterType::kLowPass, {10.0}, 4);
  Vector empty;
  low.Apply(&empty);
  Vector one = Vector::Constant(1, 2.0);
  low.Apply(&one);
  EXPECT_NEAR(one[0], 2.0, 1e-12);
  Vector two(2);
  two << 1.0, 2.0;
  low.Apply(&two);
  EXPECT_TRUE(two.allFinite());
}

TEST(ZeroPhaseFilterTest, PaddingIsThatOfSciPy) {
  EXPECT_EQ(MakeFilter(FilterType::kLowPass, {30.0}, 4).padding(), 15);
  EXPECT_EQ(MakeFilter(FilterType::kLowPass, {30.0}, 3).padding(), 12);
  EXPECT_EQ(MakeFilter(FilterType::kBandPass, {1.0, 30.0}, 4).padding(), 27);
  EXPECT_EQ(MakeFilter(FilterType::kBandPass, {1.0, 30.0}, 3).padding(), 21);
}

TEST(FilterOptionsTest, SaysWhatIsWrong) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const struct {
    FilterOptions options;
    const char* error;
  } cases[] = {
      {{FilterType::kLowPass, {}, 4}, "0 corner frequencies, expected 1"},
      {{FilterType::kHighPass, {1.0, 2.0}, 4}, "expected 1"},
      {{FilterType::kBandPass, {1.0}, 4}, "expected 2"},
      {{FilterType::kBandPass, {30.0, 0.8}, 4}, "the lower one first"},
      {{FilterType::kBandPass, {5.0, 5.0}, 4}, "the lower one first"},
      {{FilterType::kLowPass, {60.0}, 4}, "half the sampling rate (60)"},
      {{FilterType::kLowPass, {0.0}, 4}, "corner frequency 0"},
      {{FilterType::kLowPass, {nan}, 4}, "corner frequency nan"},
      {{FilterType::kLowPass, {5.0}, 0}, "order 0, expected 1 to 10"},
      {{FilterType::kLowPass, {5.0}, 11}, "order 11"},
  };
  for (const auto& c : cases) {
    std::string error;
    EXPECT_FALSE(c.options.IsValid(1.0 / kRate, &error)) << c.error;
    EXPECT_THAT(error, HasSubstr(c.error));
  }
  std::string error;
  EXPECT_TRUE((FilterOptions{FilterType::kBandPass, {0.8, 30.0}, 4})
                  .IsValid(1.0 / kRate, &error));
}

TEST(ZeroPhaseFilterDeathTest, RefusesMissingSamples) {
  const ZeroPhaseFilter low = MakeFilter(FilterType::kLowPass, {10.0}, 4);
  Vector values = Vector::Zero(20);
  values[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_DEATH(low.Apply(&values), "fill the gaps");
}

}  // namespace
}  // namespace pinode
