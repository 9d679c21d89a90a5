#include "pinode/estimate/objective/modal_cost.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"
#include "pinode/base/stable_norm.h"
#include "pinode/estimate/objective/mode_slopes.h"
#include "pinode/problem/close_modes.h"
#include "pinode/structure/model/modal_analysis.h"

namespace pinode {
namespace {

// Returns (2 pi f)^2.
double MeasuredEigenvalue(const MeasuredMode& mode) {
  const double w = kTwoPi * mode.frequency;
  return w * w;
}

// Returns the weight of 1 - w^2 / (2 pi f)^2, to first order 2 (f - f_model) /
// f.
double EigenvalueWeight(const MeasuredMode& mode) {
  return mode.frequency_sigma > 0.0
             ? 0.5 * mode.frequency / mode.frequency_sigma
             : mode.frequency_weight;
}

// Returns the entries other than `largest`, in order.
template <typename Rows>
Matrix WithoutRow(const Rows& rows, int largest) {
  Matrix rest(rows.rows() - 1, rows.cols());
  rest.topRows(largest) = rows.topRows(largest);
  rest.bottomRows(rest.rows() - largest) =
      rows.bottomRows(rest.rows() - largest);
  return rest;
}

// Returns the derivatives of x over its entry `largest`, without that entry.
Matrix RatioSlopes(const Vector& x, const Matrix& slopes, int largest) {
  const Vector scaled = x / x[largest];
  return WithoutRow((slopes - scaled * slopes.row(largest)) / x[largest],
                    largest);
}

// Returns W (1 - c) / c of the model's shape x and the measured y of unit norm.
// It uses the tangent t of the angle between them, 1 / c = sqrt(1 + t^2),
// because 1 - c itself would be lost in rounding.
double MacResidual(const MeasuredMode& mode, const Vector& y, const Vector& x,
                   const Matrix& shape_slopes, RowVector* slopes) {
  const double along = y.dot(x);
  const Vector across = x - along * y;
  const double tangent_square = across.squaredNorm() / (along * along);
  const double secant = std::sqrt(1.0 + tangent_square);
  *slopes = mode.shape_weight / (secant * along * along) *
            (across.transpose() * shape_slopes -
             tangent_square * along * (y.transpose() * shape_slopes));
  return mode.shape_weight * tangent_square / (1.0 + secant);
}

// Returns L^-1 of the entries of a shape over its largest one, given the
// frequency. S is the covariance of these ratios, c that with the frequency, s
// the frequency's deviation. For an error s of the frequency the ratios have
// the mean *by_frequency = c / s and the covariance S - c c' / s^2 = L L'
// around it.
Matrix RatioWeights(const MeasuredMode& mode, Eigen::Index largest,
                    Vector* by_frequency) {
  const Eigen::Index count = mode.shape.size();
  const double scale = mode.shape[largest];
  Matrix slopes = Matrix::Identity(count, count) / scale;
  slopes.col(largest) -= mode.shape / (scale * scale);
  Matrix kept(count - 1, count);
  kept << slopes.topRows(largest), slopes.bottomRows(count - 1 - largest);
  Matrix covariance = kept * mode.shape_covariance * kept.transpose();
  if (mode.frequency_shape_covariance.size() > 0) {
    *by_frequency =
        kept * mode.frequency_shape_covariance / mode.frequency_sigma;
    covariance -= *by_frequency * by_frequency->transpose();
  }
  const Eigen::LLT<Matrix> factor(covariance);
  return factor.matrixL().solve(Matrix::Identity(count - 1, count - 1));
}

}  // namespace

StructuralDynamics AveragedDynamics(const ModalData& data,
                                    const StructuralDynamics& dynamics) {
  return data.inputs.size() == 0 ? dynamics
                                 : dynamics.Averaged({data.inputs, {}});
}

std::vector<bool> ModesInUse(const ModalData& data,
                             const StructuralDynamics& dynamics) {
  std::string error;
  CHECK(data.IsValid(dynamics.num_dofs(), &error)) << error;
  return HavePartners(
      data,
      AveragedDynamics(data, dynamics).CorrectedModel(dynamics.Parameters()));
}

ModalCost::ModalCost(const ModalData& data, const StructuralDynamics& dynamics,
                     const ParameterLayout& layout)
    : dynamics_(AveragedDynamics(data, dynamics)),
      in_use_(ModesInUse(data, dynamics)),
      data_(OnlyModes(data, in_use_)),
      layout_(layout) {
  int num_residuals = 0;
  for (const MatrixChange& change : dynamics_.linear_dynamics().changes()) {
    const auto [free, factor] = layout.DependenceOf(change.parameter);
    if (free < 0 || change.group->target == MatrixGroup::Target::kDamping) {
      continue;
    }
    columns_.push_back(
        {free, factor, change.group->target, &change.group->matrix});
  }
  for (const MeasuredMode& mode : data_.modes) {
    Shape shape;
    const int count = static_cast<int>(mode.dofs.size());
    if (mode.HasShape()) {
      mode.shape.cwiseAbs().maxCoeff(&shape.largest);
      const double scale = mode.shape[shape.largest];
      shape.values = data.form == ModalForm::kMac ? StableUnit(mode.shape)
                                                  : Vector(mode.shape / scale);
      if (data.form == ModalForm::kEigenvectorDifference) {
        shape.weight_root =
            mode.shape_weight * Matrix::Identity(count - 1, count - 1);
        if (mode.shape_sigma > 0.0) {
          // The error of the largest entry is in all others: their errors have
          // the covariance sigma^2 (I + y y'), whose inverse root is a change
          // along y.
          const Vector y = WithoutRow(shape.values, shape.largest);
          const double square = y.squaredNorm();
          shape.weight_root.setIdentity();
          if (square > 0.0) {
            shape.weight_root -= (1.0 - 1.0 / std::sqrt(1.0 + square)) /
                                 square * (y * y.transpose());
          }
          shape.weight_root *= std::abs(scale) / mode.shape_sigma;
        } else if (mode.shape_covariance.size() > 0) {
          shape.weight_root =
              RatioWeights(mode, shape.largest, &shape.by_frequency);
        }
      }
    }
    switch (data.form) {
      case ModalForm::kMac:
        num_residuals += mode.HasShape() ? 2 : 1;
        break;
      case ModalForm::kEigenvectorDifference:
        num_residuals += mode.HasShape() ? count : 1;
        break;
      case ModalForm::kDynamicResidual:
        num_residuals += dynamics.num_dofs();
        for (int i = 0; i < dynamics.num_dofs(); ++i) {
          if (std::find(mode.dofs.begin(), mode.dofs.end(), i) ==
              mode.dofs.end()) {
            shape.unmeasured.push_back(i);
          }
        }
        num_eliminated_ += static_cast<int>(shape.unmeasured.size());
        break;
    }
    shapes_.push_back(std::move(shape));
  }
  AddCloseSets();
  set_num_residuals(num_residuals + static_cast<int>(cross_weights_.size()));
  mutable_parameter_block_sizes()->push_back(layout.num_free());
}

void ModalCost::AddCloseSets() {
  for (const std::vector<int>& modes : CloseModes(data_)) {
    CloseSet set;
    set.modes = modes;
    set.dofs = data_.modes[static_cast<size_t>(modes.front())].dofs;
    set.measured = UnitShapes(data_, modes);
    const Eigen::Index size = set.measured.rows();
    for (size_t a = 0; a < modes.size(); ++a) {
      const MeasuredMode& mode = data_.modes[static_cast<size_t>(modes[a])];
      Shape& shape = shapes_[static_cast<size_t>(modes[a])];
      shape.in_close_set = true;
      Matrix root = Matrix::Identity(size, size);
      if (data_.form == ModalForm::kEigenvectorDifference &&
          mode.shape_covariance.size() > 0) {
        const Eigen::LLT<Matrix> factor(
            Matrix(mode.shape_covariance / mode.shape_covariance.trace()));
        root = factor.matrixL().solve(root);
      }
      set.roots.push_back(std::move(root));
      // The parts of the others in it are unknowns of their own.
      if (data_.form == ModalForm::kEigenvectorDifference) {
        num_eliminated_ += static_cast<int>(modes.size()) - 1;
      }
      for (size_t b = a + 1; b < modes.size(); ++b) {
        const MeasuredMode& other = data_.modes[static_cast<size_t>(modes[b])];
        const double own = MeasuredEigenvalue(mode);
        const double others = MeasuredEigenvalue(other);
        cross_weights_.push_back(
            2.0 / std::sqrt(std::pow(own - others, 2) +
                            std::pow(own / EigenvalueWeight(mode), 2) +
                            std::pow(others / EigenvalueWeight(other), 2)));
      }
    }
    close_sets_.push_back(std::move(set));
  }
}

bool ModalCost::Evaluate(const StructuralDynamics::Prepared& prepared,
                         Vector* residuals, Matrix* jacobian,
                         std::string* error) const {
  residuals->resize(num_residuals());
  if (jacobian != nullptr) {
    *jacobian = Matrix::Zero(num_residuals(), layout_.num_free());
  }
  const bool ok =
      data_.form == ModalForm::kDynamicResidual
          ? EvaluateDynamicResiduals(prepared, residuals, jacobian, error)
          : EvaluateModes(prepared, residuals, jacobian, error);
  if (!ok) return false;
  if (!residuals->allFinite() ||
      (jacobian != nullptr && !jacobian->allFinite())) {
    *error =
        "a shape of the model is orthogonal to the measured one, or zero "
        "where that is largest";
    return false;
  }
  return true;
}

bool ModalCost::EvaluateAt(const Vector& free, Vector* residuals,
                           Matrix* jacobian) const {
  failure_ = "the parameters are not finite";
  if (!free.allFinite()) return false;
  Vector all = layout_.InitialValues();
  layout_.SetFree(free, &all);
  StructuralDynamics::Prepared prepared;
  if (!dynamics_.Prepare(all.head(layout_.num_dynamics()), &prepared,
                         &failure_) ||
      !Evaluate(prepared, residuals, jacobian, &failure_)) {
    return false;
  }
  failure_.clear();
  return true;
}

bool ModalCost::Evaluate(double const* const* parameters, double* residuals,
                         double** jacobians) const {
  const int n = layout_.num_free();
  const bool derive = jacobians != nullptr && jacobians[0] != nullptr;
  Vector values;
  Matrix jacobian;
  if (!EvaluateAt(Eigen::Map<const Vector>(parameters[0], n), &values,
                  derive ? &jacobian : nullptr)) {
    return false;
  }
  Eigen::Map<Vector>(residuals, num_residuals()) = values;
  if (derive) {
    Eigen::Map<
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
        jacobians[0], num_residuals(), n) = jacobian;
  }
  return true;
}

