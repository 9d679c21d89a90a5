// Groups: corrections of M, C and K by matrices with unknown factors.

#ifndef PINODE_DYNAMICS_GROUP_TERM_H_
#define PINODE_DYNAMICS_GROUP_TERM_H_

#include <string>
#include <vector>

#include "pinode/dynamics/term.h"

namespace pinode {

// Correction alpha * matrix of K, C or M. If it follows the time or a
// covariate, it is multiplied by (t - reference) or (u[covariate] - reference).
struct GroupTerm {
  // Quantity that the correction is proportional to.
  enum class Follows { kNothing, kTime, kCovariate };
  MatrixGroup group;
  // Unknown factor. It is dimensionless if the group follows nothing. Otherwise
  // its unit is one over that of the time or covariate.
  Parameter alpha;
  // Multiple of the group's matrix that the model's matrices already contain.
  // alpha is the change of this multiple: with present = 1, alpha = 0.1 is a
  // change from 1 to 1.1. It differs from 1 if the model was updated before.
  double present = 1.0;
  Follows follows = Follows::kNothing;
  int input = -1;  // index of the covariate; kCovariate only
  // Value of the time or of the covariate at which the correction is zero, in
  // its unit.
  double reference = 0.0;
};

// Term of all groups of a model, which share the parameter block "groups".
// Groups that follow nothing change the constant matrices and belong to the
// linear part. Each other group adds
//
//   dv/dt += -alpha (followed value - reference) M^-1 matrix x
//
// with v in place of x for damping.
class GroupTerms final : public Term {
 public:
  const std::vector<GroupTerm>& groups() const { return groups_; }

  // Adds a group. Adds nothing and returns false, with *error, if its matrix or
  // its covariate does not fit the model.
  [[nodiscard]] bool Add(GroupTerm group, const StructuralModel& model,
                         int num_inputs, std::string* error);

  TermKind kind() const override { return TermKind::kGroups; }
  std::unique_ptr<Term> Clone() const override;
  [[nodiscard]] bool IsValid(const StructuralModel& model, int num_inputs,
                             std::string* error) const override;
  const ParameterBlock& parameters() const override { return block_; }
  void SetParameters(const Vector& values) override;
  std::vector<MatrixChange> MatrixChanges() const override;
  bool IsConstant() const override { return following_.empty(); }
  std::unique_ptr<Term> Averaged(const Conditions& over) const override;
  std::unique_ptr<TermPrepared> Prepare(
      const LinearSystem& linear, const double* parameters) const override;
  std::unique_ptr<TermLinearization> MakeLinearization(
      const TermPlace& place) const override;
  void AddRate(const TermPrepared& prepared, const TermPoint<double>& at,
               TermRate<double>* rate,
               TermLinearization* scratch) const override;
  void AddRate(const TermPrepared& prepared, const TermPoint<WideJet>& at,
               TermRate<WideJet>* rate) const override;
  void Linearize(const TermPrepared& prepared, const TermPoint<double>& at,
                 TermRate<double>* rate, Matrix* jacobian,
                 TermLinearization* kept) const override;
  std::unique_ptr<TermTangentScratch> MakeTangentScratch(
      const TermPlace& place, int rows) const override;
  void AddParameterTangents(const TermPlace& place,
                            const TermPrepared& prepared,
                            const TermLinearization* const* stages,
                            const Matrix* const* lefts, int num_stages,
                            TermTangentScratch* scratch,
                            double* result) const override;

 private:
  std::vector<GroupTerm> groups_;
  ParameterBlock block_;
  std::vector<int> columns_;    // of each group, -1 where alpha is fixed
  std::vector<int> following_;  // indices of the groups that follow something
};

}  // namespace pinode

#endif  // PINODE_DYNAMICS_GROUP_TERM_H_
