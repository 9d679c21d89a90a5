#include "pinode/problem/measured_mode.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"
#include "pinode/base/statistics.h"
#include "pinode/problem/close_modes.h"
#include "pinode/structure/model/assignment.h"
#include "pinode/structure/model/modal_analysis.h"

namespace pinode {
namespace {

// Cost of a factor of e between frequencies, where a MAC of one counts 1.
constexpr double kFrequencyShare = 0.5;
// Lower limit of the model's frequency relative to the measured one, and the
// reciprocal of the upper one: modes of
// zero or negative stiffness are chosen last.
constexpr double kLowestRatio = 1e-3;
// Maximum number of rounds of pairing and finding the common factor.
constexpr int kMostRounds = 10;

// True for a covariance matrix, or an empty one.
bool IsCovariance(const Matrix& matrix, Eigen::Index size) {
  if (matrix.size() == 0) return true;
  return matrix.rows() == size && matrix.cols() == size && matrix.allFinite() &&
         (matrix - matrix.transpose()).cwiseAbs().maxCoeff() <=
             1e-6 * matrix.cwiseAbs().maxCoeff() &&
         Eigen::LLT<Matrix>(matrix).info() == Eigen::Success;
}

// Measured modes (rows) compared with those of a model (columns).
struct Likeness {
  Matrix macs;       // 1 without a shape
  Matrix distances;  // logarithms of model's over measured frequencies