bool ModalCost::Evaluate(const Vector& free, double* cost) {
  Vector residuals;
  if (!EvaluateAt(free, &residuals, nullptr)) return false;
  *cost = 0.5 * residuals.squaredNorm();
  return true;
}

bool ModalCost::Linearize(const Vector& free, CondensedSystem* system) {
  Vector residuals;
  Matrix jacobian;
  if (!EvaluateAt(free, &residuals, &jacobian)) return false;
  system->cost = 0.5 * residuals.squaredNorm();
  system->gradient = jacobian.transpose() * residuals;
  system->hessian = jacobian.transpose() * jacobian;
  return true;
}

// Mode of the model beside a measured one.
struct ModalCost::Partner {
  double eigenvalue = 0.0;
  Vector shape;  // at the measured DOFs
  ModeSlopes slopes;
};

bool ModalCost::FindPartners(const UndampedModes& modes, size_t num_columns,
                             std::vector<Partner>* partners,
                             std::vector<Partner>* cross,
                             std::string* error) const {
  const std::vector<ModeMatch> matches =
      MatchModes(data_, modes.eigenvalues, modes.shapes);
  const auto count = static_cast<Eigen::Index>(num_columns);
  partners->assign(data_.modes.size(), Partner());
  for (const CloseSet& set : close_sets_) {
    if (!FindTogether(set, modes, matches, num_columns, partners, cross,
                      error)) {
      return false;
    }
  }
  for (size_t i = 0; i < data_.modes.size(); ++i) {
    Partner& partner = (*partners)[i];
    if (shapes_[i].in_close_set) continue;
    const MeasuredMode& mode = data_.modes[i];
    const int j = matches[i].mode;
    partner.eigenvalue = modes.eigenvalues[j];
    partner.shape = modes.shapes.col(j)(mode.dofs);
    partner.slopes = {RowVector(count),
                      Matrix(static_cast<int>(mode.dofs.size()), count)};
    for (size_t c = 0; c < num_columns; ++c) {
      if (!DifferentiateMode(modes, j, mode.dofs, *columns_[c].matrix,
                             columns_[c].target == MatrixGroup::Target::kMass,
                             static_cast<int>(c), &partner.slopes, error)) {
        return false;
      }
    }
  }
  return true;
}

