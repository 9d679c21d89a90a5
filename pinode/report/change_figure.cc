#include <algorithm>
#include <array>
#include <cmath>

#include "pinode/base/strings.h"
#include "pinode/report/figure.h"
#include "pinode/report/figure_script.h"
#include "pinode/report/number_text.h"

namespace pinode {
namespace {

// Rows that stay legible.
constexpr int kMaxParameters = 40;

// Computes the change of a parameter and its 95 % limits in per cent; false if
// there is no natural scale.
bool RelativeChange(const ParameterEstimate& parameter, bool is_group,
                    double* change, double* low, double* high) {
  double scale = std::abs(parameter.initial);
  if (is_group) {
    scale = 1.0;
  } else if (!(scale > 0.0)) {
    return false;
  }
  *change = 100.0 * (parameter.value - parameter.initial) / scale;
  *low = 100.0 * (parameter.lower95 - parameter.initial) / scale;
  *high = 100.0 * (parameter.upper95 - parameter.initial) / scale;
  return std::isfinite(*change);
}

// Begins horizontal bars with intervals, per cent, one row per label from the
// top; returns the rows' places.
std::vector<double> BeginBars(const std::vector<std::string>& labels,
                              const std::vector<double>& changes,
                              const std::vector<double>& lows,
                              const std::vector<double>& highs,
                              FigureScript* script) {
  const int count = static_cast<int>(labels.size());
  std::vector<std::string> ticks;
  std::vector<double> places;
  for (int i = 0; i < count; ++i) {
    places.push_back(count - i);
    ticks.push_back(GnuplotString(labels[static_cast<size_t>(i)]) + " " +
                    std::to_string(count - i));
  }
  // Bars of uncertain parameters may be cut off, changes may not.
  Interval range;
  range.Add(0.0);
  for (const double change : changes) range.Add(change);
  const double room = std::max(2.0 * range.width(), 1e-9);
  const double low_limit = range.low - room, high_limit = range.high + room;
  for (int i = 0; i < count; ++i) {
    range.Add(std::max(lows[static_cast<size_t>(i)], low_limit));
    range.Add(std::min(highs[static_cast<size_t>(i)], high_limit));
  }
  const double margin = std::max(0.08 * range.width(), 1e-9);
  script->Line("unset key");
  script->Line("set ytics (" + Join(ticks, ", ") + ")");
  script->Line(Range("y", 0.4, count + 0.6));
  script->Line(Range("x", range.low - margin, range.high + margin));
  script->Line("set xlabel 'change, %'");
  script->Line(std::string("set arrow from 0, graph 0 to 0, graph 1 nohead ") +
               "lc rgb '#222222' lw 0.8");
  return places;
}

// Returns red, green and blue of a probability: grey if a loss is excluded,
// over orange to vermilion if it is certain.
std::array<double, 3> ColourOf(double probability) {
  const double p = std::isfinite(probability) ? probability : 0.0;
  const double none[] = {190.0, 190.0, 190.0};
  const double half[] = {240.0, 180.0, 60.0};
  const double certain[] = {213.0, 40.0, 0.0};
  std::array<double, 3> colour;
  for (size_t k = 0; k < 3; ++k) {
    colour[k] = std::round(p < 0.5 ? none[k] + 2.0 * p * (half[k] - none[k])
                                   : half[k] + (2.0 * p - 1.0) *
                                                   (certain[k] - half[k]));
  }
  return colour;
}

}  // namespace

Figure MakeChangeFigure(const DamageResult& damage) {
  Figure figure;
  std::vector<std::string> labels;
  std::vector<double> changes, lows, highs, reds, greens, blues;
  const std::vector<size_t> shown = ShownChanges(damage);
  for (const size_t j : shown) {
    const GroupChange& change = damage.estimate.groups[j];
    if (static_cast<int>(labels.size()) == kMaxParameters) break;
    if (!IsSeen(change)) continue;
    labels.push_back(damage.subjects[j].name);
    changes.push_back(100.0 * change.change);
    lows.push_back(100.0 * change.lower95);
    highs.push_back(100.0 * change.upper95);
    const std::array<double, 3> colour = ColourOf(LossProbability(damage, j));
    reds.push_back(colour[0]);
    greens.push_back(colour[1]);
    blues.push_back(colour[2]);
  }
  if (labels.empty()) return figure;
  figure.id = "changes";
  FigureScript script(figure.id, 900,
                      80 + 24 * static_cast<int>(labels.size()));
  const std::vector<double> places =
      BeginBars(labels, changes, lows, highs, &script);
  const std::string threshold =
      FormatNumber(-100.0 * damage.options.threshold, 6);
  script.Line("set arrow from " + threshold + ", graph 0 to " + threshold +
              ", graph 1 nohead lc rgb '#888888' dt 2 lw 0.8");
  const std::string data =
      script.Data({changes, places, lows, highs, reds, greens, blues});
  script.Line("plot " + data +
              " using (0):2:1:(0):(65536*$5+256*$6+$7) with vectors nohead lc "
              "rgb variable lw "
              "14, " +
              data +
              " using 1:2:3:4 with xerrorbars pt 7 ps 0.6 lc rgb '#222222' "
              "lw 1.4");
  figure.script = script.text();
  figure.caption =
      "Changes since the baseline with 95 % intervals. Colour: probability of "
      "a loss of more than " +
      ReadableNumber(100.0 * damage.options.threshold, 3) +
      " % (dashed), from grey (none) over orange (a half) to red (certain).";
  if (labels.size() < shown.size()) {
    figure.caption += " The others are in the table.";
  }
  return figure;
}

Figure MakeParameterFigure(const ReportInput& input) {
  Figure figure;
  std::vector<std::string> labels, without_scale;
  std::vector<double> changes, lows, highs;
  bool any_group = false;
  int not_drawn = 0;
  for (const ParameterEstimate& parameter : input.summary->parameters) {
    if (!parameter.free) continue;
    bool is_group = false;
    for (const GroupTerm& group : input.problem->dynamics->groups()) {
      is_group = is_group || group.alpha.name == parameter.name ||
                 group.group.name == parameter.name;
    }
    double change, low, high;
    if (!RelativeChange(parameter, is_group, &change, &low, &high)) {
      without_scale.push_back(parameter.name);
      continue;
    }
    if (static_cast<int>(labels.size()) == kMaxParameters) {
      ++not_drawn;
      continue;
    }
    any_group = any_group || is_group;
    labels.push_back(parameter.name);
    changes.push_back(change);
    // Without an interval there is only a point.
    lows.push_back(std::isfinite(low) ? low : change);
    highs.push_back(std::isfinite(high) ? high : change);
  }
  if (labels.empty()) return figure;

  figure.id = "parameters";
  const int count = static_cast<int>(labels.size());
  FigureScript script(figure.id, 900, 80 + 24 * count);
  const std::vector<double> places =
      BeginBars(labels, changes, lows, highs, &script);
  const std::string data = script.Data({changes, places, lows, highs});
  script.Line("plot " + data +
              " using (0):2:1:(0) with vectors nohead lc rgb '#9cc7e0' lw 9, " +
              data +
              " using 1:2:3:4 with xerrorbars pt 7 ps 0.6 lc rgb '#0072B2' "
              "lw 1.8");
  figure.script = script.text();

  figure.caption =
      "Changes with 95 % intervals, in per cent of the initial value";
  if (any_group) {
    figure.caption += " (groups: of the group's own matrix)";
  }
  figure.caption += ".";
  if (!without_scale.empty()) {
    figure.caption += " Not drawn, because the initial value is zero: " +
                      Join(without_scale, ", ") + ".";
  }
  if (not_drawn > 0) {
    figure.caption +=
        " The table also has " + Count(not_drawn, "further parameter") + ".";
  }
  return figure;
}

}  // namespace pinode
