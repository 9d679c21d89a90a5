#include <algorithm>
#include <set>

#include "pinode/report/figure.h"
#include "pinode/report/figure_script.h"
#include "pinode/report/number_text.h"

namespace pinode {
namespace {

constexpr int kMaxLoopSamples = 2000;

// Springs say everything in their force-deformation loop.
bool DependsOnRate(const RestoringForceLoop& loop) {
  static const std::set<std::string> kSprings = {"cubic", "quadratic_stiffness",
                                                 "bilinear", "bouc_wen"};
  return kSprings.count(loop.type) == 0;
}

}  // namespace

Figure MakeLoopFigure(const ReportInput& input, const RestoringForceLoop& loop,
                      int number) {
  Figure figure;
  const int samples = static_cast<int>(loop.force.size());
  if (samples < 2 || !loop.force.allFinite()) return figure;
  const int count = std::min(samples, kMaxLoopSamples);
  Eigen::Index peak;
  loop.deformation.cwiseAbs().maxCoeff(&peak);
  const int first =
      std::clamp(static_cast<int>(peak) - count / 2, 0, samples - count);

  figure.id = "loop_" + std::to_string(number);
  const bool two_panels = DependsOnRate(loop) && loop.rate.size() == samples;
  figure.half_width = !two_panels;
  FigureScript script(figure.id, two_panels ? 900 : 440, 300);
  if (loop.known == nullptr) {
    script.Line("unset key");
  } else {
    // Above the first panel.
    script.Line("set key at screen " +
                std::string(two_panels ? "0.48" : "0.96") + ",0.99 horizontal");
  }
  script.Line("set multiplot layout 1," + std::string(two_panels ? "2" : "1") +
              " margins " + (two_panels ? "0.1,0.975" : "0.19,0.96") + ",0.2," +
              std::string(loop.known != nullptr ? "0.89" : "0.95") +
              " spacing 0.12,0.1");
  const std::string quantity = loop.is_acceleration ? "acceleration" : "force";
  script.Line("set ylabel " +
              GnuplotString(AxisLabel(quantity, loop.force_unit)));
  const Vector force = loop.force.segment(first, count);
  const auto plot = [&](const Vector& abscissa, const std::string& label,
                        const std::string& unit) {
    script.Line("set xlabel " + GnuplotString(AxisLabel(label, unit)));
    const std::string data =
        script.Data({Column(abscissa.segment(first, count)), Column(force)});
    const bool beside_known =
        loop.known != nullptr && &abscissa == &loop.deformation;
    std::string lines;
    if (beside_known) {
      // Where the structure went, and not far beyond.
      const double low = abscissa.minCoeff(), high = abscissa.maxCoeff();
      const double margin = 0.05 * (high - low);
      script.Line(Range("x", low - margin, high + margin));
      lines = Lines(script.Data({Column(loop.known->deformation),
                                 Column(loop.known->force)}),
                    kMeasuredLine, loop.known->name) +
              ", ";
    }
    script.Line("plot " + lines +
                Lines(data, "lc rgb '#0072B2' lw 0.9 dt 1",
                      beside_known ? "identified" : std::string()));
    script.Line("set autoscale x");
  };
  plot(loop.deformation, loop.deformation_name, loop.deformation_unit);
  if (two_panels) plot(loop.rate, loop.rate_name, loop.rate_unit);
  script.Line("unset multiplot");
  figure.script = script.text();

  std::string type = loop.type;
  std::replace(type.begin(), type.end(), '_', '-');
  figure.caption = loop.term + " (" + type + ")";
  if (!loop.output.empty()) figure.caption += ", " + loop.output;
  figure.caption += loop.is_acceleration
                        ? ": acceleration that the network adds, along "
                        : ": resisting force along ";
  figure.caption += RecordWithRole(input, loop.record);
  if (count < samples) {
    figure.caption += ", " + ReadableNumber(loop.time(first), 4) + " to " +
                      ReadableNumber(loop.time(first + count - 1), 4) + " " +
                      input.problem->description.units.time;
  }
  figure.caption += ".";
  return figure;
}

}  // namespace pinode
