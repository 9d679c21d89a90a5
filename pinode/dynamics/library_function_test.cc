#include "pinode/dynamics/library_function.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <muParser.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <thread>

#include "pinode/base/constants.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::vector<std::string>& Features() {
  static const auto& names = *new std::vector<std::string>{
      "x[u1]", "v[u1]", "d[u1,u2]", "t", "input[ground x]"};
  return names;
}

LibraryFunction Parsed(const std::string& text) {
  LibraryFunction function;
  std::string error;
  EXPECT_TRUE(LibraryFunction::Parse(text, Features(), &function, &error))
      << error;
  return function;
}

struct Example {
  std::string text;
  // The same by hand; q as Features().
  double (*value)(const double* q);
};

double Sign(double x) { return x > 0.0 ? 1.0 : (x < 0.0 ? -1.0 : 0.0); }

std::vector<Example> Examples() {
  return {
      {"1", [](const double*) { return 1.0; }},
      {"x[u1]", [](const double* q) { return q[0]; }},
      {"x[u1]^3", [](const double* q) { return q[0] * q[0] * q[0]; }},
      {"x[u1]^-2", [](const double* q) { return 1.0 / (q[0] * q[0]); }},
      {"x[u1]^0", [](const double*) { return 1.0; }},
      {"abs(x[u1])^1.7",
       [](const double* q) { return std::pow(std::abs(q[0]), 1.7); }},
      {"d[u1,u2]*v[u1]", [](const double* q) { return q[2] * q[1]; }},
      {"d[ u1, u2 ] * v[u1]", [](const double* q) { return q[2] * q[1]; }},
      {"x[u1]^2*v[u1]^3*d[u1,u2]",
       [](const double* q) { return q[0] * q[0] * q[1] * q[1] * q[1] * q[2]; }},
      {"abs(v[u1])", [](const double* q) { return std::abs(q[1]); }},
      {"sign(v[u1])", [](const double* q) { return Sign(q[1]); }},
      {"abs(x[u1])*x[u1]",
       [](const double* q) { return std::abs(q[0]) * q[0]; }},
      {"sin(x[u1])", [](const double* q) { return std::sin(q[0]); }},
      {"cos(2*pi*3*t)",
       [](const double* q) { return std::cos(6.0 * kPi * q[3]); }},
      {"tan(x[u1]) - atan(v[u1])",
       [](const double* q) { return std::tan(q[0]) - std::atan(q[1]); }},
      {"asin(x[u1]/10) + acos(v[u1]/10)",
       [](const double* q) {
         return std::asin(q[0] / 10.0) + std::acos(q[1] / 10.0);
       }},
      {"sinh(x[u1])*cosh(v[u1])/2",
       [](const double* q) { return std::sinh(q[0]) * std::cosh(q[1]) / 2; }},
      {"tanh(v[u1]/0.1)",
       [](const double* q) { return std::tanh(q[1] / 0.1); }},
      {"exp(-x[u1]^2)", [](const double* q) { return std::exp(-q[0] * q[0]); }},
      {"ln(1+t) + log10(3+t) + sqrt(2+t)",
       [](const double* q) {
         return std::log(1 + q[3]) + std::log10(3 + q[3]) + std::sqrt(2 + q[3]);
       }},
      {"abs(x[u1])^abs(v[u1])",
       [](const double* q) {
         return std::pow(std::abs(q[0]), std::abs(q[1]));
       }},
      {"min(x[u1],v[u1])*max(x[u1], 0.1)",
       [](const double* q) {
         return std::min(q[0], q[1]) * std::max(q[0], 0.1);
       }},
      {"x[u1] > 0.2 ? x[u1] - 0.2 : (x[u1] < -0.2 ? x[u1] + 0.2 : 0)",
       [](const double* q) {
         if (q[0] > 0.2) return q[0] - 0.2;
         return q[0] < -0.2 ? q[0] + 0.2 : 0.0;
       }},
      {"(x[u1]>=0 && v[u1]<=0 || t==1 || t!=t)*v[u1]",
       [](const double* q) {
         return (q[0] >= 0 && q[1] <= 0) || q[3] == 1.0 ? q[1] : 0.0;
       }},
      // The sign binds less than the power; powers group from the right.
      {"-x[u1]^2", [](const double* q) { return -q[0] * q[0]; }},
      {"2^3^2 - 500 + x[u1]", [](const double* q) { return 12.0 + q[0]; }},
      {"x[u1] - v[u1] - t", [](const double* q) { return q[0] - q[1] - q[3]; }},
      {"x[u1]/v[u1]/2", [](const double* q) { return q[0] / q[1] / 2.0; }},
      {"1e-3*input[ground x]", [](const double* q) { return 1e-3 * q[4]; }},
  };
}

