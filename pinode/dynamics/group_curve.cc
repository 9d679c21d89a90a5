#include "pinode/dynamics/group_curve.h"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/dynamics/described_term.h"
#include "pinode/dynamics/products.h"

namespace pinode {
namespace {

// The two parameters around a value of the covariate, and their N. -1 for the
// reference, which has no parameter.
struct CurvePlace {
  int parameter[2] = {-1, -1};
  double weight[2] = {0.0, 0.0};
};

struct PreparedCurve : TermPrepared {
  Matrix map;  // -M^-1 matrix
};

struct LinearizedCurve : TermLinearization {
  Vector unit;  // num_dofs: acceleration by a unit change of alpha
  CurvePlace place;
};

CurvePlace PlaceOnCurve(const GroupCurve& curve, double u) {
  const std::vector<double>& knots = curve.knots;
  const auto above = std::upper_bound(knots.begin(), knots.end(), u);
  const int last = static_cast<int>(knots.size()) - 1;
  const int right =
      std::clamp(static_cast<int>(above - knots.begin()), 1, last);
  const double left_knot = knots[static_cast<size_t>(right - 1)];
  const double right_knot = knots[static_cast<size_t>(right)];
  const double share =
      std::clamp((u - left_knot) / (right_knot - left_knot), 0.0, 1.0);
  CurvePlace place;
  const int ends[] = {right - 1, right};
  for (int i = 0; i < 2; ++i) {
    if (ends[i] == curve.reference) continue;
    place.parameter[i] = ends[i] - (ends[i] > curve.reference ? 1 : 0);
    place.weight[i] = i == 0 ? 1.0 - share : share;
  }
  return place;
}

template <typename T>
T ChangeOfAlpha(const CurvePlace& place, const T* parameters) {
  T change(0.0);
  for (int i = 0; i < 2; ++i) {
    if (place.parameter[i] < 0) continue;
    change += place.weight[i] * parameters[place.parameter[i]];
  }
  return change;
}

class GroupCurveDynamics final
    : public ColumnTerm<GroupCurveDynamics, GroupCurve,
                        &GroupCurve::parameters> {
 public:
  using ColumnTerm::ColumnTerm;

  TermKind kind() const override { return TermKind::kGroupCurve; }

  bool IsValid(const StructuralModel& model, int num_inputs,
               std::string* error) const override {
    const GroupCurve& curve = description_;
    const std::string of = "group '" + curve.name + "': ";
    if (!curve.group.IsValid(model.dof_names, error)) return false;
    if (curve.group.target == MatrixGroup::Target::kMass) {
      *error = of +
               "a mass cannot follow a covariate; only stiffness and damping "
               "can";
      return false;
    }
    if (curve.input < 0 || curve.input >= num_inputs) {
      *error = "group '" + curve.name + "' follows an unknown covariate";
      return false;
    }
    const auto num_knots = static_cast<int>(curve.knots.size());
    for (int k = 0; k < num_knots; ++k) {
      const double knot = curve.knots[static_cast<size_t>(k)];
      if (!std::isfinite(knot) ||
          (k > 0 && knot <= curve.knots[static_cast<size_t>(k - 1)])) {
        *error = of + "its knots do not ascend";
        return false;
      }
    }
    if (num_knots < 2 || curve.reference < 0 || curve.reference >= num_knots ||
        curve.parameters.size() != num_knots - 1) {
      *error = of +
               "it needs two knots at least, one of them the reference, "
               "and a parameter for each other";
      return false;
    }
    if (!curve.prior.IsValid(curve.parameters.size(), num_free(), error)) {
      *error = of + *error;
      return false;
    }
    return curve.parameters.IsValid(error);
  }

  std::unique_ptr<Term> Averaged(const Conditions& over) const override;

  std::unique_ptr<TermPrepared> Prepare(
      const LinearSystem& linear, const double* /*parameters*/) const override {
    auto prepared = std::make_unique<PreparedCurve>();
    prepared->map = -linear.mass_inverse * description_.group.matrix;
    return prepared;
  }

  std::unique_ptr<TermLinearization> MakeLinearization(
      const TermPlace& place) const override {
    auto linearization = std::make_unique<LinearizedCurve>();
    linearization->unit = Vector::Zero(place.num_dofs);
    return linearization;
  }

  void AddRate(const TermPrepared& prepared, const TermPoint<double>& at,
               TermRate<double>* rate,
               TermLinearization* scratch) const override {
    auto* kept = static_cast<LinearizedCurve*>(scratch);
    kept->unit.setZero();
    kept->place = PlaceOnCurve(description_, at.input[description_.input]);
    AddUnit(prepared, at, kept->unit.data());
    AddChange(ChangeOfAlpha(kept->place, at.parameters), kept->unit.data(),
              at.place.num_dofs, rate);
  }

  void AddRate(const TermPrepared& prepared, const TermPoint<WideJet>& at,
               TermRate<WideJet>* rate) const override {
    const CurvePlace place =
        PlaceOnCurve(description_, at.input[description_.input]);
    std::vector<WideJet> unit(static_cast<size_t>(at.place.num_dofs),
                              WideJet(0.0));
    AddUnit(prepared, at, unit.data());
    AddChange(ChangeOfAlpha(place, at.parameters), unit.data(),
              at.place.num_dofs, rate);
  }

  void Linearize(const TermPrepared& prepared, const TermPoint<double>& at,
                 TermRate<double>* rate, Matrix* jacobian,
                 TermLinearization* kept) const override {
    AddRate(prepared, at, rate, kept);
    const int n = at.place.num_dofs;
    jacobian->block(n, OnVelocity() ? n : 0, n, n) +=
        ChangeOfAlpha(static_cast<LinearizedCurve*>(kept)->place,
                      at.parameters) *
        static_cast<const PreparedCurve&>(prepared).map;
  }

  void AddParameterTangents(const TermPlace& place,
                            const TermPrepared& /*prepared*/,
                            const TermLinearization* const* stages,
                            const Matrix* const* lefts, int num_stages,
                            TermTangentScratch* scratch,
                            double* result) const override {
    if (num_free() == 0) return;
    for (int s = 0; s < num_stages; ++s) {
      const auto& kept = static_cast<const LinearizedCurve&>(*stages[s]);
      const Vector& column = MapColumn(place, *lefts[s], kept.unit, scratch);
      for (int i = 0; i < 2; ++i) {
        if (kept.place.parameter[i] < 0) continue;
        AddToColumn(kept.place.parameter[i], column, kept.place.weight[i],
                    result);
      }
    }
  }

 private:
  bool OnVelocity() const {
    return description_.group.target == MatrixGroup::Target::kDamping;
  }

  template <typename T>
  void AddUnit(const TermPrepared& prepared, const TermPoint<T>& at,
               T* unit) const {
    AddProduct(static_cast<const PreparedCurve&>(prepared).map,
               OnVelocity() ? at.velocity() : at.displacement(), unit);
  }

  template <typename T>
  static void AddChange(const T& change, const T* unit, int num_dofs,
                        TermRate<T>* rate) {
    for (int i = 0; i < num_dofs; ++i) {
      rate->acceleration[i] += change * unit[i];
      rate->force_acceleration[i] += change * unit[i];
    }
  }
};

// A curve for its mean: each parameter changes a matrix.
class AveragedCurve final
    : public DescribedTerm<AveragedCurve, GroupCurve, &GroupCurve::parameters> {
 public:
  AveragedCurve(GroupCurve curve, const RowVector& covariate)
      : DescribedTerm(std::move(curve)) {
    Vector weights = Vector::Zero(parameters().size());
    for (const double u : covariate) {
      const CurvePlace place = PlaceOnCurve(description_, u);
      for (int i = 0; i < 2; ++i) {
        if (place.parameter[i] >= 0) {
          weights[place.parameter[i]] += place.weight[i];
        }
      }
    }
    for (const double weight : weights) {
      changes_.push_back(description_.group);
      changes_.back().matrix *= weight / static_cast<double>(covariate.size());
    }
  }

  TermKind kind() const override { return TermKind::kGroupCurve; }
  bool IsValid(const StructuralModel& /*model*/, int /*num_inputs*/,
               std::string* /*error*/) const override {
    return true;
  }
  std::vector<MatrixChange> MatrixChanges() const override {
    const std::vector<int> columns = TangentColumns(parameters());
    std::vector<MatrixChange> changes;
    for (size_t k = 0; k < changes_.size(); ++k) {
      changes.push_back({&changes_[k], static_cast<int>(k), columns[k]});
    }
    return changes;
  }
  bool IsConstant() const override { return true; }

  // The term has no other data.
  std::unique_ptr<TermPrepared> Prepare(
      const LinearSystem& /*linear*/,
      const double* /*parameters*/) const override {
    return std::make_unique<TermPrepared>();
  }
  std::unique_ptr<TermLinearization> MakeLinearization(
      const TermPlace& /*place*/) const override {
    return std::make_unique<TermLinearization>();
  }
  void AddRate(const TermPrepared& /*prepared*/,
               const TermPoint<double>& /*at*/, TermRate<double>* /*rate*/,
               TermLinearization* /*scratch*/) const override {}
  void AddRate(const TermPrepared& /*prepared*/,
               const TermPoint<WideJet>& /*at*/,
               TermRate<WideJet>* /*rate*/) const override {}
  void Linearize(const TermPrepared& /*prepared*/,
                 const TermPoint<double>& /*at*/, TermRate<double>* /*rate*/,
                 Matrix* /*jacobian*/,
                 TermLinearization* /*kept*/) const override {}
  std::unique_ptr<TermTangentScratch> MakeTangentScratch(
      const TermPlace& /*place*/, int /*rows*/) const override {
    return std::make_unique<TermTangentScratch>();
  }
  void AddParameterTangents(const TermPlace& /*place*/,
                            const TermPrepared& /*prepared*/,
                            const TermLinearization* const* /*stages*/,
                            const Matrix* const* /*lefts*/, int /*num_stages*/,
                            TermTangentScratch* /*scratch*/,
                            double* /*result*/) const override {}

 private:
  std::vector<MatrixGroup> changes_;  // one for each parameter
};

std::unique_ptr<Term> GroupCurveDynamics::Averaged(
    const Conditions& over) const {
  return std::make_unique<AveragedCurve>(description_,
                                         over.inputs.row(description_.input));
}

}  // namespace

std::unique_ptr<Term> MakeTerm(GroupCurve curve) {
  return std::make_unique<GroupCurveDynamics>(std::move(curve));
}

std::string KnotName(const std::string& group, const std::string& covariate,
                     double knot) {
  return group + "." + covariate + "[" + FormatNumber(knot, 12) + "]";
}

CombinationPrior CurvePrior(const std::vector<double>& knots, int reference,
                            int differences, double sigma) {
  const auto num_knots = static_cast<int>(knots.size());
  CHECK(differences == 1 || differences == 2) << differences;
  CHECK_GT(num_knots, differences) << "too few knots for differences";
  const auto knot = [&knots](int k) { return knots[static_cast<size_t>(k)]; };
  const double mean = (knots.back() - knots.front()) / (num_knots - 1);
  CombinationPrior prior;
  prior.precisions = {sigma > 0.0 ? 1.0 / (sigma * sigma) : -1.0};
  for (int k = 0; k + differences < num_knots; ++k) {
    // Weights of the values at knots k, k + 1, (k + 2).
    Vector at_knots(differences + 1);
    const double before = knot(k + 1) - knot(k);
    if (differences == 1) {
      at_knots << -1.0, 1.0;
      at_knots *= std::sqrt(mean / before);
    } else {
      const double behind = knot(k + 2) - knot(k + 1);
      at_knots << 1.0 / before, -1.0 / before - 1.0 / behind, 1.0 / behind;
      at_knots *= mean * std::sqrt(2.0 * mean / (before + behind));
    }
    // The reference's value is not an unknown.
    CombinationPrior::Combination combination;
    combination.first = k - (k > reference ? 1 : 0);
    std::vector<double> weights;
    for (int i = 0; i <= differences; ++i) {
      if (k + i != reference) weights.push_back(at_knots[i]);
    }
    combination.weights = Eigen::Map<const Vector>(
        weights.data(), static_cast<Eigen::Index>(weights.size()));
    prior.combinations.push_back(std::move(combination));
  }
  return prior;
}

}  // namespace pinode
