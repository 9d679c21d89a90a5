#include <algorithm>
#include <cmath>

#include "pinode/report/figure.h"
#include "pinode/report/figure_script.h"
#include "pinode/report/number_text.h"

namespace pinode {
namespace {

// Beyond this share of the 99 % threshold nothing is told apart.
constexpr double kShownRatio = 1.6;

// A dashed level with its name at the right.
void DrawThreshold(double level, const std::string& name,
                   FigureScript* script) {
  const std::string y = ScriptNumber(level);
  script->Line("set arrow from graph 0, first " + y + " to graph 1, first " +
               y + " nohead lc rgb '#888888' dt 2 lw 0.8");
  script->Line("set label " + GnuplotString(name) + " at graph 0.99, first " +
               y + " right offset 0,0.5 tc rgb '#666666'");
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
  script.Line(plot + data + " using 1:2 with linespoints lc rgb '#0072B2' " +
              "lw 1.8 pt 7 ps 0.4");
  figure.script = script.text();
  figure.caption = profile.name + ": " +
                   std::string(DeterminationName(profile.determination)) +
                   ". Blue: all others fitted again at each point; grey: the "
                   "parabola of the linear interval.";
  return figure;
}

}  // namespace pinode