std::vector<std::vector<double>> Points() {
  return {{0.7, -1.3, 0.4, 0.35, 9.0},
          {-0.9, 0.6, -2.2, 1.5, -4.0},
          {0.11, 0.23, 1.7, 0.2, 0.5},
          {-1.4, -0.8, 0.3, 2.5, 1.0}};
}

TEST(LibraryFunction, HasTheValuesWorkedOutByHand) {
  for (const Example& example : Examples()) {
    const LibraryFunction function = Parsed(example.text);
    for (const auto& q : Points()) {
      const double expected = example.value(q.data());
      EXPECT_NEAR(function.Evaluate(q.data()), expected,
                  4e-16 * (1.0 + std::abs(expected)))
          << example.text;
    }
  }
}

// muParser itself evaluates the same texts, with plain names and with its
// missing functions written out.
TEST(LibraryFunction, AgreesWithMuParser) {
  const std::vector<std::pair<std::string, std::string>> texts = {
      {"x[u1]^3 - 2*v[u1]^2*x[u1]", "x^3 - 2*v^2*x"},
      {"x[u1]>v[u1]?sin(x[u1]):-cos(v[u1])^2", "x>v?sin(x):-cos(v)^2"},
      {"2^x[u1]^2/3*4-5-6", "2^x^2/3*4-5-6"},
      {"min(x[u1],v[u1])-max(1,v[u1])*sign(x[u1])",
       "min(x,v)-max(1,v)*sign(x)"},
      {"x[u1]<1&&v[u1]<1||x[u1]==v[u1]", "x<1&&v<1||x==v"},
      {"-x[u1]*-v[u1]^-2", "-x*-v^-2"},
  };
  for (const auto& [ours, theirs] : texts) {
    const LibraryFunction function = Parsed(ours);
    for (const auto& q : Points()) {
      double x = q[0];
      double v = q[1];
      mu::Parser parser;
      parser.DefineVar("x", &x);
      parser.DefineVar("v", &v);
      parser.SetExpr(theirs);
      const double expected = parser.Eval();
      EXPECT_NEAR(function.Evaluate(q.data()), expected,
                  1e-15 * (1.0 + std::abs(expected)))
          << ours;
    }
  }
}

// Ridders' method: central differences extrapolated to step zero.
double Ridders(const LibraryFunction& function, std::vector<double> q,
               size_t feature) {
  constexpr int kSize = 8;
  double table[kSize][kSize];
  const double x = q[feature];
  double step = 1e-2;
  double best = 0.0;
  double smallest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kSize; ++i, step /= 1.6) {
    q[feature] = x + step;
    const double above = function.Evaluate(q.data());
    q[feature] = x - step;
    const double below = function.Evaluate(q.data());
    table[i][0] = (above - below) / (2.0 * step);
    double factor = 1.0;
    for (int j = 1; j <= i; ++j) {
      factor *= 1.6 * 1.6;
      table[i][j] =
          (table[i][j - 1] * factor - table[i - 1][j - 1]) / (factor - 1.0);
      const double error =
          std::max(std::abs(table[i][j] - table[i][j - 1]),
                   std::abs(table[i][j] - table[i - 1][j - 1]));
      if (error < smallest) {
        smallest = error;
        best = table[i][j];
      }
    }
  }
  return best;
}

TEST(LibraryFunction, GradientIsTheDerivative) {
  for (const Example& example : Examples()) {
    const LibraryFunction function = Parsed(example.text);
    ASSERT_EQ(function.num_features(), 5);
    for (const auto& q : Points()) {
      std::vector<double> gradient(5, 1e9);
      const double value = function.Linearize(q.data(), gradient.data());
      EXPECT_EQ(value, function.Evaluate(q.data())) << example.text;
      for (size_t i = 0; i < 5; ++i) {
        const double expected = Ridders(function, q, i);
        EXPECT_NEAR(gradient[i], expected, 1e-8 * (1.0 + std::abs(expected)))
            << example.text << ", feature " << i;
        if (!function.DependsOn(static_cast<int>(i))) {
          EXPECT_EQ(gradient[i], 0.0);
        }
      }
    }
  }
}

