#include "pinode/report/figure_script.h"

#include <algorithm>
#include <cmath>

#include "pinode/base/strings.h"
#include "pinode/report/gnuplot.h"
#include "pinode/report/number_text.h"

namespace pinode {

std::string ScriptNumber(double value) { return FormatNumber(value, 7); }

std::string AxisLabel(const std::string& quantity, const std::string& unit) {
  const std::string text = UnitText(unit);
  return text.empty() ? quantity : quantity + ", " + text;
}

FigureScript::FigureScript(const std::string& id, int width, int height) {
  Line("set encoding utf8");
  // `noenhanced`: names with underscores and carets stay as they are.
  Line("set terminal svg noenhanced size " + std::to_string(width) + "," +
       std::to_string(height) +
       " font 'Helvetica,12' background '#ffffff' name '" + id + "'");
  Line("set tics out nomirror scale 0.6");
  Line("set border 3 lc rgb '#555555' lw 0.8");
  Line("set grid lc rgb '#dddddd' lw 0.5 dt 1");
  Line("set key top right horizontal samplen 2 height 0.3");
  Line("set format '%.6g'");
  Line("set xlabel offset 0,0.5");
}

std::string FigureScript::Data(
    const std::vector<std::vector<double>>& columns) {
  std::string name = "$d" + std::to_string(num_data_++);
  text_ += name + " << EOD\n";
  for (size_t i = 0; i < columns[0].size(); ++i) {
    bool finite = true;
    for (const auto& column : columns) {
      finite = finite && std::isfinite(column[i]);
    }
    // An empty line interrupts the curve.
    for (size_t c = 0; finite && c < columns.size(); ++c) {
      text_ += (c > 0 ? " " : "") + ScriptNumber(columns[c][i]);
    }
    text_ += "\n";
  }
  text_ += "EOD\n";
  return name;
}

std::string Lines(const std::string& data, const std::string& style,
                  const std::string& title) {
  return data + " using 1:2 with lines " + style +
         (title.empty() ? " notitle" : " title " + GnuplotString(title));
}

std::string Range(const std::string& axis, double low, double high) {
  if (!(high > low)) {
    const double margin = std::max(std::abs(low), 1e-12);
    low -= margin;
    high += margin;
  }
  return "set " + axis + "range [" + ScriptNumber(low) + ":" +
         ScriptNumber(high) + "]";
}

Interval VerticalRange(const Vector& measured,
                       const std::vector<HistoryRef>& predicted) {
  Interval range;
  range.Add(measured);
  if (range.empty()) range.Add(0.0);
  const double room = std::max(range.width(), 1e-300);
  const double low = range.low - 0.5 * room, high = range.high + 0.5 * room;
  for (const HistoryRef& values : predicted) {
    Interval other;
    other.Add(values);
    if (other.empty()) continue;
    range.Add(std::max(other.low, low));
    range.Add(std::min(other.high, high));
  }
  const double margin = 0.06 * range.width();
  range.Add(range.low - margin);
  range.Add(range.high + margin);
  return range;
}

std::string RecordWithRole(const ReportInput& input, int record) {
  const IdentificationRecord& data =
      input.problem->records[static_cast<size_t>(record)];
  return "record '" + data.name + "' (" +
         (data.role == IdentificationRecord::Role::kTrain ? "training"
                                                          : "hold-out") +
         ")";
}

std::string Band(const Vector& times, const Vector& lower, const Vector& upper,
                 const std::string& title, FigureScript* script) {
  const Eigen::Index size = times.size();
  const Eigen::Index stride = (size + kHistoryBuckets - 1) / kHistoryBuckets;
  std::vector<std::vector<double>> band(3);
  for (Eigen::Index i = 0; i < size; i += stride) {
    const Eigen::Index width = std::min(stride, size - i);
    band[0].push_back(times.segment(i, width).mean());
    band[1].push_back(lower.segment(i, width).minCoeff());
    band[2].push_back(upper.segment(i, width).maxCoeff());
  }
  return script->Data(band) + " using 1:2:3 with filledcurves " + kBandFill +
         (title.empty() ? " notitle" : " title " + GnuplotString(title));
}

std::vector<double> Column(const Vector& values) {
  return std::vector<double>(values.data(), values.data() + values.size());
}

}  // namespace pinode
