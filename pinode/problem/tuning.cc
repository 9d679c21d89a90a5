#include "pinode/problem/tuning.h"

#include <algorithm>
#include <cmath>

namespace pinode {

double TuningField::Get() const {
  return std::visit(
      [](const auto* number) { return static_cast<double>(*number); }, value);
}

void TuningField::Set(double number) const {
  if (double* const* real = std::get_if<double*>(&value)) {
    **real = number;
  } else {
    *std::get<int*>(value) = std::max(1, static_cast<int>(std::lround(number)));
  }
}

std::vector<TuningField> TuningFields(Tuning* tuning) {
  return {
      {"stages.least_first_samples", &tuning->stages.least_first_samples},
      {"stages.most_first_share", &tuning->stages.most_first_share},
      {"stages.network_divisor", &tuning->stages.network_divisor},
      {"stages.growth", &tuning->stages.growth},
      {"stages.first_gap_penalty", &tuning->stages.first_gap_penalty},
      {"stages.worse_share", &tuning->stages.worse_share},
      {"starts.tolerance", &tuning->starts.tolerance},
      {"starts.change_tolerance", &tuning->starts.change_tolerance},
      {"starts.max_iterations", &tuning->starts.max_iterations},
      {"starts.hopeless_iterations", &tuning->starts.hopeless_iterations},
      {"starts.hopeless_cost", &tuning->starts.hopeless_cost},
      {"starts.hopeless_promises", &tuning->starts.hopeless_promises},
      {"starts.prior_precision", &tuning->starts.prior_precision},
      {"gaps.closed", &tuning->gaps.closed},
      {"gaps.first_firmness", &tuning->gaps.first_firmness},
      {"gaps.first_network_firmness", &tuning->gaps.first_network_firmness},
      {"gaps.growth", &tuning->gaps.growth},
      {"gaps.most_firmness", &tuning->gaps.most_firmness},
      {"gaps.nearly_closed", &tuning->gaps.nearly_closed},
      {"solve.max_rounds", &tuning->solve.max_rounds},
      {"solve.diverged", &tuning->solve.diverged},
      {"solve.round_iterations", &tuning->solve.round_iterations},
      {"solve.network_round_iterations",
       &tuning->solve.network_round_iterations},
      {"solve.round_tolerance", &tuning->solve.round_tolerance},
      {"solve.network_crawl", &tuning->solve.network_crawl},
      {"solve.crawling_steps", &tuning->solve.crawling_steps},
      {"solve.first_radius", &tuning->solve.first_radius},
      {"solve.first_network_radius", &tuning->solve.first_network_radius},
      {"solve.least_radius", &tuning->solve.least_radius},
      {"solve.most_radius", &tuning->solve.most_radius},
      {"solve.uphill_steps", &tuning->solve.uphill_steps},
      {"solve.smallest_change", &tuning->solve.smallest_change},
      {"solve.smallest_residual", &tuning->solve.smallest_residual},
      {"solve.most_network_tolerance", &tuning->solve.most_network_tolerance},
      {"solve.fine_network_iterations", &tuning->solve.fine_network_iterations},
      {"noise.first_share", &tuning->noise.first_share},
      {"noise.smallest", &tuning->noise.smallest},
      {"noise.smallest_misfit", &tuning->noise.smallest_misfit},
      {"noise.shrink", &tuning->noise.shrink},
      {"noise.network_step_down", &tuning->noise.network_step_down},
      {"noise.growth", &tuning->noise.growth},
      {"noise.least_share_left", &tuning->noise.least_share_left},
      {"noise.least_channel_left", &tuning->noise.least_channel_left},
      {"noise.followed", &tuning->noise.followed},
      {"noise.quiet", &tuning->noise.quiet},
      {"evidence.first_decay", &tuning->evidence.first_decay},
      {"evidence.most_decay", &tuning->evidence.most_decay},
      {"evidence.most_change", &tuning->evidence.most_change},
      {"evidence.least_determined", &tuning->evidence.least_determined},
      {"evidence.least_squares", &tuning->evidence.least_squares},
      {"evidence.rounds", &tuning->evidence.rounds},
      {"evidence.quiet", &tuning->evidence.quiet},
      {"evidence.quiet_rounds", &tuning->evidence.quiet_rounds},
      {"evidence.new_evidence", &tuning->evidence.new_evidence},
      {"evidence.quiet_share", &tuning->evidence.quiet_share},
      {"evidence.quiet_parameters", &tuning->evidence.quiet_parameters},
      {"annealing.noise", &tuning->annealing.noise},
      {"annealing.weights", &tuning->annealing.weights},
      {"annealing.output_decay", &tuning->annealing.output_decay},
      {"annealing.measuring_rounds", &tuning->annealing.measuring_rounds},
      {"force_bands.pooled_samples", &tuning->force_bands.pooled_samples},
      {"multistart.same_cost", &tuning->multistart.same_cost},
      {"multistart.prior_deviations", &tuning->multistart.prior_deviations},
  };
}

}  // namespace pinode
