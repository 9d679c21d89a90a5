#include <cmath>

#include "pinode/base/strings.h"
#include "pinode/report/figure.h"
#include "pinode/report/figure_script.h"

namespace pinode {
namespace {

// Iterations as points, and ends of stages on their axis.
struct Course {
  std::vector<double> accepted_x, accepted_y, rejected_x, rejected_y;
  Interval costs;
  std::vector<double> ends;
  std::vector<Eigen::Index> lengths;  // longest segments, samples
  // Error in per cent at the end of stages.
  std::vector<double> error_x, error_y;

  double end() const { return ends.back(); }
};

// Costs of rejected steps are drawn at most at this multiple of the largest
// accepted one.
constexpr double kMostRejected = 10.0;

Course CourseOf(const IdentificationSummary& summary) {
  Course course;
  const std::vector<IterationRecord>& iterations = summary.iterations;
  for (size_t i = 0; i < iterations.size(); ++i) {
    const IterationRecord& iteration = iterations[i];
    const double x = static_cast<double>(i);
    if (i > 0 && iteration.stage != iterations[i - 1].stage) {
      course.ends.push_back(x - 0.5);
      course.lengths.push_back(iterations[i - 1].segment_samples);
    }
    const bool drawable = std::isfinite(iteration.cost) && iteration.cost > 0.0;
    if (!drawable) continue;
    (iteration.accepted ? course.accepted_x : course.rejected_x).push_back(x);
    (iteration.accepted ? course.accepted_y : course.rejected_y)
        .push_back(iteration.cost);
    if (iteration.accepted) course.costs.Add(iteration.cost);
  }
  // A rejected step may have any cost.
  for (double& cost : course.rejected_y) {
    cost = std::min(cost, kMostRejected * course.costs.high);
  }
  course.ends.push_back(static_cast<double>(iterations.size()) - 0.5);
  course.lengths.push_back(iterations.back().segment_samples);
  const std::vector<StageRecord>& stages = summary.stages;
  for (size_t s = 0; s < stages.size() && s < course.ends.size(); ++s) {
    const double error = 100.0 * stages[s].free_run_error;
    if (!std::isfinite(error) || !(error > 0.0)) continue;
    course.error_x.push_back(course.ends[s]);
    course.error_y.push_back(error);
  }
  return course;
}

void MarkStages(const Course& course, FigureScript* script) {
  const double num_iterations = course.end() + 0.5;
  double begin = -0.5;
  for (size_t s = 0; s < course.ends.size(); ++s) {
    const double end = course.ends[s];
    if (s + 1 < course.ends.size()) {
      script->Line("set arrow from " + ScriptNumber(end) + ", graph 0 to " +
                   ScriptNumber(end) +
                   ", graph 1 nohead lc rgb '#999999' lw 0.8");
    }
    // Short stages have no room for words.
    if (end - begin > 0.05 * num_iterations) {
      script->Line("set label " + std::to_string(s + 1) + " '" +
                   std::to_string(course.lengths[s]) + "' at " +
                   ScriptNumber(0.5 * (begin + end)) +
                   ", graph 1.05 center tc rgb '#555555'");
    }
    begin = end;
  }
}

void PlotCosts(const Course& course, bool is_last_panel, FigureScript* script) {
  std::string plot = "plot " +
                     script->Data({course.accepted_x, course.accepted_y}) +
                     " using 1:2 with linespoints pt 7 ps 0.35 " +
                     kUpdatedLine + " title 'accepted'";
  if (!course.rejected_x.empty()) {
    plot += ", " + script->Data({course.rejected_x, course.rejected_y}) +
            " using 1:2 with points pt 2 ps 0.5 " + kMark + " title 'rejected'";
  }
  // The data blocks come before the line that plots them.
  if (is_last_panel) script->Line("set xlabel 'iteration'");
  script->Line(plot);
}

void PlotErrors(const Course& course, FigureScript* script) {
  script->Line("unset label");
  script->Line("unset key");
  script->Line("set autoscale y");
  script->Line("set xlabel 'iteration'");
  script->Line("set ylabel 'simulation error, %'");
  Interval errors;
  for (const double error : course.error_y) errors.Add(error);
  script->Line(Range("y", errors.low / 2.0, errors.high * 4.0));
  const std::string data = script->Data({course.error_x, course.error_y});
  script->Line("plot " + data + " using 1:2 with linespoints pt 7 ps 0.7 " +
               kUpdatedLine + ", " + data +
               " using 1:2:(sprintf('%.3g', $2)) with labels offset 0,0.8");
}

}  // namespace

Figure MakeConvergenceFigure(const ReportInput& input) {
  Figure figure;
  if (input.summary->iterations.size() < 2) return figure;
  const Course course = CourseOf(*input.summary);
  if (course.accepted_x.empty()) return figure;
  figure.id = "convergence";
  const bool two_panels = !course.error_x.empty();
  FigureScript script(figure.id, 900, two_panels ? 380 : 240);
  script.Line("set multiplot layout " + std::string(two_panels ? "2" : "1") +
              ",1 margins 0.085,0.985," + (two_panels ? "0.13" : "0.2") +
              ",0.92 spacing 0.1,0.09");
  script.Line("set logscale y");
  script.Line("set format y '%.3g'");
  script.Line(Range("x", -0.5, course.end()));
  script.Line("set ylabel 'cost'");
  if (course.costs.high < 10.0 * course.costs.low) {
    script.Line(Range("y", course.costs.low / 2.0, course.costs.high * 2.0));
  }
  MarkStages(course, &script);
  PlotCosts(course, !two_panels, &script);
  if (two_panels) PlotErrors(course, &script);
  script.Line("unset multiplot");
  figure.script = script.text();
  figure.caption =
      "Cost over the iterations. Vertical lines separate the stages; the "
      "numbers above are their longest segments in samples. The cost jumps "
      "where noise levels are estimated anew or segments merge. Rejected steps "
      "above ten times the largest cost are drawn at that height.";
  if (two_panels) {
    figure.caption +=
        " Below: error of the simulation of the whole training records after "
        "each stage.";
  }
  return figure;
}

}  // namespace pinode
