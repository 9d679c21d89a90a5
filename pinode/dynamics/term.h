// The seam between the terms of the equation of motion and what integrates it.

#ifndef PINODE_DYNAMICS_TERM_H_
#define PINODE_DYNAMICS_TERM_H_

#include <cstddef>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/parameter_block.h"
#include "pinode/base/types.h"
#include "pinode/dynamics/linear_dynamics.h"
#include "pinode/dynamics/wide_jet.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {

// Effect of a term's result: as an acceleration, outputs * result is added to
// dv/dt; as a force it resists, that is, outputs * result is subtracted from
// the right-hand side of the equation of motion.
enum class ActsAs { kAcceleration, kForce };

// The kinds in the order in which their parameters stand in theta. kOther is
// for terms that the library does not know.
enum class TermKind {
  kGroups,
  kLaw,
  kUnknownForce,
  kGroupCurve,
  kForceScale,
  kOther,
  kNetwork
};

// Where a term stands in the state h = [x; v; z].
struct TermPlace {
  int num_dofs = 0;
  int first_internal = 0;  // index in h of its first internal state
};

// The point at which a term is evaluated.
template <typename T>
struct TermPoint {
  TermPlace place;
  double time = 0.0;
  const double* input = nullptr;
  const T* state = nullptr;       // all of h
  const T* parameters = nullptr;  // the term's own block

  const T* displacement() const { return state; }
  const T* velocity() const { return state + place.num_dofs; }
  const T* internal() const { return state + place.first_internal; }
};

// The sums to which a term adds its share.
template <typename T>
struct TermRate {
  T* acceleration = nullptr;  // dv/dt, num_dofs
  // dv/dt without what acts as an acceleration, num_dofs: whatever comes from a
  // force is added here as well, for corrections of the mass refer to it.
  T* force_acceleration = nullptr;
  T* internal = nullptr;  // dz/dt of the term's own, to be set
};

// What a term makes of its parameters and of the mass, once for each theta.
struct TermPrepared {
  virtual ~TermPrepared() = default;
  // dv/dt by the term's results, num_dofs x results, where it has any; see
  // AccelerationMap.
  Matrix output_map;
};

// What a term keeps of a linearisation for its parameter tangents, and its
// scratch while it is evaluated.
struct TermLinearization {
  virtual ~TermLinearization() = default;
};

// Working memory of a term's parameter tangents.
struct TermTangentScratch {
  virtual ~TermTangentScratch() = default;
};

// Over what StructuralDynamics::Averaged takes its means.
struct Conditions {
  Matrix inputs;               // inputs x samples
  std::optional<double> time;  // the mean time; none: time does not pass
};

// One term of the equation of motion. StructuralDynamics composes them: it
// finds their places, hands each its own part of state and parameters, and
// knows nothing of what they do.
//
// To add a kind of term:
//
// 1. Write it as a file like law_term.cc: a struct that describes it, a
//    class that derives from TermOf<that struct> in the unnamed namespace, and
//    MakeTerm(). What it computes is written once, as a template on the
//    scalar behind the two AddRate(); what is linearised by hand is checked by
//    CheckTerm of term_test.cc in one line.
// 2. Give it a line in TermKind, if it shall have a place of its own in theta
//    and a list like StructuralDynamics::laws().
//
// Without the second it goes into StructuralDynamics::AddTerm as kOther, from
// wherever it is defined. A force that is a formula of its features needs none
// of this: it is a Law.
//
// All const functions are safe to call from several threads, each with its own
// linearisations and scratch. Rate, Linearize and AddParameterTangents run
// inside the integrator and allocate nothing, that on Jets apart.
class Term {
 public:
  // A Runge-Kutta step has four stages.
  static constexpr int kMostStages = 4;

  virtual ~Term() = default;
  virtual TermKind kind() const = 0;
  virtual std::unique_ptr<Term> Clone() const = 0;

  // Checks sizes, features and parameters against the model and the number of
  // inputs. On failure *error names the term and what does not fit. No other
  // function is called before, parameters() apart.
  [[nodiscard]] virtual bool IsValid(const StructuralModel& model,
                                     int num_inputs,
                                     std::string* error) const = 0;

