// data/bridge_ambient: modes of a long-span girder from two set-ups, two pairs
// of them 1.2 % apart. Its groups are found in bridge_ambient_study_test.cc.

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "gtest/gtest.h"
#include "pinode/base/parallel_for.h"
#include "pinode/base/statistics.h"
#include "pinode/case/sections/modes_section.h"
#include "pinode/modal/merge_setups.h"
#include "pinode/modal/stabilisation.h"
#include "tests/cases/measure.h"
#include "tests/support/figure_testing.h"

namespace pinode {
namespace testing {
namespace {

constexpr char kBridgeCase[] = "data/bridge_ambient/bridge_ambient.toml";
// Below kBandHz; between there and 10 Hz there are fourteen more.
constexpr double kBandHz = 3.0;
constexpr size_t kModesInBand = 10;
constexpr size_t kModes = 24;

nlohmann::json ReadTruth() {
  std::ifstream file(FromRoot("data/bridge_ambient/truth.json"));
  return nlohmann::json::parse(file);
}

// "left6", the combination of DOFs by which it goes.
std::string PlaceOf(const std::string& channel) {
  const bool left = channel.rfind("left", 0) == 0;
  const std::string node = channel.substr(left ? 4 : 5);
  return "1 w" + node + " + " + (left ? "" : "-") + "11 t" + node;
}

// "... the mode at 7.8 Hz ...": 7.8; 0 where it speaks of no mode.
double ModeOfRemark(const std::string& remark) {
  constexpr char kMode[] = "the mode at ";
  const size_t at = remark.find(kMode);
  return at == std::string::npos
             ? 0.0
             : std::atof(remark.c_str() + at + sizeof(kMode) - 1);
}

// At `places`.
Vector TrueShape(const nlohmann::json& truth, int mode,
                 const std::vector<std::string>& places) {
  const nlohmann::json& all = truth["shapes"][std::to_string(mode + 1)];
  Vector shape = Vector::Zero(static_cast<Eigen::Index>(places.size()));
  for (size_t i = 0; i < all.size(); ++i) {
    const std::string channel = truth["places"][i];
    const auto at = std::find(places.begin(), places.end(), PlaceOf(channel));
    if (at != places.end()) shape[at - places.begin()] = all[i].get<double>();
  }
  return shape;
}

// The identified mode that is nearest in frequency among those of such a shape.
int Nearest(const MergedModes& found, double frequency, const Vector& shape) {
  int best = -1;
  for (size_t i = 0; i < found.modes.size(); ++i) {
    const IdentifiedMode& mode = found.modes[i].mode;
    const auto apart = [&](const IdentifiedMode& m) {
      return std::abs(m.frequency_hz - frequency);
    };
    if (ComplexMac(mode.shape, shape.cast<std::complex<double>>()) > 0.9 &&
        (best < 0 ||
         apart(mode) < apart(found.modes[static_cast<size_t>(best)].mode))) {
      best = static_cast<int>(i);
    }
  }
  return best;
}

TEST(BridgeAmbient, ModesOfTwoSetupsWithinTheirIntervals) {
  ModesCase c;
  std::string error;
  ASSERT_TRUE(ReadModesCase(FromRoot(kBridgeCase), &c, &error)) << error;
  std::vector<SetupModes> setups;
  for (const ResponseRecord& record : c.records) {
    ModesOfRecord modes;
    ASSERT_TRUE(IdentifyModes(record, c.options, &modes, &error)) << error;
    // Nothing to say of the channels, nor of the modes that are known.
    for (const std::string& remark : modes.remarks) {
      EXPECT_GT(ModeOfRemark(remark), kBandHz) << remark;
    }
    SetupModes setup;
    setup.name = record.name;
    for (const ResponseChannel& channel : record.channels) {
      setup.places.push_back(channel.name);
    }
    setup.modes = modes.modes;
    setups.push_back(std::move(setup));
  }
  MergedModes merged;
  ASSERT_TRUE(MergeSetups(setups, c.merge, &merged, &error)) << error;
  ASSERT_EQ(merged.places.size(), 16u);
  const nlohmann::json truth = ReadTruth();
  const std::vector<double> hertz = truth["hertz"];
  const std::vector<double> ratios = truth["damping_ratio"];
  ASSERT_EQ(hertz.size(), kModes);

  int inside = 0;
  int entries = 0;
  for (size_t m = 0; m < kModesInBand; ++m) {
    const Vector shape = TrueShape(truth, static_cast<int>(m), merged.places);
    const int i = Nearest(merged, hertz[m], shape);
    ASSERT_GE(i, 0) << hertz[m] << " Hz is missing";
    const MergedMode& found = merged.modes[static_cast<size_t>(i)];
    const IdentifiedMode& mode = found.mode;
    EXPECT_GE(std::min(found.in_setups[0], found.in_setups[1]), 0) << hertz[m];
    EXPECT_NEAR(mode.frequency_hz, hertz[m], 3.5 * mode.frequency_sigma);
    EXPECT_LT(mode.frequency_sigma, 0.002 * hertz[m]);
    EXPECT_NEAR(mode.damping_ratio, ratios[m], 3.5 * mode.damping_sigma);
    EXPECT_GT(ComplexMac(mode.shape, shape.cast<std::complex<double>>()), 0.99)
        << hertz[m];
    Eigen::Index largest = 0;
    mode.shape.cwiseAbs().maxCoeff(&largest);
    const double t = StudentQuantile(mode.degrees_of_freedom);
    for (Eigen::Index p = 0; p < shape.size(); ++p) {
      if (p == largest) continue;
      ++entries;
      inside += std::abs(mode.shape[p].real() - shape[p] / shape[largest]) <=
                t * mode.shape_sigma_real[p];
    }
  }
  ReportFigure("bridge_ambient: shape entries inside their intervals, %",
               AtLeast(89.0), 100.0 * inside / entries);
  EXPECT_GE(inside, 0.89 * entries);

  // And no others, there or above.
  for (const MergedMode& found : merged.modes) {
    const IdentifiedMode& mode = found.mode;
    double apart = mode.frequency_hz;
    for (const double f : hertz) {
      apart = std::min(apart, std::abs(f - mode.frequency_hz));
    }
    EXPECT_LT(apart, 4.0 * mode.frequency_sigma + 1e-3 * mode.frequency_hz)
        << "no mode is at " << mode.frequency_hz << " Hz";
  }
}

}  // namespace
}  // namespace testing
}  // namespace pinode
