#include "tests/cases/case_figures.h"

#include <cmath>

#include "gtest/gtest.h"
#include "tests/support/figure_testing.h"

namespace pinode {
namespace testing {
namespace {

// The worst of twenty seeds (study_test.cc), by scheme.
struct WorstErrors {
  const char* scheme;
  double training;
  double late;
  double unseen_start;
};

constexpr WorstErrors kWorstErrors[] = {
    {"scheme1", 4.8e-7, 5.1e-6, 2.9e-4},
    {"scheme2", 6.6e-7, 5.0e-6, 1.3e-3},
    {"scheme3", 7.3e-7, 9.7e-7, 3.6e-4},
};

// Of the springs and dampers `names`, as a part of each.
double WorstGroup(const CaseRun& run, const std::vector<std::string>& names) {
  double worst = 0.0;
  for (const std::string& name : names) {
    const double truth = Truth("data/four_dof_free/truth.json",
                               "/groups/scheme2_groups/" + name);
    // 0.7 of the truth is in the matrices.
    worst = Worse(
        worst,
        std::abs((0.7 + run.Parameter(name).value) / (0.7 + truth) - 1.0));
  }
  return worst;
}

}  // namespace

std::vector<CaseFigure> SchemeFigures(const std::string& scheme) {
  for (const WorstErrors& worst : kWorstErrors) {
    if (scheme != worst.scheme) continue;
    return {
        {"mean squared error, training", 1e-6, worst.training,
         [](const CaseRun& run) {
           return 0.5 *
                  (run.MeanSquaredError("h1") + run.MeanSquaredError("h2"));
         }},
        {"mean squared error, h1_late and h2_late", 1e-3, worst.late,
         [](const CaseRun& run) {
           return 0.5 * (run.MeanSquaredError("h1_late") +
                         run.MeanSquaredError("h2_late"));
         }},
        {"mean squared error, h3", 1e-2, worst.unseen_start,
         [](const CaseRun& run) { return run.MeanSquaredError("h3"); }},
    };
  }
  ADD_FAILURE() << "no figures of " << scheme;
  return {};
}

std::vector<CaseFigure> GroupFigures() {
  return {
      {"k2-k4 and c2-c4, worst relative error", 1e-3, 1.3e-4,
       [](const CaseRun& run) {
         return WorstGroup(run, {"k2", "k3", "k4", "c2", "c3", "c4"});
       }},
      // Beside the network.
      {"k1 and c1, worst relative error", 1e-2, 5.3e-4,
       [](const CaseRun& run) {
         return WorstGroup(run, {"k1", "c1"});
       }},
      {"mean squared error, h3", 1e-5, 1.5e-6,
       [](const CaseRun& run) { return run.MeanSquaredError("h3"); }},
  };
}

std::vector<CaseFigure> ForcedFigures() {
  struct Line {
    const char* record;
    const char* channel;
    double asked;
    double worst;
  };
  constexpr Line kLines[] = {
      {"wn_holdout", "x1", 0.005, 1.2e-3},
      {"wn_holdout", "v1", 0.005, 9.7e-4},
      {"wn_holdout", "a1", 0.005, 7.0e-4},
      {"quake_holdout", "x1", 0.007, 1.3e-3},
      {"quake_holdout", "v1", 0.007, 1.2e-3},
      {"quake_holdout", "a1", 0.007, 1.3e-3},
  };
  std::vector<CaseFigure> figures;
  for (const Line& line : kLines) {
    figures.push_back(
        {std::string("nrmse, ") + line.record + ", " + line.channel, line.asked,
         line.worst, [line](const CaseRun& run) {
           return run.Nrmse(line.record, line.channel);
         }});
  }
  return figures;
}

void ExpectFigures(const std::string& what,
                   const std::vector<CaseFigure>& figures, const CaseRun& run) {
  EXPECT_TRUE(run.summary.usable()) << run.summary.message;
  for (const CaseFigure& figure : figures) {
    ExpectFigure(what + ": " + figure.name, figure.asked, figure.held(),
                 figure.measure(run));
  }
}

}  // namespace testing
}  // namespace pinode