// Appends to *cross what the modes of the set share, in the order of its pairs.
bool ModalCost::FindTogether(const CloseSet& set, const UndampedModes& modes,
                             const std::vector<ModeMatch>& matches,
                             size_t num_columns, std::vector<Partner>* partners,
                             std::vector<Partner>* cross,
                             std::string* error) const {
  std::vector<int> found;
  for (const int i : set.modes) {
    found.push_back(matches[static_cast<size_t>(i)].mode);
  }
  SpanComparison span(std::move(found), set.dofs, set.measured, set.roots);
  if (!span.Compute(modes, error)) return false;
  std::vector<SpanComparison::Slopes> slopes(num_columns);
  for (size_t c = 0; c < num_columns; ++c) {
    if (!span.Differentiate(modes, *columns_[c].matrix,
                            columns_[c].target == MatrixGroup::Target::kMass,
                            &slopes[c], error)) {
      return false;
    }
  }
  const auto at = [&](Eigen::Index a, Eigen::Index b) {
    Partner partner;
    partner.eigenvalue = span.squares()(a, b);
    partner.shape = span.nearest().col(a);
    const auto count = static_cast<Eigen::Index>(num_columns);
    partner.slopes = {RowVector(count), Matrix(partner.shape.size(), count)};
    for (Eigen::Index c = 0; c < count; ++c) {
      const SpanComparison::Slopes& own = slopes[static_cast<size_t>(c)];
      partner.slopes.eigenvalue[c] = own.squares(a, b);
      partner.slopes.shape.col(c) = own.nearest.col(a);
    }
    return partner;
  };
  const auto size = static_cast<Eigen::Index>(set.modes.size());
  for (Eigen::Index a = 0; a < size; ++a) {
    (*partners)[static_cast<size_t>(set.modes[static_cast<size_t>(a)])] =
        at(a, a);
    for (Eigen::Index b = a + 1; b < size; ++b) cross->push_back(at(a, b));
  }
  return true;
}

