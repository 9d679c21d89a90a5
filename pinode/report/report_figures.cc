#include "pinode/report/report_figures.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/parallel_for.h"
#include "pinode/report/restoring_force.h"

namespace pinode {
namespace {

using Role = IdentificationRecord::Role;

// Number of figures in one run of gnuplot, whose start costs as much as drawing
// ten. It is limited so that several runs use several threads.
constexpr size_t kFiguresARun = 12;

// Number of sensor values of the initial model that are kept at a time.
constexpr Eigen::Index kNumbersARun = 4000000;

// Returns the indices of the records' channels to be drawn, those with the
// largest errors if there are too many, in the record's order.
std::vector<int> ChannelsToDraw(const RecordScore& score, int count,
                                int limit) {
  std::vector<int> channels(static_cast<size_t>(count));
  for (int c = 0; c < count; ++c) channels[static_cast<size_t>(c)] = c;
  const auto error = [&](int c) {
    const size_t index = static_cast<size_t>(c);
    const double nrmse =
        index < score.channels.size() ? score.channels[index].nrmse : 0.0;
    // An error that is not a number counts as worst.
    return std::isfinite(nrmse) ? nrmse : kInfinity;
  };
  std::stable_sort(channels.begin(), channels.end(),
                   [&](int a, int b) { return error(a) > error(b); });
  if (count > limit) channels.resize(static_cast<size_t>(std::max(limit, 0)));
  std::sort(channels.begin(), channels.end());
  return channels;
}

class Planner {
 public:
  Planner(const ReportInput& input, const HtmlReportOptions& options,
          ReportFigures* figures)
      : input_(input),
        summary_(*input.summary),
        options_(options),
        figures_(*figures) {}

  void Plan() {
    if (input_.damage != nullptr) {
      figures_.changes = Add(MakeChangeFigure(*input_.damage));
    }
    figures_.parameters = Add(MakeParameterFigure(input_));
    for (size_t f = 0; f < summary_.forces.size(); ++f) {
      AddTo(MakeForceFigure(input_, static_cast<int>(f)), &figures_.forces);
    }
    for (size_t p = 0; p < summary_.profiles.size(); ++p) {
      AddTo(MakeProfileFigure(summary_.profiles[p], static_cast<int>(p)),
            &figures_.profiles);
    }
    for (size_t r = 0; r < summary_.ambient.size(); ++r) {
      AddTo(MakeAmbientFigure(input_, static_cast<int>(r)), &figures_.ambient);
    }
    for (size_t s = 0; s < summary_.frfs.size(); ++s) {
      AddTo(MakeModelFrfFigure(input_, static_cast<int>(s)), &figures_.frfs);
    }
    figures_.modes = Add(MakeModeShapeFigure(input_));
    figures_.convergence = Add(MakeConvergenceFigure(input_));
    for (const Role role : {Role::kHoldout, Role::kTrain}) PlanHistories(role);
    PlanLoops();
    PlanEquations();
  }

 private:
  int Add(Figure figure) {
    if (figure.empty()) return -1;
    figures_.pictures.push_back({std::move(figure), "", ""});
    return static_cast<int>(figures_.pictures.size()) - 1;
  }
  void AddTo(Figure figure, std::vector<int>* indices) {
    const int index = Add(std::move(figure));
    if (index >= 0) indices->push_back(index);
  }

  void PlanHistories(Role role) {
    for (size_t r = 0; r < summary_.records.size(); ++r) {
      const IdentificationRecord& record = input_.problem->records.at(r);
      if (record.role != role) continue;
      const int count = static_cast<int>(record.channels.size());
      const std::vector<int> channels = ChannelsToDraw(
          summary_.records[r], count, options_.max_channels_per_record);
      ReportFigures::History history;
      history.record = static_cast<int>(r);
      AddHistories(channels, &history);
      if (history.figures.empty()) continue;
      history.num_left_out = count - static_cast<int>(channels.size());
      figures_.histories.push_back(std::move(history));
    }
  }

