#include "pinode/modal/resolve_dofs.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <complex>
#include <set>

#include "pinode/base/types.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;

// Largest part of a DOF outside the space that the sensors span.
constexpr double kOutside = 1e-6;

// Transforms entries at the old places to those at the new.
struct DofTransform {
  std::vector<PlaceOfShape> places;
  std::vector<Eigen::RowVectorXd> rows;
};

class DofResolver {
 public:
  DofResolver(const std::vector<PlaceOfShape>& known,
              const std::vector<std::string>& names)
      : count_(static_cast<Eigen::Index>(names.size())) {
    for (const std::string& name : names) {
      const auto own = std::find_if(
          known.begin(), known.end(),
          [&name](const PlaceOfShape& p) { return p.place == name; });
      places_.push_back(own != known.end() ? *own
                                           : PlaceOfShape{name, name, {}});
    }
  }

  DofTransform Resolve() {
    std::vector<bool> done(places_.size(), false);
    for (size_t p = 0; p < places_.size(); ++p) {
      if (done[p]) continue;
      const std::vector<size_t> together = TogetherWith(p);
      for (const size_t q : together) done[q] = true;
      const bool sums =
          std::any_of(together.begin(), together.end(),
                      [this](size_t q) { return places_[q].dofs.size() > 1; });
      if (sums) {
        ResolveTogether(together);
      } else {
        for (const size_t q : together) Keep(q);
      }
    }
    return std::move(result_);
  }

 private:
  // Returns the places that share DOFs with `first`, directly or through
  // others.
  std::vector<size_t> TogetherWith(size_t first) const {
    std::set<size_t> found = {first};
    std::set<std::string> dofs;
    for (size_t before = 0; before != found.size();) {
      before = found.size();
      for (const size_t p : found) {
        for (const auto& [dof, weight] : places_[p].dofs) {
          if (weight != 0.0) dofs.insert(dof);
        }
      }
      for (size_t p = 0; p < places_.size(); ++p) {
        for (const auto& entry : places_[p].dofs) {
          if (dofs.count(entry.first) > 0) found.insert(p);
        }
      }
    }
    return {found.begin(), found.end()};
  }

  void Keep(size_t place) {
    result_.places.push_back(places_[place]);
    result_.rows.push_back(
        Eigen::RowVectorXd::Unit(count_, static_cast<Eigen::Index>(place)));
  }

  void ResolveTogether(const std::vector<size_t>& together) {
    std::vector<std::string> dofs;
    for (const size_t p : together) {
      for (const auto& entry : places_[p].dofs) {
        if (std::find(dofs.begin(), dofs.end(), entry.first) == dofs.end()) {
          dofs.push_back(entry.first);
        }
      }
    }
    std::sort(dofs.begin(), dofs.end());
    Matrix sums = Matrix::Zero(static_cast<Eigen::Index>(together.size()),
                               static_cast<Eigen::Index>(dofs.size()));
    for (size_t i = 0; i < together.size(); ++i) {
      for (const auto& [dof, weight] : places_[together[i]].dofs) {
        const auto at = std::find(dofs.begin(), dofs.end(), dof);
        sums(static_cast<Eigen::Index>(i), at - dofs.begin()) = weight;
      }
    }
    const Matrix inverse =
        Eigen::CompleteOrthogonalDecomposition<Matrix>(sums).pseudoInverse();
    const Matrix seen = inverse * sums;  // projection on what they span
    std::vector<bool> resolved(dofs.size(), false);
    for (size_t d = 0; d < dofs.size(); ++d) {
      const auto column = static_cast<Eigen::Index>(d);
      const Vector unit = Vector::Unit(seen.rows(), column);
      if ((seen.col(column) - unit).norm() > kOutside) continue;
      resolved[d] = true;
      Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(count_);
      for (size_t i = 0; i < together.size(); ++i) {
        row[static_cast<Eigen::Index>(together[i])] =
            inverse(column, static_cast<Eigen::Index>(i));
      }
      result_.places.push_back({dofs[d], dofs[d], {{dofs[d], 1.0}}});
      result_.rows.push_back(std::move(row));
    }
    for (const size_t p : together) {
      for (const auto& entry : places_[p].dofs) {
        const auto at = std::find(dofs.begin(), dofs.end(), entry.first);
        if (resolved[static_cast<size_t>(at - dofs.begin())]) continue;
        Keep(p);
        break;
      }
    }
  }