TEST(LibraryFunction, DerivativesAtCorners) {
  const std::vector<double> rest(5, 0.0);
  const auto slope = [&](const std::string& text) {
    std::vector<double> gradient(5);
    Parsed(text).Linearize(rest.data(), gradient.data());
    return gradient[0];
  };
  EXPECT_EQ(slope("abs(x[u1])"), 0.0);
  EXPECT_EQ(slope("sign(x[u1])"), 0.0);
  EXPECT_EQ(slope("abs(x[u1])*x[u1]"), 0.0);
  EXPECT_EQ(slope("max(x[u1], v[u1])"), 1.0);
  EXPECT_EQ(slope("min(x[u1], v[u1])"), 1.0);
  EXPECT_EQ(slope("x[u1]^3"), 0.0);
  EXPECT_EQ(slope("x[u1]^1"), 1.0);
  EXPECT_EQ(slope("x[u1]^1.5"), 0.0);
  EXPECT_EQ(slope("sqrt(x[u1])"), std::numeric_limits<double>::infinity());
  // 0^t is 0 for every t > 0.
  const std::vector<double> later = {0.0, 0.0, 0.0, 2.0, 0.0};
  std::vector<double> gradient(5);
  EXPECT_EQ(Parsed("x[u1]^t").Linearize(later.data(), gradient.data()), 0.0);
  EXPECT_EQ(gradient, std::vector<double>(5, 0.0));
  // The branch that was not taken has an infinite derivative here.
  EXPECT_EQ(slope("x[u1] > 0 ? sqrt(x[u1]) : 3*x[u1]"), 3.0);
}

TEST(LibraryFunction, OutsideItsDomainItIsNotFinite) {
  const std::vector<double> q = {-1.0, 0.0, 0.0, 0.0, 0.0};
  EXPECT_TRUE(std::isnan(Parsed("ln(x[u1])").Evaluate(q.data())));
  EXPECT_TRUE(std::isnan(Parsed("x[u1]^0.5").Evaluate(q.data())));
  EXPECT_TRUE(std::isinf(Parsed("1/v[u1]").Evaluate(q.data())));
}

TEST(LibraryFunction, KnowsItsFeatures) {
  const LibraryFunction function = Parsed(" d[ u1 ,u2 ] * v[u1] ");
  EXPECT_EQ(function.text(), "d[u1,u2]*v[u1]");
  EXPECT_FALSE(function.DependsOn(0));
  EXPECT_TRUE(function.DependsOn(1));
  EXPECT_TRUE(function.DependsOn(2));
  EXPECT_EQ(Parsed("input[ground x] * t").text(), "input[ground x]*t");
  // Its own text is read back as the same function.
  const std::vector<double> q = Points()[0];
  for (const Example& example : Examples()) {
    const LibraryFunction once = Parsed(example.text);
    EXPECT_EQ(Parsed(once.text()).text(), once.text());
    EXPECT_EQ(Parsed(once.text()).Evaluate(q.data()), once.Evaluate(q.data()));
  }
  const double nothing = 0.0;
  EXPECT_EQ(LibraryFunction().Evaluate(&nothing), 0.0);
}

TEST(LibraryFunction, SaysWhereATextIsWrong) {
  const std::vector<std::pair<std::string, std::string>> examples = {
      {"", "'', column 1: empty"},
      {"  ", "'  ', column 1: empty"},
      {"x[u3]^2", "'x[u3]^2', column 1: unknown feature 'x[u3]'; did you mean"},
      {"2*x[u1", "'2*x[u1', column 4: no ']'"},
      {"x[u1]^^2", "'x[u1]^^2', column 7: at '^' "},
      {"x[u1]*", "'x[u1]*', column 7: ends too early"},
      {"(x[u1]", "'(x[u1]', column 7: ends too early, expected ')'"},
      {"x[u1])", "'x[u1])', column 6: at ')' "},
      {"2*sinn(t)", "'2*sinn(t)', column 3: unknown name 'sinn'; did you"},
      {"pow(t,2)", "'pow(t,2)', column 1: unknown name 'pow'"},
      {"x[u1]v[u1]", "'x[u1]v[u1]', column 6: expected an operator"},
      {"x[u1]2", "'x[u1]2', column 6: expected an operator"},
      {"2 t", "'2 t', column 3: at 't' an operator was expected"},
      {"x[u1] = 2", "'x[u1] = 2', column 7: an assignment"},
      {"t, t", "'t, t', column 2: expected one expression"},
      {"sin()", "'sin()', column 5: too few arguments of sin"},
      {"max(t)", "'max(t)', column 6: too few arguments of max"},
      {"sin(t,t)", "'sin(t,t)', column 8: too many arguments of sin"},
      {"t > 0 ? 1", "'t > 0 ? 1', column 10: ends too early, '?'"},
      {"t : 1", "'t : 1', column "},
      {"t*\"a\"", "'t*\"a\"', column 3: unexpected character"},
      {"t*\u00e9", "'t*\u00e9', column 3: unexpected character '\u00e9',"},
      {"x[u1]*[0]", "'x[u1]*[0]', column 7: unexpected character '['"},
      {"sin t", "'sin t', column 1: at 's' an operator was expected, or '('"},
  };
  for (const auto& [text, message] : examples) {
    LibraryFunction function = Parsed("3*t");
    std::string error;
    EXPECT_FALSE(LibraryFunction::Parse(text, Features(), &function, &error))
        << text;
    EXPECT_THAT(error, StartsWith(message));
    EXPECT_EQ(function.text(), "3*t") << "touched by " << text;
  }
}

