// Corrections of M, C and K by groups.

#ifndef PINODE_DYNAMICS_GROUP_TERM_H_
#define PINODE_DYNAMICS_GROUP_TERM_H_

#include <string>
#include <vector>

#include "pinode/dynamics/term.h"

namespace pinode {

// A correction alpha * matrix to K, C or M, optionally times
// (u[covariate] - reference) or (t - reference).
struct GroupTerm {
  enum class Follows { kNothing, kTime, kCovariate };
  MatrixGroup group;
  Parameter alpha;
  // Multiple of the group's matrix that the model's matrices already contain.
  // alpha is a change of `present`: 0.1 is a change from 1 to 1.1, unless the
  // model was updated before.
  double present = 1.0;
  Follows follows = Follows::kNothing;
  int input = -1;          // kCovariate
  double reference = 0.0;  // seconds, or the covariate's unit
};

// All groups of a model. They form one term, because they share the block
// "groups". Groups that do not follow a covariate or the time change the
// constant matrices and belong to the linear part. Each of the others adds
//
//   dv/dt += -alpha (followed value) M^-1 matrix x   (v, for damping).
class GroupTerms final : public Term {
 public:
  const std::vector<GroupTerm>& groups() const { return groups_; }

  // Adds a group. Returns false with a sentence in *error, and adds nothing, if
  // it does not fit.
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