bool ModalCost::EvaluateModes(const StructuralDynamics::Prepared& prepared,
                              Vector* residuals, Matrix* jacobian,
                              std::string* error) const {
  UndampedModes modes;
  const size_t num_columns = jacobian == nullptr ? 0 : columns_.size();
  std::vector<Partner> partners, cross;
  if (!ComputeUndampedModes(prepared.linear.mass, prepared.linear.stiffness,
                            &modes, error) ||
      !FindPartners(modes, num_columns, &partners, &cross, error)) {
    return false;
  }
  const auto set_rows = [&](int row, const Matrix& slopes) {
    for (size_t c = 0; c < num_columns; ++c) {
      jacobian->col(columns_[c].free).segment(row, slopes.rows()) +=
          columns_[c].factor * slopes.col(static_cast<Eigen::Index>(c));
    }
  };
  int row = 0;
  for (size_t i = 0; i < data_.modes.size(); ++i) {
    const MeasuredMode& mode = data_.modes[i];
    const Shape& shape = shapes_[i];
    const Vector& x = partners[i].shape;
    const ModeSlopes& slopes = partners[i].slopes;
    const double weight = EigenvalueWeight(mode);
    const double measured = MeasuredEigenvalue(mode);
    (*residuals)[row] = weight * (1.0 - partners[i].eigenvalue / measured);
    set_rows(row, -weight / measured * slopes.eigenvalue);
    ++row;
    if (!mode.HasShape()) continue;

    if (data_.form == ModalForm::kMac) {
      RowVector by_column;
      (*residuals)[row] =
          MacResidual(mode, shape.values, x, slopes.shape, &by_column);
      set_rows(row, by_column);
      ++row;
    } else {
      const Eigen::Index count = x.size() - 1;
      Vector off =
          WithoutRow(x / x[shape.largest] - shape.values, shape.largest);
      Matrix off_slopes = RatioSlopes(x, slopes.shape, shape.largest);
      if (shape.by_frequency.size() > 0) {
        // The residual of the frequency is measured less modelled, over its
        // deviation; that of the shape the other way round.
        off += shape.by_frequency * (*residuals)[row - 1];
        off_slopes -=
            shape.by_frequency * (weight / measured * slopes.eigenvalue);
      }
      residuals->segment(row, count) = shape.weight_root * off;
      set_rows(row, shape.weight_root * off_slopes);
      row += static_cast<int>(count);
    }
  }
  for (size_t i = 0; i < cross.size(); ++i) {
    (*residuals)[row] = cross_weights_[i] * cross[i].eigenvalue;
    set_rows(row, cross_weights_[i] * cross[i].slopes.eigenvalue);
    ++row;
  }
  return true;
}

