#include "pinode/study/explanations/block_estimates.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/estimate/certainty/covariance.h"
#include "pinode/estimate/certainty/fitted_cost.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/problem/verdict_limits.h"
#include "pinode/study/explanations/score_test.h"
#include "pinode/study/terms/term_worth.h"

namespace pinode {
namespace {

// Number of blocks of all records together; each record has one at least.
constexpr int kBlocks = 4;
// Fewest samples of a block.
constexpr Eigen::Index kFewestSamples = 100;
// Half width of a 95 % interval in standard deviations.
constexpr double kHalfWidth = 1.96;

// Energy of the predicted motion by sample: the sum of squares over fitted
// channels, each relative to its mean square.
Vector EnergyOf(const IdentificationRecord& record, const Matrix& prediction) {
  Vector energy = Vector::Zero(record.num_samples());
  for (size_t c = 0; c < record.channels.size(); ++c) {
    if (!record.channels[c].fit) continue;
    Vector motion = prediction.row(static_cast<Eigen::Index>(c)).transpose();
    motion.array() -= motion.mean();
    const double mean_square =
        motion.squaredNorm() / static_cast<double>(motion.size());
    if (mean_square > 0.0) energy += motion.cwiseAbs2() / mean_square;
  }
  return energy;
}

// The problem with the samples of `block` alone.
IdentificationProblem OnlyBlock(const IdentificationProblem& problem,
                                const RecordBlock& block) {
  IdentificationProblem result = problem;
  for (size_t r = 0; r < result.records.size(); ++r) {
    IdentificationRecord& record = result.records[r];
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    const bool is_record = static_cast<int>(r) == block.record;
    for (MeasuredChannel& channel : record.channels) {
      Vector& values = channel.values;
      const Eigen::Index begin = is_record ? block.begin : values.size();
      const Eigen::Index end = is_record ? block.end : values.size();
      values.head(begin).setConstant(kNaN);
      values.tail(values.size() - end).setConstant(kNaN);
    }
  }
  return result;
}

// Contradiction between a block and the estimate of an unknown: the shift in
// standard deviations of the difference, 0 where it is of no account.
double Contradiction(const BlockEstimates& estimates,
                     const BlockEstimate& block, Eigen::Index j,
                     const ParameterEstimate& own) {
  const double shift = std::abs(block.shifts[j]);
  const bool is_factor = own.unit.empty() || own.unit == "1";
  const double least =
      limits::kBlockShare * (is_factor ? 1.0 : std::abs(own.value));
  if (!(shift > std::max(own.half_width95, least))) return 0.0;
  const double variance =
      std::pow(block.deviations[j], 2) - std::pow(estimates.deviations[j], 2);
  // A block that has nearly all of the information cannot contradict it.
  if (!(variance > 0.01 * std::pow(block.deviations[j], 2))) return 0.0;
  return shift / std::sqrt(variance);
}

// Mean over blocks of an unknown's shift, and half the width of its 95 %
// interval.
struct BlockMean {
  double shift = 0.0;
  double half_width = 0.0;
};

// Returns the mean of unknown `j` if its value differs from block to block
// beyond the deviations of the blocks: a random effect of the blocks, with its
// variance by the method of moments (R. DerSimonian and N. Laird, Control.
// Clin. Trials 7 (1986) 177-188), and Student's t of as many degrees as blocks
// but one. Zeros without such differences.
BlockMean MeanOverBlocks(const BlockEstimates& estimates, Eigen::Index j) {
  double weights = 0.0, squares = 0.0, mean = 0.0;
  for (const BlockEstimate& block : estimates.blocks) {
    const double weight = 1.0 / std::pow(block.deviations[j], 2);
    if (!std::isfinite(weight)) return {};
    weights += weight;
    squares += weight * weight;
    mean += weight * block.shifts[j];
  }
  if (estimates.blocks.size() < 2 || !(weights > 0.0)) return {};
  mean /= weights;
  double scatter = 0.0;
  for (const BlockEstimate& block : estimates.blocks) {
    scatter += std::pow((block.shifts[j] - mean) / block.deviations[j], 2);
  }
  const double degrees = static_cast<double>(estimates.blocks.size()) - 1.0;
  const double between = (scatter - degrees) / (weights - squares / weights);
  if (!(between > 0.0)) return {};
  BlockMean result;
  double information = 0.0;
  for (const BlockEstimate& block : estimates.blocks) {
    const double weight = 1.0 / (std::pow(block.deviations[j], 2) + between);
    information += weight;
    result.shift += weight * block.shifts[j];
  }
  result.shift /= information;
  result.half_width = StudentQuantile(degrees) / std::sqrt(information);
  return result;
}

}  // namespace

std::vector<RecordBlock> CutIntoBlocks(const IdentificationProblem& problem,
                                       const FitSummary& fit) {
  std::vector<RecordBlock> blocks;
  const int num_records = problem.num_train_records();
  const int per_record = (kBlocks + num_records - 1) / std::max(1, num_records);
  for (size_t r = 0; r < problem.records.size(); ++r) {
    const IdentificationRecord& record = problem.records[r];
    const Eigen::Index n = record.num_samples();
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    if (r >= fit.records.size() || fit.records[r].prediction.cols() != n ||
        n < per_record * kFewestSamples) {
      return {};
    }
    const Vector energy = EnergyOf(record, fit.records[r].prediction);
    const double all = energy.sum();
    if (!(all > 0.0) || !std::isfinite(all)) return {};
    RecordBlock block;
    block.record = static_cast<int>(r);
    double sum = 0.0;
    double own = 0.0;
    int cuts = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
      sum += energy[i];
      own += energy[i];
      block.end = i + 1;
      const bool is_full =
          sum >= all * (cuts + 1) / per_record &&
          block.end - block.begin >= kFewestSamples &&
          n - block.end >= (per_record - 1 - cuts) * kFewestSamples;
      if (i + 1 < n && (!is_full || cuts + 1 >= per_record)) continue;
      const double share = own / all * static_cast<double>(n) /
                           static_cast<double>(block.end - block.begin);
      block.level = std::sqrt(share);
      blocks.push_back(block);
      block.begin = block.end;
      own = 0.0;
      ++cuts;
    }
  }
  return blocks.size() >= 2 ? blocks : std::vector<RecordBlock>();
}

