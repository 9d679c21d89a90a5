#include <algorithm>
#include <cmath>

#include "pinode/report/figure.h"
#include "pinode/report/figure_script.h"
#include "pinode/report/number_text.h"

namespace pinode {
namespace {

// Largest ratio shown, as a multiple of the 99 % threshold.
constexpr double kShownRatio = 1.6;

// Draws a dashed level with its name at the right.
void DrawThreshold(double level, const std::string& name,
                   FigureScript* script) {
  const std::string y = ScriptNumber(level);
  script->Line("set arrow from graph 0, first " + y + " to graph 1, first " +
               y + " nohead lc rgb '#888888' dt 2 lw 0.8");
  script->Line("set label " + GnuplotString(name) + " at graph 0.99, first " +
               y + " right offset 0,0.5 tc rgb '#666666'");
}

// Returns the step of two to four marks on an axis: values of a narrow interval
// have many digits and need room.
double MarkStep(double width) {
  const double least = width / 4.0;
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double times : {1.0, 2.0, 5.0}) {
    if (times * power >= least) return times * power;
  }
  return 10.0 * power;
}

// Computes the curve through the points. The signed root of the ratio is a
// straight line for a parabola, and is interpolated linearly.
void CurveThrough(const ParameterProfile& profile, std::vector<double>* values,
                  std::vector<double>* ratios) {
  constexpr int kParts = 12;
  const auto root = [&profile](const ParameterProfile::Point& point) {
    const double size = std::sqrt(std::max(0.0, point.ratio));
    return point.value < profile.estimate ? -size : size;
  };
  for (size_t i = 0; i + 1 < profile.points.size(); ++i) {
    const ParameterProfile::Point& left = profile.points[i];
    const ParameterProfile::Point& right = profile.points[i + 1];
    for (int k = 0; k <= kParts; ++k) {
      const double share = static_cast<double>(k) / kParts;
      const double at = root(left) + share * (root(right) - root(left));
      values->push_back(left.value + share * (right.value - left.value));
      ratios->push_back(at * at);
    }
  }
}

}  // namespace

Figure MakeProfileFigure(const ParameterProfile& profile, int number) {
  Figure figure;
  if (profile.points.size() < 3) return figure;
  const double top = kShownRatio * profile.threshold99;
  std::vector<double> values, ratios;
  Interval range;
  for (const ParameterProfile::Point& point : profile.points) {
    values.push_back(point.value);
    ratios.push_back(point.ratio);
    if (point.ratio < top) range.Add(point.value);
  }
  for (const double end : {profile.lower99, profile.upper99}) range.Add(end);
  if (range.empty() || !(range.width() > 0.0)) return figure;
  figure.id = "profile" + std::to_string(number);
  figure.half_width = true;
  FigureScript script(figure.id, 440, 300);
  script.Line("unset key");
  script.Line("set xlabel " +
              GnuplotString(AxisLabel(profile.name, UnitText(profile.unit))));
  script.Line("set ylabel 'likelihood ratio'");
  script.Line(Range("x", range.low - 0.05 * range.width(),
                    range.high + 0.05 * range.width()));
  script.Line("set xtics " + ScriptNumber(MarkStep(range.width())));
  script.Line(Range("y", 0.0, top));
  DrawThreshold(profile.threshold95, "95 %", &script);
  DrawThreshold(profile.threshold99, "99 %", &script);
  std::string plot = "plot ";
  // The linear interval's parabola.
  const double half = 0.5 * (profile.linear_upper95 - profile.linear_lower95);
  if (std::isfinite(half) && half > 0.0) {
    std::vector<double> x, y;
    const double reach = half * std::sqrt(top / profile.threshold95);
    for (int i = -30; i <= 30; ++i) {
      x.push_back(profile.estimate + reach * i / 30.0);
      y.push_back(top * i * i / 900.0);
    }
    plot += Lines(script.Data({x, y}), kFaintLine, "") + ", ";
  }
  const std::string data = script.Data({values, ratios});
  std::vector<double> curve_values, curve_ratios;
  CurveThrough(profile, &curve_values, &curve_ratios);
  script.Line(plot +
              Lines(script.Data({curve_values, curve_ratios}),
                    "lc rgb '#0072B2' lw 1.8", "") +
              ", " + data +
              " using 1:2 with points lc rgb '#0072B2' pt 7 ps 0.5");
  figure.script = script.text();
  figure.caption = profile.name + ": " +
                   std::string(DeterminationName(profile.determination)) +
                   ". Blue: all others fitted again at each point. Grey: "
                   "parabola of the linear interval.";
  return figure;
}

}  // namespace pinode
