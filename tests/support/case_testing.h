// Helpers for the tests of this layer: cases in their own folder.

#ifndef TESTS_SUPPORT_CASE_TESTING_H_
#define TESTS_SUPPORT_CASE_TESTING_H_

#include <cmath>
#include <string>
#include <utility>

#include "gtest/gtest.h"
#include "pinode/base/strings.h"
#include "pinode/case/sections/case_file.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {

// Returns `text` with the first `from` replaced. The test fails if there is
// none.
inline std::string Replaced(std::string text, const std::string& from,
                            const std::string& to) {
  const size_t at = text.find(from);
  if (at == std::string::npos) {
    ADD_FAILURE() << "'" << from << "' is not in the text";
    return text;
  }
  return text.replace(at, from.size(), to);
}

inline Case ReadOrFail(const std::string& path) {
  Case c;
  std::string error;
  EXPECT_TRUE(ReadCase(path, &c, &error)) << error;
  return c;
}

// Returns a case of two storeys with a ground motion, line by line. Tests count
// on its line numbers.
inline std::string SmallCase() {
  return R"(title = "Two storeys"
[units]
force = "kN"
length = "m"
[model]
dofs = ["u1", "u2"]
mass = {diagonal = [2.0, 1.0]}
stiffness = [[300.0, -100.0], [-100.0, 100.0]]
damping = {ratios = [0.02]}
[[group]]
name = "k1"
adds_to = "stiffness"
between = ["ground", "u1"]
scale = 200.0
lower = -0.9
[[record]]
name = "quake"
file = "quake.csv"
time = "t"
interpolation = "linear"
start = "rest"
  [[record.ground]]
  direction = "x"
  column = "ag"
  unit = "gal"
  [[record.channel]]
  column = "a1"
  quantity = "absolute_acceleration"
  dof = "u1"
  unit = "g"
  [[record.channel]]
  column = "d2"
  quantity = "displacement"
  dof = "u2"
  unit = "mm"
)";
}

// Returns its record: `samples` lines at 100 Hz of t, ag, a1, d2.
inline std::string SmallRecord(int samples = 200) {
  std::string text = "t,ag,a1,d2\n";
  for (int i = 0; i < samples; ++i) {
    const double t = 0.01 * i;
    text += FormatNumber(t, 6) + "," +
            FormatNumber(80.0 * std::sin(9.0 * t), 9) + "," +
            FormatNumber(0.1 * std::sin(9.0 * t - 0.3), 9) + "," +
            FormatNumber(4.0 * std::sin(8.0 * t) + 1.0, 9) + "\n";
  }
  return text;
}

// Small case with one more section before its record.
class SectionInSmallCase : public ::testing::Test {
 protected:
  explicit SectionInSmallCase(std::string section)
      : section_(std::move(section)) {}

  void SetUp() override { folder_.Write("quake.csv", SmallRecord()); }

  // Reads the case with `text` as the section.
  bool Read(const std::string& text, Case* c) {
    error_.clear();
    return ReadCase(
        folder_.Write("case.toml", Replaced(SmallCase(), "[[record]]\n",
                                            text + "[[record]]\n")),
        c, &error_);
  }
  // Returns why the section with `to` in place of `from` is refused.
  std::string Refusal(const std::string& from, const std::string& to) {
    Case c;
    EXPECT_FALSE(Read(Replaced(section_, from, to), &c)) << to;
    return error_;
  }

  TemporaryFolder folder_;
  std::string error_;

 private:
  std::string section_;
};

}  // namespace pinode

#endif  // TESTS_SUPPORT_CASE_TESTING_H_