bool EstimateBlocks(const IdentificationProblem& problem, const FitSummary& fit,
                    const IdentifiedModel& model, int num_threads,
                    BlockEstimates* estimates) {
  *estimates = BlockEstimates();
  const std::vector<RecordBlock> blocks = CutIntoBlocks(problem, fit);
  if (blocks.empty()) return true;
  const ParameterLayout layout(problem);
  CondensedSystem whole;
  if (!LinearizeAtFit(problem, layout, model, fit.records, num_threads,
                      &whole)) {
    return false;
  }
  const double noise = std::sqrt(NoiseShareOfTraining(fit));
  const auto step = [&](const CondensedSystem& system, Vector* shifts,
                        Vector* deviations) {
    Matrix root, null_space;
    if (!InvertInformation(system.hessian, &root, &null_space)) {
      return false;
    }
    *shifts = -(root * (root.transpose() * system.gradient));
    *deviations = noise * root.rowwise().norm();
    return shifts->allFinite();
  };
  Vector unused;
  if (!step(whole, &unused, &estimates->deviations)) return false;
  for (const RecordBlock& block : blocks) {
    BlockEstimate estimate;
    estimate.block = block;
    CondensedSystem system;
    if (!LinearizeAtFit(OnlyBlock(problem, block), layout, model, fit.records,
                        num_threads, &system) ||
        !step(system, &estimate.shifts, &estimate.deviations)) {
      return false;
    }
    estimates->blocks.push_back(std::move(estimate));
  }
  return true;
}

void WidenByBlocks(const BlockEstimates& estimates, const FitSummary& fit,
                   const IdentificationProblem& problem,
                   std::vector<ExplainedValue>* intervals) {
  const ParameterLayout layout(problem);
  for (ExplainedValue& interval : *intervals) {
    const int j = layout.FreeIndex(interval.name);
    const ParameterEstimate* own = FindEstimate(fit, interval.name);
    if (j < 0 || own == nullptr) continue;
    // The reported value lies in the interval, and so does the mean.
    const BlockMean mean = MeanOverBlocks(estimates, j);
    interval.lower95 =
        std::min(interval.lower95,
                 own->value + std::min(mean.shift, 0.0) - mean.half_width);
    interval.upper95 =
        std::max(interval.upper95,
                 own->value + std::max(mean.shift, 0.0) + mean.half_width);
    for (const BlockEstimate& estimate : estimates.blocks) {
      const double half = kHalfWidth * estimate.deviations[j];
      const double value = own->value + estimate.shifts[j];
      interval.lower95 = std::min(interval.lower95, value + half);
      interval.upper95 = std::max(interval.upper95, value - half);
    }
  }
}

std::vector<Finding> CheckBlocks(const BlockEstimates& estimates,
                                 const FitSummary& fit,
                                 const IdentificationProblem& problem) {
  const ParameterLayout layout(problem);
  double most = limits::kBlockDeviations;
  const BlockEstimate* found = nullptr;
  const ParameterEstimate* moved = nullptr;
  double shift = 0.0;
  for (const ParameterEstimate& own : fit.parameters) {
    const int j = layout.FreeIndex(own.name);
    if (j < 0 || !own.free || own.at_bound) continue;
    for (const BlockEstimate& block : estimates.blocks) {
      const double size = Contradiction(estimates, block, j, own);
      if (!(size > most)) continue;
      most = size;
      found = &block;
      moved = &own;
      shift = block.shifts[j];
    }
  }
  if (found == nullptr) return {};
  const IdentificationRecord& record =
      problem.records[static_cast<size_t>(found->block.record)];
  const auto time = [&record](Eigen::Index sample) {
    return FormatNumber(static_cast<double>(sample) * record.sampling_step(),
                        3);
  };
  return {{"block_contradicts",
           "the part of record '" + record.name + "' from " +
               time(found->block.begin) + " to " + time(found->block.end) +
               " s alone would change '" + moved->name + "' from " +
               FormatNumber(moved->value, 3) + " to about " +
               FormatNumber(moved->value + shift, 3) + " (" +
               FormatNumber(most, 2) +
               " standard deviations). The motion there is " +
               FormatNumber(found->block.level, 2) +
               " times that of the whole record",
           most, limits::kBlockDeviations,
           "find what changes with time or with the level of motion",
           Grade::kWithCare}};
}

}  // namespace pinode
