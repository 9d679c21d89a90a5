#include "pinode/estimate/shooting/residual_statistics.h"

namespace pinode {

bool WeightedResiduals(const Vector& free, bool with_jacobian,
                       MultipleShooting* shooting,
                       std::vector<Matrix>* residuals,
                       std::vector<Matrix>* jacobians) {
  residuals->clear();
  if (with_jacobian) jacobians->clear();
  const int num_free = shooting->sweep().layout().num_free();
  for (size_t r = 0; r < shooting->train_records().size(); ++r) {
    const int nc = shooting->record(r).observation().num_channels();
    const Eigen::Index samples = shooting->record(r).grid().num_samples();
    residuals->push_back(Matrix::Zero(nc, samples));
    if (!with_jacobian) continue;
    jacobians->push_back(Matrix::Zero(nc * samples, num_free));
  }
  return shooting->VisitWeightedResiduals(
      free, with_jacobian,
      [&](size_t r, Eigen::Index first, const Matrix& part,
          const Matrix& rows) {
        (*residuals)[r].middleCols(first, part.cols()) = part;
        if (!with_jacobian) return;
        (*jacobians)[r].middleRows(first * part.rows(), part.size()) = rows;
      },
      shooting->sweep().options().num_threads);
}

Matrix ResidualInformation(const MultipleShooting& shooting) {
  const SegmentSweep& sweep = shooting.sweep();
  Matrix information = sweep.sum().hessian.selfadjointView<Eigen::Lower>();
  const int ns = sweep.problem().dynamics->num_states();
  for (size_t r = 0; r < shooting.train_records().size(); ++r) {
    const ShootingRecord& record = shooting.record(r);
    if (!record.HasFreeStarts()) continue;
    for (int k = 0; k < record.num_segments(); ++k) {
      // Starts go along with the parameters.
      const auto follow = record.equations().start_sensitivity().middleRows(
          static_cast<Eigen::Index>(k) * ns, ns);
      const SegmentResult& result = record.results().of(k);
      const Matrix mixed = result.cross * follow;
      information += mixed + mixed.transpose() +
                     follow.transpose() * result.start_hessian * follow;
    }
  }
  return information;
}

bool MovedResiduals(const MultipleShooting& shooting, const Vector& free,
                    const Vector& step, std::vector<Matrix>* residuals) {
  const SegmentSweep& sweep = shooting.sweep();
  ShootingPoint point;
  if (!sweep.PreparePoint(free, &point)) return false;
  residuals->resize(shooting.train_records().size());
  for (size_t r = 0; r < residuals->size(); ++r) {
    if (!sweep.MovedResiduals(point, r, shooting.starts()[r], step,
                              &(*residuals)[r])) {
      return false;
    }
  }
  return true;
}

bool AddScores(const MultipleShooting& shooting, const Vector& free,
               const std::vector<Eigen::Index>& lengths, Matrix* products,
               double* count) {
  const SegmentSweep& sweep = shooting.sweep();
  ShootingPoint point;
  if (!sweep.PreparePoint(free, &point)) return false;
  for (size_t r = 0; r < shooting.train_records().size(); ++r) {
    if (!sweep.AddScores(point, r, shooting.starts()[r], lengths[r], products,
                         count)) {
      return false;
    }
  }
  return true;
}

}  // namespace pinode
