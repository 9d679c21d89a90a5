#include <algorithm>
#include <set>

#include "pinode/report/figure.h"
#include "pinode/report/figure_script.h"
#include "pinode/report/number_text.h"

namespace pinode {
namespace {

// Samples of a loop about its peak. More would cover one another.
constexpr int kMaxLoopSamples = 2000;

// False for springs, whose force-deformation loop is complete.
bool DependsOnRate(const RestoringForceLoop& loop) {
  static const std::set<std::string> kSprings = {
      "cubic",    "quadratic_stiffness", "bilinear",
      "bouc_wen", "backlash_friction",   "play",
      "iwan",     "baber_noori"};
  return kSprings.count(loop.type) == 0;
}

// Samples of a loop that are drawn.
struct LoopPart {
  Eigen::Index first = 0;
  Eigen::Index count = 0;
};

// Returns as many samples as a figure can show, with the largest deformation in
// their middle.
LoopPart PartToDraw(const RestoringForceLoop& loop) {
  const Eigen::Index samples = loop.force.size();
  LoopPart part;
  part.count = std::min<Eigen::Index>(samples, kMaxLoopSamples);
  Eigen::Index peak;
  loop.deformation.cwiseAbs().maxCoeff(&peak);
  part.first =
      std::clamp<Eigen::Index>(peak - part.count / 2, 0, samples - part.count);
  return part;
}

// Sets the common parts of both panels: key, margins, the ordinate.
void SetUpPanels(const RestoringForceLoop& loop, bool two_panels,
                 FigureScript* script) {
  if (loop.known == nullptr) {
    script->Line("unset key");
  } else {
    // Key above the first panel.
    script->Line("set key at screen " +
                 std::string(two_panels ? "0.48" : "0.96") +
                 ",0.99 horizontal");
  }
  script->Line("set multiplot layout 1," + std::string(two_panels ? "2" : "1") +
               " margins " + (two_panels ? "0.1,0.975" : "0.19,0.96") +
               ",0.2," + std::string(loop.known != nullptr ? "0.89" : "0.95") +
               " spacing 0.12,0.1");
  const std::string quantity = loop.is_acceleration ? "acceleration" : "force";
  script->Line("set ylabel " +
               GnuplotString(AxisLabel(quantity, loop.force_unit)));
}

// Plots the force over `abscissa`, with the known curve if that is not null.
void PlotPanel(const RestoringForceLoop& loop, const LoopPart& part,
               const Vector& abscissa, const std::string& axis_label,
               const ReferenceCurve* known, FigureScript* script) {
  script->Line("set xlabel " + GnuplotString(axis_label));
  const std::string data =
      script->Data({Column(abscissa.segment(part.first, part.count)),
                    Column(loop.force.segment(part.first, part.count))});
  std::string lines;
  if (known != nullptr) {
    // Range of the motion, with a small margin.
    const double low = abscissa.minCoeff(), high = abscissa.maxCoeff();
    const double margin = 0.05 * (high - low);
    script->Line(Range("x", low - margin, high + margin));
    lines =
        Lines(script->Data({Column(known->deformation), Column(known->force)}),
              kMeasuredLine, known->name) +
        ", ";
  }
  script->Line("plot " + lines +
               Lines(data, "lc rgb '#0072B2' lw 0.9 dt 1",
                     known != nullptr ? "identified" : std::string()));
  script->Line("set autoscale x");
}

std::string LoopCaption(const ReportInput& input,
                        const RestoringForceLoop& loop, const LoopPart& part) {
  std::string type = loop.type;
  std::replace(type.begin(), type.end(), '_', '-');
  std::string caption = loop.term + " (" + type + ")";
  if (!loop.output.empty()) caption += ", " + loop.output;
  caption += loop.is_acceleration
                 ? ": acceleration added by the network, along "
                 : ": resisting force along ";
  caption += RecordWithRole(input, loop.record);
  if (part.count < loop.force.size()) {
    caption += ", " + ReadableNumber(loop.time(part.first), 4) + " to " +
               ReadableNumber(loop.time(part.first + part.count - 1), 4) + " " +
               input.problem->description.units.time;
  }
  return caption + ".";
}

}  // namespace

Figure MakeLoopFigure(const ReportInput& input, const RestoringForceLoop& loop,
                      int number) {
  Figure figure;
  const Eigen::Index samples = loop.force.size();
  if (samples < 2 || !loop.force.allFinite()) return figure;
  const LoopPart part = PartToDraw(loop);
  const bool two_panels = DependsOnRate(loop) && loop.rate.size() == samples;
  figure.id = "loop_" + std::to_string(number);
  figure.half_width = !two_panels;
  FigureScript script(figure.id, two_panels ? 900 : 440, 300);
  SetUpPanels(loop, two_panels, &script);
  PlotPanel(loop, part, loop.deformation,
            AxisLabel(loop.deformation_name, loop.deformation_unit), loop.known,
            &script);
  if (two_panels) {
    PlotPanel(loop, part, loop.rate, AxisLabel(loop.rate_name, loop.rate_unit),
              nullptr, &script);
  }
  script.Line("unset multiplot");
  figure.script = script.text();
  figure.caption = LoopCaption(input, loop, part);
  return figure;
}

}  // namespace pinode
