// Base classes of terms that a plain struct describes.

#ifndef PINODE_DYNAMICS_DESCRIBED_TERM_H_
#define PINODE_DYNAMICS_DESCRIBED_TERM_H_

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/dynamics/feature.h"
#include "pinode/dynamics/term.h"
#include "pinode/dynamics/term_results.h"

namespace pinode {

// Implements the derived class's copies, its block of parameters and their
// columns. `Block` is the description's member that holds the parameters.
template <typename Derived, typename Description,
          ParameterBlock Description::*Block>
class DescribedTerm : public TermOf<Description> {
 public:
  explicit DescribedTerm(Description description)
      : TermOf<Description>(std::move(description)),
        columns_(TangentColumns(this->description_.*Block)),
        num_free_(NumFree(this->description_.*Block)) {}

  std::unique_ptr<Term> Clone() const final {
    return std::make_unique<Derived>(static_cast<const Derived&>(*this));
  }

  const ParameterBlock& parameters() const final {
    return this->description_.*Block;
  }
  void SetParameters(const Vector& values) final {
    (this->description_.*Block).SetValues(values);
  }

 protected:
  int num_free() const { return num_free_; }

  // Computes result.col(column of the parameter) += factor * left, if the
  // parameter is free.
  template <typename Left>
  void AddToColumn(int parameter, const Left& left, double factor,
                   double* result) const {
    const int column = columns_[static_cast<size_t>(parameter)];
    if (column < 0) return;
    Eigen::Map<Vector>(result + left.size() * column, left.size()) +=
        left * factor;
  }

 private:
  std::vector<int> columns_;
  int num_free_;
};

struct ColumnScratch : TermTangentScratch {
  Vector column;  // rows
};

// A term in which each parameter acts through one column of accelerations.
template <typename Derived, typename Description,
          ParameterBlock Description::*Block>
class ColumnTerm : public DescribedTerm<Derived, Description, Block> {
 public:
  using DescribedTerm<Derived, Description, Block>::DescribedTerm;

  std::unique_ptr<TermTangentScratch> MakeTangentScratch(
      const TermPlace& /*place*/, int rows) const final {
    auto scratch = std::make_unique<ColumnScratch>();
    scratch->column = Vector::Zero(rows);
    return scratch;
  }

 protected:
  // Returns left * [0; acceleration; 0], stored in the scratch memory.
  template <typename Acceleration>
  static const Vector& MapColumn(const TermPlace& place, const Matrix& left,
                                 const Acceleration& acceleration,
                                 TermTangentScratch* scratch) {
    Vector& column = static_cast<ColumnScratch*>(scratch)->column;
    column.noalias() =
        left.middleCols(place.num_dofs, place.num_dofs) * acceleration;
    return column;
  }
};

// A function of features whose results act on the DOFs through a matrix. Its
// description has the members name, features, outputs and acts_as.
template <typename Derived, typename Description,
          ParameterBlock Description::*Block>
class FeatureTerm : public DescribedTerm<Derived, Description, Block> {
 public:
  using DescribedTerm<Derived, Description, Block>::DescribedTerm;

  std::unique_ptr<TermPrepared> Prepare(
      const LinearSystem& linear, const double* /*parameters*/) const final {
    auto prepared = std::make_unique<TermPrepared>();
    prepared->output_map =
        AccelerationMap(this->description_.acts_as, this->description_.outputs,
                        linear.mass_inverse);
    return prepared;
  }

 protected:
  // Checks that the features exist, and that their number and the numbers of
  // outputs and parameters match the function. `its` is the function's name in
  // *error.
  bool Fits(const StructuralModel& model, int num_inputs, int num_features,
            int num_outputs, int num_parameters, const std::string& its,
            std::string* error) const {
    const Description& term = this->description_;
    if (!FeaturesExist(term.name, term.features, model.num_dofs(), num_inputs,
                       error)) {
      return false;
    }
    if (static_cast<int>(term.features.size()) != num_features ||
        this->parameters().size() != num_parameters ||
        term.outputs.rows() != model.num_dofs() ||
        term.outputs.cols() != num_outputs) {
      *error = "'" + term.name +
               "': numbers of features, parameters or outputs do not fit " +
               its;
      return false;
    }
    if (!term.outputs.allFinite()) {
      *error = "'" + term.name + "': its outputs are not finite";
      return false;
    }
    return this->parameters().IsValid(error);
  }

  template <typename T>
  void Gather(const TermPoint<T>& at, T* features) const {
    GatherFeatures(this->description_.features, at.place.num_dofs, at.time,
                   at.input, at.state, features);
  }

  template <typename T>
  void AddResultsOf(const TermPrepared& prepared, const T* results,
                    TermRate<T>* rate) const {
    AddResults(prepared.output_map, this->description_.acts_as, results,
               rate->acceleration, rate->force_acceleration);
  }
};

}  // namespace pinode

#endif  // PINODE_DYNAMICS_DESCRIBED_TERM_H_
