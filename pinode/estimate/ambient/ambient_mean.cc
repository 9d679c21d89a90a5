#include "pinode/estimate/ambient/ambient_mean.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "pinode/base/parallel_for.h"
#include "pinode/record/prepare.h"

namespace pinode {
namespace {

// Derivatives of the response that are kept at a time, in numbers: 256 MiB.
constexpr Eigen::Index kMostNumbers = Eigen::Index{1} << 25;

// A run of what is measured, with nothing to be met.
IdentificationProblem RunOf(const AmbientRecord& record,
                            const StructuralDynamics& dynamics) {
  IdentificationProblem problem;
  // Nobody's to delete.
  problem.dynamics = std::shared_ptr<const StructuralDynamics>(
      std::shared_ptr<const StructuralDynamics>(), &dynamics);
  IdentificationRecord run;
  run.name = record.name;
  run.start = IdentificationRecord::Start::kRest;
  run.excitation = record.inputs;
  run.filter = record.filter;
  run.substeps = 1;
  run.integrator = Integrator::kExact;
  for (const Observation& observation : record.channels) {
    MeasuredChannel channel;
    channel.observation = observation;
    channel.values = Vector::Zero(record.samples.cols());
    channel.sigma = 1.0;
    run.channels.push_back(std::move(channel));
  }
  problem.records.push_back(std::move(run));
  return problem;
}

MultipleShooting::Options OptionsOf(int num_threads) {
  MultipleShooting::Options options;
  options.num_threads = num_threads;
  return options;
}

}  // namespace

AmbientMean::AmbientMean(const AmbientRecord& record,
                         const StructuralDynamics& dynamics,
                         LineTransform transform, const Vector& scales,
                         int num_threads)
    : record_(record),
      transform_(std::move(transform)),
      scales_(scales),
      num_threads_(num_threads),
      alone_(RunOf(record, dynamics)),
      layout_(alone_),
      shooting_(alone_, layout_, OptionsOf(num_threads)),
      measured_(LinesOf(record.samples)) {
  shooting_.SetSigmas({Vector::Ones(scales.size())});
  shooting_.SetStateScales({Vector::Ones(dynamics.num_states())});
  shooting_.SetWholeRecords({Vector::Zero(dynamics.num_states())});
}

Eigen::MatrixXcd AmbientMean::LinesOf(Matrix samples) const {
  for (Eigen::Index c = 0; c < samples.rows(); ++c) {
    Vector values = samples.row(c);
    CopyMissing(record_.samples.row(c), &values);
    samples.row(c) = values / scales_[c];
  }
  return transform_.Values(samples);
}

bool AmbientMean::SetPoint(const Vector& free, std::string* error) {
  Matrix rest = record_.samples;
  const bool runs = shooting_.VisitWeightedResiduals(
      free.head(num_free()), /*with_jacobian=*/false,
      [&](size_t, Eigen::Index first, const Matrix& part, const Matrix&) {
        rest.middleCols(first, part.cols()) =
            record_.samples.middleCols(first, part.cols()) - part;
      },
      num_threads_);
  if (!runs || rest.array().isInf().any()) {
    *error = "the response to the measured loads of record '" + record_.name +
             "' is not finite";
    return false;
  }
  rest_ = LinesOf(std::move(rest));
  return true;
}

bool AmbientMean::SetSlopes(const Vector& free, std::string* error) {
  const Eigen::Index channels = record_.samples.rows();
  const Eigen::Index samples = record_.samples.cols();
  slopes_.resize(channels * num_free(), measured_.cols());
  const int together = static_cast<int>(
      std::max<Eigen::Index>(1, kMostNumbers / (channels * samples)));
  for (int begin = 0; begin < num_free(); begin += together) {
    const int count = std::min(together, num_free() - begin);
    std::vector<Matrix> slopes(static_cast<size_t>(count),
                               Matrix(channels, samples));
    const bool runs = shooting_.VisitWeightedResiduals(
        free.head(num_free()), /*with_jacobian=*/true,
        [&](size_t, Eigen::Index first, const Matrix& part,
            const Matrix& rows) {
          for (int j = 0; j < count; ++j) {
            slopes[static_cast<size_t>(j)].middleCols(first, part.cols()) =
                rows.col(begin + j).reshaped(channels, part.cols());
          }
        },
        num_threads_);
    if (!runs) {
      *error = "derivatives of the response to the measured loads of record '" +
               record_.name + "' are not finite";
      return false;
    }
    ParallelFor(count, num_threads_, [&](int j, int) {
      slopes_.middleRows(channels * (begin + j), channels) =
          LinesOf(std::move(slopes[static_cast<size_t>(j)]));
    });
  }
  return true;
}

}  // namespace pinode
