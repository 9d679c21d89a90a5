#include "pinode/case/sections/strain_channel.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <string>

#include "pinode/base/strings.h"
#include "pinode/dynamics/observation.h"
#include "tests/support/case_testing.h"

namespace pinode {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kLength = 0.6;       // m, of the cantilever
constexpr double kBending = 250.0;    // E I, N m^2
constexpr double kAxial = 4.0e6;      // E A, N
constexpr double kMassPerLength = 3;  // kg/m

std::string Rows(const Matrix& matrix) {
  std::string text = "[";
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    text += i == 0 ? "[" : ", [";
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
      text += (j == 0 ? "" : ", ") + FormatNumber(matrix(i, j), 17);
    }
    text += "]";
  }
  return text + "]";
}

// Three Euler-Bernoulli elements; nodes 1 to 3 with u (axial), v, r = dv/dx.
// Masses are lumped, with some inertia of rotation.
void Cantilever(Matrix* mass, Matrix* stiffness) {
  const double l = kLength / 3.0;
  Matrix bending(4, 4);
  bending << 12, 6 * l, -12, 6 * l, 6 * l, 4 * l * l, -6 * l, 2 * l * l, -12,
      -6 * l, 12, -6 * l, 6 * l, 2 * l * l, -6 * l, 4 * l * l;
  bending *= kBending / (l * l * l);
  *mass = Matrix::Zero(9, 9);
  *stiffness = Matrix::Zero(9, 9);
  for (int e = 0; e < 3; ++e) {
    // v, r of both ends; those of the clamp have no place.
    const int dofs[] = {3 * e - 2, 3 * e - 1, 3 * e + 1, 3 * e + 2};
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        if (dofs[i] < 0 || dofs[j] < 0) continue;
        (*stiffness)(dofs[i], dofs[j]) += bending(i, j);
      }
    }
    const double axial = kAxial / l;
    (*stiffness)(3 * e, 3 * e) += axial;
    if (e > 0) {
      (*stiffness)(3 * e - 3, 3 * e - 3) += axial;
      (*stiffness)(3 * e - 3, 3 * e) -= axial;
      (*stiffness)(3 * e, 3 * e - 3) -= axial;
    }
    (*mass)(3 * e, 3 * e) = (*mass)(3 * e + 1, 3 * e + 1) = kMassPerLength * l;
    (*mass)(3 * e + 2, 3 * e + 2) = kMassPerLength * l * l * l / 12.0;
  }
}

class StrainChannel : public ::testing::Test {
 protected:
  void SetUp() override {
    Cantilever(&mass_, &stiffness_);
    std::string csv = "t,F,e\n";
    for (int i = 0; i < 100; ++i) {
      csv += FormatNumber(0.001 * i, 6) + "," + FormatNumber(i % 7, 6) + "," +
             FormatNumber(i % 5, 6) + "\n";
    }
    folder_.Write("blow.csv", csv);
  }

  bool Read(const std::string& channel, Case* c) {
    error_.clear();
    return ReadCase(
        folder_.Write("case.toml",
                      "[model]\ndofs = [\"u1\", \"v1\", \"r1\", \"u2\", "
                      "\"v2\", \"r2\", \"u3\", \"v3\", \"r3\"]\nmass = " +
                          Rows(mass_) + "\nstiffness = " + Rows(stiffness_) +
                          "\ndamping = {ratios = [0.02]}\n"
                          "influence = {x = [0, 1, 0, 0, 1, 0, 0, 1, 0]}\n"
                          "[[group]]\nname = \"k\"\nadds_to = \"stiffness\"\n"
                          "between = [\"ground\", \"v1\"]\n"
                          "[[record]]\nname = \"r\"\nfile = \"blow.csv\"\n"
                          "time = \"t\"\nstart = \"rest\"\n"
                          "interpolation = \"linear\"\n[[record.force]]\n"
                          "dof = \"v3\"\ncolumn = \"F\"\nunit = \"N\"\n"
                          "[[record.channel]]\ncolumn = \"e\"\n"
                          "quantity = \"strain\"\n" +
                          channel),
        c, &error_);
  }
  std::string Refusal(const std::string& channel) {
    Case c;
    EXPECT_FALSE(Read(channel, &c)) << channel;
    return error_;
  }

  // Returns the value of the channel under a static force.
  double Shown(const std::string& channel, const Vector& force) {
    Case c;
    EXPECT_TRUE(Read(channel + "unit = \"1\"\n", &c)) << error_;
    if (!error_.empty()) return 0.0;
    const ObservationMap map(*c.problem.dynamics,
                             c.problem.records[0].Observations());
    Vector state = Vector::Zero(18);
    state.head(9) = stiffness_.ldlt().solve(force);
    const Vector rate = Vector::Zero(18);
    const double input = 0.0;
    double strain = 0.0;
    map.Observe(state.data(), rate.data(), &input, &strain);
    return strain;
  }

