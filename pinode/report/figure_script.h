// Common parts of a report's figures: a gnuplot script under construction, the
// styles of its lines, and the ranges of its axes.

#ifndef PINODE_REPORT_FIGURE_SCRIPT_H_
#define PINODE_REPORT_FIGURE_SCRIPT_H_

#include <limits>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/report/decimate.h"
#include "pinode/report/report.h"

namespace pinode {

inline constexpr char kMeasuredLine[] = "lc rgb '#aaaaaa' lw 3.6 dt 1";
inline constexpr char kUpdatedLine[] = "lc rgb '#0072B2' lw 1.3 dt 1";
inline constexpr char kBandFill[] = "fc rgb '#A6CEE3' fs solid 1.0 noborder";
inline constexpr char kPriorLine[] = "lc rgb '#E69F00' lw 1.2 dt (6,3)";
inline constexpr char kTrueLine[] = "lc rgb '#333333' lw 2.6 dt (2,2)";
inline constexpr char kFaintLine[] = "lc rgb '#999999' lw 0.8 dt 1";
inline constexpr char kMark[] = "lc rgb '#D55E00'";

// Points per curve of a whole record, chosen so that no figure exceeds 150 KiB:
// an SVG takes 15 bytes a point, and no screen shows more.
inline constexpr int kHistoryBuckets = 450;

// Returns a number as text for a script.
std::string ScriptNumber(double value);

// Returns "time, s", "a1, m/s²".
std::string AxisLabel(const std::string& quantity, const std::string& unit);

// A gnuplot script under construction.
class FigureScript {
 public:
  FigureScript(const std::string& id, int width, int height);

  void Line(const std::string& line) { text_ += line + "\n"; }

  // Adds one data block per line drawn; returns its name.
  std::string Data(const std::vector<std::vector<double>>& columns);

  const std::string& text() const { return text_; }

 private:
  std::string text_;
  int num_data_ = 0;
};

// Returns `data` as a line, for a plot command; without a title it is not in
// the legend.
std::string Lines(const std::string& data, const std::string& style,
                  const std::string& title);

// Returns the filled area between two histories, for a plot command.
// Neighbouring samples are drawn as the widest of them. There is no area where
// either history is not finite.
std::string Band(const Vector& times, const Vector& lower, const Vector& upper,
                 const std::string& title, FigureScript* script);

// Returns the command that sets an axis, "x" or "y". An axis without width is
// made a little wider.
std::string Range(const std::string& axis, double low, double high);

// Smallest interval that holds the finite values, empty at first.
struct Interval {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  bool empty() const { return !(low <= high); }
  double width() const { return high - low; }
  void Add(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  void Add(const HistoryRef& values) {
    for (const double value : values) Add(value);
  }
};

// Returns a range for the measured values and, unless it would dwarf these, for
// the predicted ones: an initial model may diverge.
Interval VerticalRange(const Vector& measured,
                       const std::vector<HistoryRef>& predicted);

// Returns "record 'quake' (hold-out)".
std::string RecordWithRole(const ReportInput& input, int record);

std::vector<double> Column(const Vector& values);

}  // namespace pinode

#endif  // PINODE_REPORT_FIGURE_SCRIPT_H_
