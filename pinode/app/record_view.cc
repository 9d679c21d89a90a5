#include "pinode/app/record_view.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/strings.h"
#include "pinode/modal/response_record.h"
#include "pinode/modal/spectra.h"
#include "pinode/report/decimate.h"

namespace pinode {
namespace {

using Json = nlohmann::ordered_json;

// Digits of numbers in pictures: a pixel is a thousandth of one.
constexpr int kViewDigits = 5;

Json RoundedOrNull(double value) {
  double rounded = value;
  if (std::isfinite(value)) {
    (void)ParseDouble(FormatNumber(value, kViewDigits), &rounded);
  }
  return NumberOrNull(rounded);
}

Json LineJson(const Polyline& line) {
  Json x = Json::array();
  Json y = Json::array();
  for (const double value : line.x) x.push_back(RoundedOrNull(value));
  for (const double value : line.y) y.push_back(RoundedOrNull(value));
  return {{"x", std::move(x)}, {"y", std::move(y)}};
}

// Returns the quantity of a unit, such as "acceleration"; empty: none.
std::string QuantityOf(const LogColumn& column) {
  Dimension dimension;
  if (!column.FindUnitDimension(&dimension)) return "";
  // "an acceleration"
  const std::string name = DimensionName(dimension);
  return name.substr(name.rfind(' ') + 1);
}

Json ColumnFacts(const LogColumn& column) {
  double lowest = kInfinity;
  double highest = -kInfinity;
  double sum = 0.0;
  Eigen::Index present = 0;
  for (const double value : column.samples) {
    if (!std::isfinite(value)) continue;
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
    sum += value;
    ++present;
  }
  const double mean = present > 0 ? sum / static_cast<double>(present) : 0.0;
  double squares = 0.0;
  for (const double value : column.samples) {
    if (std::isfinite(value)) squares += (value - mean) * (value - mean);
  }
  const double rms = present > 0
                         ? std::sqrt(squares / static_cast<double>(present))
                         : std::nan("");
  return {{"name", column.name},
          {"unit", column.unit},
          {"quantity", QuantityOf(column)},
          {"min", NumberOrNull(lowest)},
          {"max", NumberOrNull(highest)},
          {"rms", NumberOrNull(rms)},
          {"missing", column.samples.size() - present}};
}

// Returns the amplitude spectrum; no points for a column that does not move.
Polyline SpectrumLine(const LogFile& log, const LogColumn& column, int width) {
  ResponseRecord record;
  record.name = log.path;
  record.sampling_step = log.step;
  record.channels.push_back({column.name, 2});
  record.samples = column.samples.transpose();
  std::string unused;
  if (!record.IsValid(&unused)) return {};
  const Spectra spectra = EstimateSpectra(record, 0, 0);
  const Vector amplitude = spectra.densities.row(0).cwiseSqrt();
  return DecimateHistory(spectra.frequency_hz, amplitude, width);
}

}  // namespace

Json NumberOrNull(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json LogOverview(const LogFile& log) {
  Json columns = Json::array();
  for (const LogColumn& column : log.columns) {
    columns.push_back(ColumnFacts(column));
  }
  std::string time = log.time_column;
  if (time.empty() && log.sampling_rate_hz > 0.0) time = "sampling rate";
  return {{"samples", log.num_samples()},
          {"step", NumberOrNull(log.step)},
          {"rate_hz", NumberOrNull(1.0 / log.step)},
          {"seconds", NumberOrNull(log.duration())},
          {"time", time},
          {"reading", log.reading},
          {"columns", std::move(columns)}};
}

Json ColumnView(const LogFile& log, const LogColumn& column, int width) {
  width = std::clamp(width, 1, kWidestView);
  return {{"column", column.name},
          {"unit", column.unit},
          {"samples", column.samples.size()},
          {"history",
           LineJson(DecimateHistory(0.0, log.step, column.samples, width))},
          {"spectrum", LineJson(SpectrumLine(log, column, width))}};
}

}  // namespace pinode