  Matrix Profit(double stretch) const {
    return macs.array() -
           kFrequencyShare * (distances.array() - stretch).square();
  }
};

Likeness Compare(const ModalData& data, const Vector& eigenvalues,
                 const Matrix& shapes) {
  const auto measured = static_cast<Eigen::Index>(data.modes.size());
  const Eigen::Index count = eigenvalues.size();
  Likeness likeness{Matrix(measured, count), Matrix(measured, count)};
  for (Eigen::Index i = 0; i < measured; ++i) {
    const MeasuredMode& mode = data.modes[static_cast<size_t>(i)];
    const double w = kTwoPi * mode.frequency;
    for (Eigen::Index j = 0; j < count; ++j) {
      likeness.macs(i, j) =
          mode.HasShape() ? Mac(mode.shape, shapes(mode.dofs, j)) : 1.0;
      const double ratio = std::sqrt(std::max(eigenvalues[j], 0.0)) / w;
      likeness.distances(i, j) =
          std::log(std::clamp(ratio, kLowestRatio, 1.0 / kLowestRatio));
    }
  }
  for (const std::vector<int>& set : CloseModes(data)) {
    const std::vector<int>& dofs =
        data.modes[static_cast<size_t>(set.front())].dofs;
    const Matrix span = UnitShapes(data, set);
    Vector macs(count);
    for (Eigen::Index j = 0; j < count; ++j) {
      macs[j] = MacWithSpan(span, shapes(dofs, j));
    }
    // Fewer modes of the model than of the set: one of the set may be noise,
    // which must not take the partner of another.
    if ((macs.array() > kLeastPairProfit).count() <
        static_cast<Eigen::Index>(set.size())) {
      continue;
    }
    for (const int i : set) likeness.macs.row(i) = macs.transpose();
  }
  return likeness;
}

// Returns an empty text if the covariance of frequency and shape fits the
// spread of both.
std::string WhyNoFrequencyShapeCovariance(const MeasuredMode& mode) {
  const Vector& shared = mode.frequency_shape_covariance;
  if (shared.size() == 0) return "";
  if (!(mode.frequency_sigma > 0.0) || mode.shape_covariance.size() == 0) {
    return "the covariance of frequency and shape needs the sigma of the "
           "frequency and the covariance of the shape";
  }
  if (shared.size() != mode.shape.size() || !shared.allFinite()) {
    return "the covariance of frequency and shape needs one finite value per "
           "entry of the shape";
  }
  const Vector share = shared / mode.frequency_sigma;
  if (!IsCovariance(mode.shape_covariance - share * share.transpose(),
                    mode.shape.size())) {
    return "the covariance of frequency and shape is too large: with their own "
           "it must be positive definite";
  }
  return "";
}

}  // namespace

const char* ModalFormName(ModalForm form) {
  switch (form) {
    case ModalForm::kMac:
      return "mac";
    case ModalForm::kEigenvectorDifference:
      return "eigenvector_difference";
    case ModalForm::kDynamicResidual:
      return "dynamic_residual";
  }
  return "";
}

bool ModalData::HasSigmas() const {
  return std::any_of(modes.begin(), modes.end(), [](const MeasuredMode& mode) {
    return mode.frequency_sigma > 0.0 || mode.HasShapeSigma();
  });
}

bool ModalData::HasSigmasOfAll() const {
  return std::all_of(modes.begin(), modes.end(), [](const MeasuredMode& mode) {
    return mode.frequency_sigma > 0.0 &&
           (!mode.HasShape() || mode.HasShapeSigma());
  });
}

bool ModalData::IsValid(int num_dofs, std::string* error) const {
  const bool dynamic = form == ModalForm::kDynamicResidual;
  for (const MeasuredMode& mode : modes) {
    const std::string where = "mode '" + mode.name + "': ";
    const auto positive = [](double value) {
      return value > 0.0 && std::isfinite(value);
    };
    if (!positive(mode.frequency)) {
      *error = where + "its frequency must be positive";
      return false;
    }
    if (!positive(mode.frequency_weight) || !positive(mode.shape_weight) ||
        !positive(mode.residual_weight)) {
      *error = where + "weights must be positive";
      return false;
    }
    if (!(mode.frequency_sigma >= 0.0) || !(mode.shape_sigma >= 0.0) ||
        std::isinf(mode.frequency_sigma) || std::isinf(mode.shape_sigma)) {
      *error = where + "standard deviations must not be negative";
      return false;
    }
    if (dynamic && mode.frequency_sigma > 0.0) {
      *error = where + "the dynamic residual needs a weight and no sigma";
      return false;
    }
    if (form != ModalForm::kEigenvectorDifference && mode.HasShapeSigma()) {
      *error = where + "the sigma of a shape needs the eigenvector difference";
      return false;
    }
    if (mode.shape.size() != static_cast<Eigen::Index>(mode.dofs.size()) ||
        !mode.shape.allFinite()) {
      *error = where + "its shape needs one finite value per DOF";
      return false;
    }
    if (!mode.HasShape()) {
      if (!dynamic) continue;
      *error = where + "the dynamic residual needs its shape";
      return false;
    }
    std::vector<int> dofs = mode.dofs;
    std::sort(dofs.begin(), dofs.end());
    if (dofs.front() < 0 || dofs.back() >= num_dofs) {
      *error = where + "its shape has a DOF that the model does not have";
      return false;
    }
    if (std::adjacent_find(dofs.begin(), dofs.end()) != dofs.end()) {
      *error = where + "its shape names a DOF twice";
      return false;
    }
    if (mode.shape.isZero(0.0)) {
      *error = where + "its shape is zero";
      return false;
    }
    if (!IsCovariance(mode.shape_covariance, mode.shape.size())) {
      *error = where +
               "the covariance of its shape must be symmetric and positive "
               "definite, with a row and a column for each entry";
      return false;
    }
    const std::string shared = WhyNoFrequencyShapeCovariance(mode);
    if (!shared.empty()) {
      *error = where + shared;
      return false;
    }
    if (!dynamic && dofs.size() < 2) {
      *error = where + "a shape needs at least two DOFs; leave this one out";
      return false;
    }
  }
  return true;
}

std::vector<bool> HavePartners(const ModalData& data, const Vector& eigenvalues,
                               const Matrix& shapes) {
  const Likeness likeness = Compare(data, eigenvalues, shapes);
  const Eigen::Index measured = likeness.macs.rows();
  const Eigen::Index count = likeness.macs.cols();
  // One more column for each mode that stays alone.
  Matrix profit =
      Matrix::Constant(measured, count + measured, kLeastPairProfit);
  double stretch = 0.0;
  std::vector<int> partners;
  for (int round = 0; round < kMostRounds; ++round) {
    profit.leftCols(count) = likeness.Profit(stretch);
    const std::vector<int> before = std::move(partners);
    partners = MaximumProfitAssignment(profit);
    std::vector<double> distances;
    for (Eigen::Index i = 0; i < measured; ++i) {
      const int j = partners[static_cast<size_t>(i)];
      if (j < count) distances.push_back(likeness.distances(i, j));
    }
    if (distances.empty() || partners == before) break;
    stretch = Median(std::move(distances));
  }
  std::vector<bool> have(data.modes.size());
  std::transform(partners.begin(), partners.end(), have.begin(),
                 [count](int partner) { return partner < count; });
  if (std::find(have.begin(), have.end(), true) == have.end()) {
    partners = MaximumProfitAssignment(likeness.Profit(0.0));
    std::transform(partners.begin(), partners.end(), have.begin(),
                   [](int partner) { return partner >= 0; });
  }
  return have;
}

std::vector<bool> HavePartners(const ModalData& data,
                               const StructuralModel& model) {
  UndampedModes modes;
  std::string ignored;
  if (!ComputeUndampedModes(model.mass, model.stiffness, &modes, &ignored)) {
    std::vector<bool> first(data.modes.size(), false);
    const auto most = static_cast<size_t>(model.num_dofs());
    std::fill_n(first.begin(), std::min(first.size(), most), true);
    return first;
  }
  return HavePartners(data, modes.eigenvalues, modes.shapes);
}

ModalData OnlyModes(const ModalData& data, const std::vector<bool>& kept) {
  ModalData result = data;
  result.modes.clear();
  for (size_t i = 0; i < data.modes.size(); ++i) {
    if (kept[i]) result.modes.push_back(data.modes[i]);
  }
  return result;
}

std::vector<ModeMatch> MatchModes(const ModalData& data,
                                  const Vector& eigenvalues,
                                  const Matrix& shapes) {
  const int measured = static_cast<int>(data.modes.size());
  CHECK_LE(measured, eigenvalues.size())
      << "a measured mode would have no partner";
  const Likeness likeness = Compare(data, eigenvalues, shapes);
  const Matrix& macs = likeness.macs;
  const std::vector<int> partners =
      MaximumProfitAssignment(likeness.Profit(0.0));
  std::vector<ModeMatch> matches(data.modes.size());
  for (int i = 0; i < measured; ++i) {
    ModeMatch& match = matches[static_cast<size_t>(i)];
    match.mode = partners[static_cast<size_t>(i)];
    const double eigenvalue = eigenvalues[match.mode];
    match.frequency = eigenvalue < 0.0 ? kNaN : std::sqrt(eigenvalue) / kTwoPi;
    match.mac = data.modes[static_cast<size_t>(i)].HasShape()
                    ? macs(i, match.mode)
                    : kNaN;
  }
  for (const std::vector<int>& set : CloseModes(data)) {
    std::vector<int> found;
    for (const int i : set) found.push_back(partners[static_cast<size_t>(i)]);
    for (const int i : set) {
      const MeasuredMode& mode = data.modes[static_cast<size_t>(i)];
      matches[static_cast<size_t>(i)].mac =
          MacWithSpan(shapes(mode.dofs, found), mode.shape);
    }
  }
  return matches;
}

bool MatchModes(const ModalData& data, const StructuralModel& model,
                std::vector<ModeMatch>* matches, std::string* error) {
  UndampedModes modes;
  if (!ComputeUndampedModes(model.mass, model.stiffness, &modes, error)) {
    return false;
  }
  *matches = MatchModes(data, modes.eigenvalues, modes.shapes);
  return true;
}

}  // namespace pinode