  TemporaryFolder folder_;
  Matrix mass_, stiffness_;
  std::string error_;
};

// Under a force P at the tip v'' = P (L - x) / (E I), of which a gauge shows
// the mean over its length, -y v''. Hermite's cubics are exact here.
TEST_F(StrainChannel, BendingOfACantilever) {
  const double p = 7.0;
  const double y = 0.004;
  const Vector force = p * Vector::Unit(9, 7);
  const double l = kLength / 3.0;
  // At the clamp, whose rotation is none of the DOFs.
  EXPECT_NEAR(
      Shown("dof = \"r1\"\ndistance = 0.004\ngauge_length = 0.2\n", force),
      -y * p * (kLength - 0.5 * l) / kBending, 1e-15);
  EXPECT_NEAR(Shown("combination = {r2 = 1, r1 = -1}\ndistance = 0.004\n"
                    "gauge_length = 0.2\n",
                    force),
              -y * p * (kLength - 1.5 * l) / kBending, 1e-15);
  // On the other side, over two elements.
  EXPECT_NEAR(Shown("combination = {r3 = 1, r1 = -1}\ndistance = -0.004\n"
                    "gauge_length = 0.4\n",
                    force),
              y * p * (kLength - 2.0 * l) / kBending, 1e-15);
}

TEST_F(StrainChannel, TensionOfACantilever) {
  const Vector force = 900.0 * Vector::Unit(9, 6);
  EXPECT_NEAR(
      Shown("combination = {u3 = 1, u2 = -1}\ngauge_length = 0.2\n", force),
      900.0 / kAxial, 1e-15);
}

TEST_F(StrainChannel, Units) {
  const std::string gauge =
      "combination = {r2 = 1, r1 = -1}\ndistance = 0.004\ngauge_length = 0.2\n";
  const std::pair<const char*, double> units[] = {{"1", 1.0},
                                                  {"um/m", 1e-6},
                                                  {"microstrain", 1e-6},
                                                  {"mm/m", 1e-3},
                                                  {"%", 1e-2}};
  for (const auto& [unit, factor] : units) {
    Case c;
    ASSERT_TRUE(Read(gauge + "unit = \"" + unit + "\"\n", &c)) << error_;
    const MeasuredChannel& channel = c.problem.records[0].channels[0];
    EXPECT_EQ(channel.observation.quantity, Quantity::kStrain);
    EXPECT_NEAR(channel.observation.weights[5], -0.02, 1e-17);
    EXPECT_NEAR(channel.observation.weights[2], 0.02, 1e-17);
    EXPECT_DOUBLE_EQ(channel.values[3], 3.0 * factor) << unit;
    EXPECT_EQ(c.problem.UnitOf(channel), unit);
  }
  Case volts;
  ASSERT_TRUE(Read(gauge + "unit = \"mV\"\ngain = {initial = 2000}\n", &volts))
      << error_;
  EXPECT_EQ(volts.problem.sensors.parameters[0].unit, "V");
}

TEST_F(StrainChannel, RefusesWhatIsWrong) {
  const std::string ends = "unit = \"1\"\ncombination = {r2 = 1, r1 = -1}\n";
  EXPECT_THAT(Refusal(ends + "distance = 0.1\n"),
              AllOf(HasSubstr("'gauge_length' is missing"),
                    HasSubstr("unit of length")));
  EXPECT_THAT(Refusal(ends + "gauge_length = 0\n"),
              HasSubstr("expected a positive number"));
  EXPECT_THAT(Refusal(ends + "gauge_length = -0.2\n"),
              HasSubstr("expected a positive number"));
  EXPECT_THAT(Refusal(ends + "gauge_length = 0.2\ndistance = 0\n"),
              HasSubstr("the neutral axis has no strain"));
  EXPECT_THAT(Refusal(ends + "gauge_length = 0.2\ndof = \"r1\"\n"),
              HasSubstr("expected one of dof"));
  EXPECT_THAT(Refusal("unit = \"mm\"\ndof = \"u1\"\ngauge_length = 0.2\n"),
              HasSubstr("'mm' is that of a length, expected that of a pure "
                        "number (1, microstrain, %)"));
  Case c;
  const std::string other =
      ends +
      "gauge_length = 0.2\n[[record.channel]]\nname = \"d\"\n"
      "column = \"e\"\nquantity = \"displacement\"\ndof = \"v1\"\n"
      "unit = \"mm\"\n";
  ASSERT_TRUE(Read(other, &c)) << error_;
  EXPECT_THAT(Refusal(other + "distance = 0.1\n"),
              HasSubstr("'distance' of a channel of displacement"));
}

}  // namespace
}  // namespace pinode
