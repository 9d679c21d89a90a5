// The figures of a report, drawn by gnuplot as SVG.
//
// Measurements are a broad grey line, the updated model is blue, the initial
// model orange and dashed: colours of M. Okabe and K. Ito, "Color Universal
// Design" (2008), which readers with any colour vision tell apart, with line
// styles that survive a black-and-white printer.

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

// Figure: its content and its caption. An empty script means an empty figure.
struct Figure {
  // Letters, digits and underscores; unique within a document.
  std::string id;
  std::string caption;
  std::string script;
  // True: two of these fit side by side.
  bool half_width = false;

  bool empty() const { return script.empty(); }
};

// Makes the figure of a measured channel with its simulations: the whole
// record, the strongest few periods, and the residual of the updated model with
// plus and minus two sigma. `prior`: the simulation of the initial model, if
// there is one. Empty if the summary has no prediction of the channel.
Figure MakeChannelFigure(const ReportInput& input, int record, int channel,
                         const HistoryRef& prior = Vector());

// Makes force against deformation and, unless the law is a mere spring, against
// the rate. A long record is cut to the part around the largest deformation.
Figure MakeLoopFigure(const ReportInput& input, const RestoringForceLoop& loop,
                      int number);

// Makes the changes since the baselines with their intervals, bars coloured by
// the probability of a loss beyond the threshold.
Figure MakeChangeFigure(const DamageResult& damage);

// Makes an unknown force with its 95 % band, compared with the true force if
// that is given: the whole record and the part where the force is largest.
Figure MakeForceFigure(const ReportInput& input, int force);

// Makes the spectral densities of an ambient record's channels (at most six),
// measured and modelled, with the expected band of 95 % of the measured ones.
Figure MakeAmbientFigure(const ReportInput& input, int record);

// Makes magnitude and phase of frequency response functions (at most six),
// measured and of the fitted model. `set`: index in FitSummary::frfs.
Figure MakeModelFrfFigure(const ReportInput& input, int set);

// Makes the likelihood ratio along a parameter, with the parabola of its linear
// interval; empty if there are no points.
Figure MakeProfileFigure(const ParameterProfile& profile, int number);

// Makes changes of the named free parameters in per cent with 95 % bars.
// Parameters that start at zero and are not group factors have no such change;
// the caption names them.
Figure MakeParameterFigure(const ReportInput& input);

// Makes the first modes (at most six), initial against updated.
Figure MakeModeShapeFigure(const ReportInput& input);

// Makes the regressed values and the equation's values against each feature of
// its terms (at most four), along the training records. Fig. 6 of Lai et al.
// (2021).
Figure MakeEquationFigure(const DiscoveredEquation& equation,
                          const UnitSystem& units, int number);

// Makes the residual over the number of terms, with the chosen number.
Figure MakeParetoFigure(const DiscoveredEquation& equation, int number);

// Returns the source of an equation: "network nn1".
std::string SourceOf(const DiscoveredEquation& equation);

// Makes the cost over the iterations, and the error of the simulation over the
// stages.
Figure MakeConvergenceFigure(const ReportInput& input);

// Draws figures as <svg> elements for HTML: no prolog, no external references,
// ids that begin with the figure's. One run of gnuplot draws all of them, at
// about the cost of one. Returns false, with the reason in *error, if gnuplot
// fails for any of them.
[[nodiscard]] bool DrawSvgs(const std::vector<const Figure*>& figures,
                            const GnuplotOptions& options,
                            std::vector<std::string>* svgs, std::string* error);

}  // namespace pinode

#endif  // PINODE_REPORT_FIGURE_H_