  const Eigen::Index count_;
  std::vector<PlaceOfShape> places_;
  DofTransform result_;
};

// Returns A x for the existing entries. NaN if an entry that takes part is
// missing.
Matrix ApplyWhereSeen(const Matrix& a, const Matrix& x) {
  Matrix result = Matrix::Zero(a.rows(), x.cols());
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    for (Eigen::Index j = 0; j < a.cols(); ++j) {
      if (a(i, j) != 0.0) result.row(i) += a(i, j) * x.row(j);
    }
  }
  return result;
}

void TransformMode(const Matrix& t, IdentifiedMode* mode) {
  const Eigen::Index before = t.cols();
  const Eigen::Index after = t.rows();
  Matrix parts(before, 2);
  parts << mode->shape.real(), mode->shape.imag();
  const Matrix moved = ApplyWhereSeen(t, parts);
  Eigen::Index largest = -1;
  double size = 0.0;
  for (Eigen::Index i = 0; i < after; ++i) {
    const double next = moved.row(i).norm();
    if (next > size) {
      size = next;
      largest = i;
    }
  }
  if (largest < 0) return;
  const Complex scale(moved(largest, 0), moved(largest, 1));
  mode->shape.resize(after);
  for (Eigen::Index i = 0; i < after; ++i) {
    mode->shape[i] = Complex(moved(i, 0), moved(i, 1)) / scale;
  }
  mode->shape[largest] = 1.0;
  // d (u_i / u_l) = (d u_i - shape_i d u_l) / u_l, of real and imaginary parts.
  Matrix slopes = Matrix::Zero(2 + 2 * after, 2 + 2 * before);
  slopes.topLeftCorner(2, 2).setIdentity();
  for (Eigen::Index i = 0; i < after; ++i) {
    for (Eigen::Index j = 0; j < before; ++j) {
      Complex slope = t(i, j);
      if (t(largest, j) != 0.0) slope -= mode->shape[i] * t(largest, j);
      if (i == largest) slope = 0.0;
      slope /= scale;
      if (slope == 0.0) continue;
      slopes(2 + i, 2 + j) = slope.real();
      slopes(2 + i, 2 + before + j) = -slope.imag();
      slopes(2 + after + i, 2 + j) = slope.imag();
      slopes(2 + after + i, 2 + before + j) = slope.real();
    }
  }
  mode->covariance =
      ApplyWhereSeen(slopes,
                     ApplyWhereSeen(slopes, mode->covariance).transpose())
          .transpose();
  const Vector sigmas = mode->covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  mode->shape_sigma_real = sigmas.segment(2, after);
  mode->shape_sigma_imaginary = sigmas.tail(after);
}

}  // namespace

void ResolveDofs(std::vector<PlaceOfShape>* places, MergedModes* merged) {
  DofTransform transform = DofResolver(*places, merged->places).Resolve();
  *places = transform.places;
  const bool any = std::any_of(
      transform.places.begin(), transform.places.end(),
      [merged](const PlaceOfShape& p) {
        return std::find(merged->places.begin(), merged->places.end(),
                         p.place) == merged->places.end();
      });
  // Only directly measured DOFs remain.
  if (!any && transform.places.size() == merged->places.size()) return;
  Matrix t(static_cast<Eigen::Index>(transform.rows.size()),
           static_cast<Eigen::Index>(merged->places.size()));
  for (size_t i = 0; i < transform.rows.size(); ++i) {
    t.row(static_cast<Eigen::Index>(i)) = transform.rows[i];
  }
  for (MergedMode& mode : merged->modes) TransformMode(t, &mode.mode);
  merged->places.clear();
  for (const PlaceOfShape& place : *places) {
    merged->places.push_back(place.place);
  }
}

}  // namespace pinode