TEST(LibraryFunction, RefusesWhatIsTooLong) {
  std::string text = "t";
  for (int i = 1; i < LibraryFunction::kMaxOperations; ++i) text += "+t";
  LibraryFunction function;
  std::string error;
  EXPECT_FALSE(LibraryFunction::Parse(text, Features(), &function, &error));
  EXPECT_THAT(error, HasSubstr("more than 256 operations"));
  EXPECT_FALSE(LibraryFunction::Parse(std::string(20000, '('), Features(),
                                      &function, &error));
  EXPECT_THAT(error, HasSubstr("longer than"));
}

TEST(LibraryFunction, SwitchesHaveValuesGradientsAndBranches) {
  const LibraryFunction function =
      Parsed("(x[u1]^2 < 3*v[u1] ? x[u1] : 2*v[u1]) + 5*sign(v[u1])");
  ASSERT_EQ(function.num_switches(), 2);
  EXPECT_EQ(Parsed("x[u1]^3").num_switches(), 0);
  const double q[] = {0.5, 1.5, 0.0, 0.0, 0.0};
  double values[2];
  function.Switches(q, values);
  EXPECT_DOUBLE_EQ(values[0], 4.5 - 0.25);
  EXPECT_DOUBLE_EQ(values[1], 1.5);
  double gradient[5];
  function.SwitchGradient(0, q, gradient);
  EXPECT_DOUBLE_EQ(gradient[0], -1.0);  // -2 x
  EXPECT_DOUBLE_EQ(gradient[1], 3.0);
  EXPECT_EQ(gradient[2], 0.0);

  // The branches at q, and the opposite ones.
  const char here[] = {1, 1};
  const char there[] = {0, 0};
  EXPECT_DOUBLE_EQ(function.Evaluate(q), 0.5 + 5.0);
  EXPECT_DOUBLE_EQ(function.Evaluate(q, here), 0.5 + 5.0);
  EXPECT_DOUBLE_EQ(function.Evaluate(q, there), 3.0 - 5.0);
  EXPECT_DOUBLE_EQ(function.Linearize(q, gradient, there), 3.0 - 5.0);
  EXPECT_EQ(gradient[0], 0.0);
  EXPECT_DOUBLE_EQ(gradient[1], 2.0);
}

// A motion that begins at a switch begins on the branch below it.
TEST(LibraryFunction, EqualOperandsAreOnTheBranchBelow) {
  for (const char* comparison : {"<", "<=", ">", ">="}) {
    const LibraryFunction function =
        Parsed(std::string("x[u1] ") + comparison + " 0 ? 3 : 7");
    const double q[] = {0.0, 1.0, 0.0, 0.0, 0.0};
    double value = 1.0;
    function.Switches(q, &value);
    EXPECT_EQ(value, 0.0);
    const char below[] = {0};
    EXPECT_EQ(function.Evaluate(q, below), function.Evaluate(q)) << comparison;
  }
}

TEST(LibraryFunction, IsSafeToShareBetweenThreads) {
  const LibraryFunction function = Parsed("sin(x[u1])*x[u1]^3 + exp(v[u1])");
  std::atomic<int> wrong{0};
  const auto work = [&](double sign) {
    for (int i = 0; i < 20000; ++i) {
      const double x = sign * 1e-4 * i;
      const double q[] = {x, -x, 0.0, 0.0, 0.0};
      const double expected = std::sin(x) * x * x * x + std::exp(-x);
      if (std::abs(function.Evaluate(q) - expected) > 1e-13) ++wrong;
    }
  };
  std::thread other(work, -1.0);
  work(1.0);
  other.join();
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace pinode