  // Its unknowns, one block, of which the free ones have tangent columns.
  virtual const ParameterBlock& parameters() const = 0;
  virtual void SetParameters(const Vector& values) = 0;
  // Names of its internal states z, "z[...]".
  virtual std::vector<std::string> InternalNames() const { return {}; }

  // What it does to the constant matrices. The linear part takes care of it,
  // tangents included; the functions below leave it out.
  virtual std::vector<MatrixChange> MatrixChanges() const { return {}; }
  // Whether it does nothing else.
  virtual bool IsConstant() const { return false; }
  // A copy in which matrices that follow something are constant: their means.
  virtual std::unique_ptr<Term> Averaged(const Conditions& /*over*/) const {
    return Clone();
  }

  // For values of its parameters, and `linear` with everybody's changes.
  virtual std::unique_ptr<TermPrepared> Prepare(
      const LinearSystem& linear, const double* parameters) const = 0;

  virtual std::unique_ptr<TermLinearization> MakeLinearization(
      const TermPlace& place) const = 0;

  // Adds the term's rate. The parameters are those of `prepared`, on Jets with
  // derivatives.
  virtual void AddRate(const TermPrepared& prepared,
                       const TermPoint<double>& at, TermRate<double>* rate,
                       TermLinearization* scratch) const = 0;
  virtual void AddRate(const TermPrepared& prepared,
                       const TermPoint<WideJet>& at,
                       TermRate<WideJet>* rate) const = 0;

  // As AddRate, and adds d rate / d h to *jacobian, num_states x num_states.
  virtual void Linearize(const TermPrepared& prepared,
                         const TermPoint<double>& at, TermRate<double>* rate,
                         Matrix* jacobian, TermLinearization* kept) const = 0;

  // Working memory for products with so many rows.
  virtual std::unique_ptr<TermTangentScratch> MakeTangentScratch(
      const TermPlace& place, int rows) const = 0;

  // result (rows x free parameters) += sum_s left_s (d rate / d p)_s over up to
  // kMostStages stages, left_s of rows x num_states.
  virtual void AddParameterTangents(const TermPlace& place,
                                    const TermPrepared& prepared,
                                    const TermLinearization* const* stages,
                                    const Matrix* const* lefts, int num_stages,
                                    TermTangentScratch* scratch,
                                    double* result) const = 0;
};

// A term that a plain struct describes.
template <typename Description>
class TermOf : public Term {
 public:
  explicit TermOf(Description description)
      : description_(std::move(description)) {}

  const Description& description() const { return description_; }

 protected:
  Description description_;
};

// The terms of one kind, as their descriptions: what a vector of them offers to
// its readers.
template <typename Description>
class TermRange {
 public:
  class Iterator {
   public:
    // NOLINTBEGIN(readability-identifier-naming): the standard's names.
    using iterator_category = std::forward_iterator_tag;
    using value_type = Description;
    using difference_type = std::ptrdiff_t;
    using pointer = const Description*;
    using reference = const Description&;
    // NOLINTEND(readability-identifier-naming)

    explicit Iterator(const std::unique_ptr<Term>* term) : term_(term) {}
    reference operator*() const {
      return static_cast<const TermOf<Description>&>(**term_).description();
    }
    pointer operator->() const { return &**this; }
    Iterator& operator++() {
      ++term_;
      return *this;
    }
    bool operator==(const Iterator& other) const {
      return term_ == other.term_;
    }
    bool operator!=(const Iterator& other) const {
      return term_ != other.term_;
    }

   private:
    const std::unique_ptr<Term>* term_;
  };

  TermRange(const std::unique_ptr<Term>* first, size_t size)
      : first_(first), size_(size) {}

  size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  const Description& operator[](size_t i) const {
    return *Iterator(first_ + i);
  }
  Iterator begin() const { return Iterator(first_); }
  Iterator end() const { return Iterator(first_ + size_); }

 private:
  const std::unique_ptr<Term>* first_;
  size_t size_;
};

// The tangent column of each parameter within its term, -1 where it is fixed;
// and how many there are.
std::vector<int> TangentColumns(const ParameterBlock& block);
int NumFree(const ParameterBlock& block);

}  // namespace pinode

#endif  // PINODE_DYNAMICS_TERM_H_