  // Adds a few channels at a time: the initial model is simulated for the
  // figures alone, and a long record already takes much of the memory.
  void AddHistories(const std::vector<int>& channels,
                    ReportFigures::History* history) {
    const Eigen::Index samples =
        input_.problem->records.at(static_cast<size_t>(history->record))
            .num_samples();
    const size_t most = static_cast<size_t>(std::max<Eigen::Index>(
        kNumbersARun / std::max<Eigen::Index>(samples, 1), 1));
    for (size_t first = 0; first < channels.size(); first += most) {
      const auto begin = channels.begin() + static_cast<std::ptrdiff_t>(first);
      const std::vector<int> some(
          begin, begin + static_cast<std::ptrdiff_t>(
                             std::min(most, channels.size() - first)));
      Matrix prior;
      if (input_.run_prior != nullptr) {
        prior = input_.run_prior(history->record, some);
      }
      for (size_t i = 0; i < some.size(); ++i) {
        AddTo(prior.size() == 0
                  ? MakeChannelFigure(input_, history->record, some[i])
                  : MakeChannelFigure(
                        input_, history->record, some[i],
                        prior.row(static_cast<Eigen::Index>(i)).transpose()),
              &history->figures);
      }
    }
  }

  void PlanLoops() {
    const std::vector<RestoringForceLoop> loops =
        ComputeRestoringForceLoops(input_);
    for (size_t i = 0; i < loops.size(); ++i) {
      if (static_cast<int>(figures_.loops.size()) >= options_.max_loops) {
        ++figures_.num_loops_left_out;
        continue;
      }
      AddTo(MakeLoopFigure(input_, loops[i], static_cast<int>(i)),
            &figures_.loops);
    }
  }

  void PlanEquations() {
    if (input_.equations == nullptr) return;
    const UnitSystem& units = input_.problem->description.units;
    for (size_t e = 0; e < input_.equations->size(); ++e) {
      const DiscoveredEquation& equation = (*input_.equations)[e];
      const int number = static_cast<int>(e);
      std::vector<int> indices;
      AddTo(MakeEquationFigure(equation, units, number), &indices);
      AddTo(MakeParetoFigure(equation, number), &indices);
      figures_.equations.push_back(std::move(indices));
    }
  }

  const ReportInput& input_;
  const IdentificationSummary& summary_;
  const HtmlReportOptions& options_;
  ReportFigures& figures_;
};

}  // namespace

ReportFigures PlanFigures(const ReportInput& input,
                          const HtmlReportOptions& options) {
  ReportFigures figures;
  Planner(input, options, &figures).Plan();
  return figures;
}

void DrawFigures(const HtmlReportOptions& options, ReportFigures* figures) {
  using Picture = ReportFigures::Picture;
  const size_t size = figures->pictures.size();
  const auto draw = [&](size_t first, size_t count, std::string* error) {
    std::vector<const Figure*> several;
    for (size_t i = first; i < first + count; ++i) {
      several.push_back(&figures->pictures[i].figure);
    }
    std::vector<std::string> svgs;
    if (!DrawSvgs(several, options.gnuplot, &svgs, error)) return false;
    for (size_t i = 0; i < count; ++i) {
      figures->pictures[first + i].svg = std::move(svgs[i]);
    }
    return true;
  };
  const int num_runs =
      static_cast<int>((size + kFiguresARun - 1) / kFiguresARun);
  ParallelFor(num_runs, std::max(options.num_threads, 1), [&](int run, int) {
    const size_t first = static_cast<size_t>(run) * kFiguresARun;
    const size_t count = std::min(kFiguresARun, size - first);
    std::string ignored;
    if (draw(first, count, &ignored)) return;
    // Figures are drawn separately, so that one failure does not affect the
    // others.
    for (size_t i = first; i < first + count; ++i) {
      Picture& picture = figures->pictures[i];
      if (!draw(i, 1, &picture.error)) picture.svg.clear();
    }
  });
}

}  // namespace pinode