bool ModalCost::EvaluateDynamicResiduals(
    const StructuralDynamics::Prepared& prepared, Vector* residuals,
    Matrix* jacobian, std::string* error) const {
  const int n = static_cast<int>(prepared.linear.mass.rows());
  for (size_t i = 0; i < data_.modes.size(); ++i) {
    const MeasuredMode& mode = data_.modes[i];
    const Shape& shape = shapes_[i];
    const double measured = MeasuredEigenvalue(mode);
    const int row = static_cast<int>(i) * n;
    const Matrix dynamic_stiffness =
        prepared.linear.stiffness - measured * prepared.linear.mass;
    const bool complete = shape.unmeasured.empty();
    const Matrix unmeasured = dynamic_stiffness(Eigen::all, shape.unmeasured);
    Eigen::ColPivHouseholderQR<Matrix> factor;
    Vector psi(n);
    psi(mode.dofs) = shape.values;
    if (!complete) {
      factor.compute(unmeasured);
      if (factor.rank() < unmeasured.cols()) {
        *error = "mode '" + mode.name +
                 "': the model does not determine the unmeasured part of its "
                 "shape, because its dynamic stiffness is singular there; "
                 "measure more DOFs";
        return false;
      }
      psi(shape.unmeasured) = -factor.solve(
          Vector(dynamic_stiffness(Eigen::all, mode.dofs) * shape.values));
    }
    const Vector residual = mode.residual_weight * (dynamic_stiffness * psi);
    residuals->segment(row, n) = residual;
    if (jacobian == nullptr) continue;

    // With A_u the unmeasured columns, A_u' r = 0 fixes the change of psi_u:
    // A_u' (dA psi + A_u dpsi_u) + dA_u' r = 0.
    for (const Column& column : columns_) {
      const double sign =
          column.target == MatrixGroup::Target::kMass ? -measured : 1.0;
      Vector slope = mode.residual_weight * sign * (*column.matrix * psi);
      if (!complete) {
        const Vector moved =
            sign * (column.matrix->transpose() * residual)(shape.unmeasured);
        // (A_u'A_u)^-1 b by the factor A_u P = Q R.
        const auto solve_squared = [&factor, &unmeasured](const Vector& right) {
          const Eigen::Index count = unmeasured.cols();
          const auto root = factor.matrixR()
                                .topLeftCorner(count, count)
                                .template triangularView<Eigen::Upper>();
          Vector y = factor.colsPermutation().transpose() * right;
          y = root.transpose().solve(y);
          y = root.solve(y);
          return Vector(factor.colsPermutation() * y);
        };
        const Vector change = -factor.solve(slope) - solve_squared(moved);
        slope += unmeasured * change;
      }
      jacobian->col(column.free).segment(row, n) += column.factor * slope;
    }
  }
  return true;
}

}  // namespace pinode
