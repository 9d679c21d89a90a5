// The figures of a report, drawn by gnuplot as SVG.
//
// Measured is a broad grey line, the updated model blue, the prior model orange
// and dashed: colours of M. Okabe and K. Ito, "Color Universal Design" (2008),
// which readers with any colour vision tell apart, with line styles that
// survive a black-and-white printer.

#ifndef PINODE_REPORT_FIGURE_H_
#define PINODE_REPORT_FIGURE_H_

#include <string>
#include <vector>

#include "pinode/discover/discovery.h"
#include "pinode/report/decimate.h"
#include "pinode/report/gnuplot.h"
#include "pinode/report/report.h"
#include "pinode/report/restoring_force.h"

namespace pinode {

// What to draw, and what to write below it. An empty script: there is nothing
// to draw.
struct Figure {
  // Letters, digits and underscores; unique within a document.
  std::string id;
  std::string caption;
  std::string script;
  // Two of these fit side by side.
  bool half_width = false;

  bool empty() const { return script.empty(); }
};

// A measured channel with its free runs: the whole record, the strongest few
// periods, and the residual of the updated model with plus and minus two sigma.
// `prior`: the run of the model before, where there is one. Empty where the
// summary holds no prediction of it.
Figure MakeChannelFigure(const ReportInput& input, int record, int channel,
                         const HistoryRef& prior = Vector());

// Force against deformation and, where the law is not a mere spring, against
// the rate;
// of a long record the part around the largest deformation.
Figure MakeLoopFigure(const ReportInput& input, const RestoringForceLoop& loop,
                      int number);

// Changes since healthy records with their intervals, bars coloured by the
// probability of a loss beyond the threshold.
Figure MakeChangeFigure(const DamageResult& damage);

// An unknown force with its 95 % band, beside what it was in truth where that
// is given: the whole record and the part where the force is largest.
Figure MakeForceFigure(const ReportInput& input, int force);

// Spectral densities of an ambient record's channels (at most six), measured
// and of the model, with the band in which 95 % of the measured ones are to
// lie.
Figure MakeAmbientFigure(const ReportInput& input, int record);

// The likelihood ratio along a parameter, beside the parabola of its linear
// interval; empty where there are no points.
Figure MakeProfileFigure(const ParameterProfile& profile, int number);

// Changes of the named free parameters in per cent with 95 % bars. Parameters
// that start at zero and are not group factors have no such change; the caption
// names them.
Figure MakeParameterFigure(const ReportInput& input);

// The first modes (at most six), initial against updated.
Figure MakeModeShapeFigure(const ReportInput& input);

// What was regressed and what the equation says, against each feature that its
// terms depend on (at most four), along the training records. Fig. 6 of Lai et
// al. (2021).
Figure MakeEquationFigure(const DiscoveredEquation& equation,
                          const UnitSystem& units, int number);

// Residual over the number of terms, and the number that was chosen.
Figure MakeParetoFigure(const DiscoveredEquation& equation, int number);

// What an equation was regressed from: "network nn1".
std::string SourceOf(const DiscoveredEquation& equation);

// Cost over the iterations, free-run error over the stages.
Figure MakeConvergenceFigure(const ReportInput& input);

// Figures as <svg> elements to be put into HTML: no prolog, no references to
// anything outside, ids that begin with the figure's. One run of gnuplot for
// all of them, which costs about as much as one. False, with the reason in
// *error, where gnuplot does not do its part for any of them.
[[nodiscard]] bool DrawSvgs(const std::vector<const Figure*>& figures,
                            const GnuplotOptions& options,
                            std::vector<std::string>* svgs, std::string* error);

}  // namespace pinode

#endif  // PINODE_REPORT_FIGURE_H_
