// For tests and benchmarks only, hence not installed: records the measured
// values of the project's stated figures.
//
// If the environment variable PINODE_FIGURES names a file, each figure adds a
// line to it, `verdict <tab> what <tab> asked <tab> measured`. tests/figures.sh
// makes one table of them all.

#ifndef TESTS_SUPPORT_FIGURE_TESTING_H_
#define TESTS_SUPPORT_FIGURE_TESTING_H_

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>

namespace pinode {
namespace testing {

// Required interval of a figure, including its ends. Unbounded on both sides if
// there is no requirement.
struct Asked {
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
};

inline Asked AtMost(double most) {
  Asked asked;
  asked.most = most;
  return asked;
}

inline Asked AtLeast(double least) {
  Asked asked;
  asked.least = least;
  return asked;
}

inline Asked Between(double least, double most) { return {least, most}; }

inline Asked Nothing() { return {}; }

// Returns the larger value. Returns NaN if either is NaN, so that no comparison
// hides it.
inline double Worse(double a, double b) {
  return std::isnan(a) || a > b ? a : b;
}

inline std::string FigureText(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.4g", value);
  return text;
}

inline std::string AskedText(const Asked& asked) {
  const bool below = asked.most < std::numeric_limits<double>::infinity();
  const bool above = asked.least > -std::numeric_limits<double>::infinity();
  if (below && above) {
    return FigureText(asked.least) + " to " + FigureText(asked.most);
  }
  if (below) return "<= " + FigureText(asked.most);
  if (above) return ">= " + FigureText(asked.least);
  return "-";
}

inline void AppendFigureLine(const std::string& verdict,
                             const std::string& what, const std::string& asked,
                             const std::string& measured) {
  const char* path = std::getenv("PINODE_FIGURES");
  if (path == nullptr) return;
  std::FILE* file = std::fopen(path, "a");
  if (file == nullptr) {
    std::fprintf(stderr, "PINODE_FIGURES: cannot write to %s\n", path);
    std::abort();
  }
  std::fprintf(file, "%s\t%s\t%s\t%s\n", verdict.c_str(), what.c_str(),
               asked.c_str(), measured.c_str());
  std::fclose(file);
}

// Adds the figure to the file. A figure that is NaN misses its requirement.
inline void AppendFigure(const std::string& what, const Asked& asked,
                         double measured) {
  const std::string text = AskedText(asked);
  const bool met = asked.least <= measured && measured <= asked.most;
  AppendFigureLine(text == "-" ? "-" : (met ? "pass" : "miss"), what, text,
                   FigureText(measured));
}

// Does the same, and writes a line to standard output. The test itself checks
// its expectations.
inline void ReportFigure(const std::string& what, const Asked& asked,
                         double measured) {
  std::printf("%s: %s (asked: %s)\n", what.c_str(),
              FigureText(measured).c_str(), AskedText(asked).c_str());
  AppendFigure(what, asked, measured);
}

// Reports that `what` cannot be measured here.
inline void ReportSkipped(const std::string& what) {
  AppendFigureLine("skipped", what, "-", "-");
}

}  // namespace testing
}  // namespace pinode

#endif  // TESTS_SUPPORT_FIGURE_TESTING_H_
