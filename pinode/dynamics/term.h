// Interface between the terms of the equation of motion and the integrators.

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

// Effect of a term's result. kAcceleration: outputs * result is added to dv/dt.
// kForce: outputs * result is a resisting force, subtracted from the right-hand
// side of M dv/dt = ...
enum class ActsAs { kAcceleration, kForce };

// Kinds of terms, in the order of their parameters in theta. kOther is for
// terms that the library does not know.
enum class TermKind {
  kGroups,
  kLaw,
  kUnknownForce,
  kGroupCurve,
  kForceScale,
  kOther,
  kNetwork
};

// Place of a term's internal states in the state h = [x; v; z].
struct TermPlace {
  int num_dofs = 0;
  int first_internal = 0;  // index in h of the first one
};

// Point at which a term is evaluated, in the model's units.
template <typename T>
struct TermPoint {
  TermPlace place;
  double time = 0.0;
  // Inputs u, num_inputs entries.
  const double* input = nullptr;
  const T* state = nullptr;       // h, num_states entries
  const T* parameters = nullptr;  // of the term's own block

  // Parts x, v of the state, and the internal states of this term.
  const T* displacement() const { return state; }
  const T* velocity() const { return state + place.num_dofs; }
  const T* internal() const { return state + place.first_internal; }
};

// Sums to which a term adds its part.
template <typename T>
struct TermRate {
  T* acceleration = nullptr;  // dv/dt, num_dofs entries
  // dv/dt without the terms that act as an acceleration, num_dofs entries. A
  // force must be added here too, because corrections of the mass use this sum.
  T* force_acceleration = nullptr;
  // dz/dt of the term's own internal states. The term sets it, and does not
  // add.
  T* internal = nullptr;
};

// Data that a term computes once for each theta, from its parameters and the
// mass matrix.
struct TermPrepared {
  virtual ~TermPrepared() = default;
  // Derivative of dv/dt with respect to the term's results, num_dofs x results.
  // Empty for a term without results. See AccelerationMap.
  Matrix output_map;
};

// Data that a term keeps from a linearisation for its parameter tangents, and
// working memory. Tangents are derivatives with respect to free parameters.
struct TermLinearization {
  virtual ~TermLinearization() = default;
};

// Working memory of a term's parameter tangents.
struct TermTangentScratch {
  virtual ~TermTangentScratch() = default;
};

// Data that StructuralDynamics::Averaged averages over.
struct Conditions {
  Matrix inputs;               // inputs x samples
  std::optional<double> time;  // mean time; none: not averaged
};

// Term of the equation of motion. StructuralDynamics combines the terms. It
// assigns their places, and passes each term its own part of the state and of
// the parameters.
//
// To add a kind of term:
//
// 1. Write it in a file like law_term.cc: a struct that describes it, a
//    class that derives from TermOf<that struct> in the unnamed namespace, and
//    MakeTerm(). Write its equations once, as a template on the scalar behind
//    the two AddRate(). CheckTerm of term_test.cc checks hand-coded
//    derivatives in one line.
// 2. Give it a line in TermKind if it needs its own place in theta and a list
//    like StructuralDynamics::laws().
//
// Without step 2 the term has the kind kOther. Any file can pass it to
// StructuralDynamics::AddTerm. A force that is a formula of its features needs
// no new kind of term: it is a Law.
//
// All const functions may be called from several threads, each with its own
// linearisations and working memory. AddRate, Linearize and
// AddParameterTangents run inside the integrator. They must not allocate
// memory, except on Jets.
class Term {
 public:
  // Largest number of stages of a Runge-Kutta step.
  static constexpr int kMostStages = 4;

  virtual ~Term() = default;
  virtual TermKind kind() const = 0;
  virtual std::unique_ptr<Term> Clone() const = 0;

  // Checks sizes, features and parameters against the model and the number of
  // inputs. On failure returns false, and *error names the term and the
  // mismatch. Call it before any other function except parameters().
  [[nodiscard]] virtual bool IsValid(const StructuralModel& model,
                                     int num_inputs,
                                     std::string* error) const = 0;

  // Unknowns of the term in one block, and the replacement of their values.
  // Free parameters have tangent columns.
  virtual const ParameterBlock& parameters() const = 0;
  virtual void SetParameters(const Vector& values) = 0;
  // Returns the names "z[...]" of the internal states, one each.
  virtual std::vector<std::string> InternalNames() const { return {}; }

  // Returns the term's changes of the constant matrices. LinearDynamics applies
  // them and computes their tangents. The functions below do not include them.
  virtual std::vector<MatrixChange> MatrixChanges() const { return {}; }
  // True if the term does nothing but change the constant matrices.
  virtual bool IsConstant() const { return false; }
  // Returns a copy in which matrices that follow an input or the time are
  // constant. Their values are the means over `over`.
  virtual std::unique_ptr<Term> Averaged(const Conditions& /*over*/) const {
    return Clone();
  }

  // Computes the data that depend on theta alone. `parameters` are those of the
  // term's own block. `linear` includes the changes of all terms.
  virtual std::unique_ptr<TermPrepared> Prepare(
      const LinearSystem& linear, const double* parameters) const = 0;

  // Allocates memory for a linearisation.
  virtual std::unique_ptr<TermLinearization> MakeLinearization(
      const TermPlace& place) const = 0;

  // Adds the term's part of dh/dt to *rate. The parameters in `at` have the
  // values that `prepared` was computed for. On Jets they also have
  // derivatives.
  virtual void AddRate(const TermPrepared& prepared,
                       const TermPoint<double>& at, TermRate<double>* rate,
                       TermLinearization* scratch) const = 0;
  virtual void AddRate(const TermPrepared& prepared,
                       const TermPoint<WideJet>& at,
                       TermRate<WideJet>* rate) const = 0;

  // Adds the term's rate as AddRate does, and d rate / d h to *jacobian,
  // num_states x num_states. Stores in *kept what AddParameterTangents needs.
  virtual void Linearize(const TermPrepared& prepared,
                         const TermPoint<double>& at, TermRate<double>* rate,
                         Matrix* jacobian, TermLinearization* kept) const = 0;

  // Allocates working memory for products with `rows` rows.
  virtual std::unique_ptr<TermTangentScratch> MakeTangentScratch(
      const TermPlace& place, int rows) const = 0;

  // Adds sum_s left_s (d rate / d p)_s to `result`, summed over num_stages <=
  // kMostStages stages. Each left_s is rows x num_states. `result` is rows x
  // free parameters of the term, stored by columns.
  virtual void AddParameterTangents(const TermPlace& place,
                                    const TermPrepared& prepared,
                                    const TermLinearization* const* stages,
                                    const Matrix* const* lefts, int num_stages,
                                    TermTangentScratch* scratch,
                                    double* result) const = 0;

  // Switching functions of the state at which the term jumps, see
  // Law::Switches. Terms that never jump need none of these functions.
  virtual int num_switches() const { return 0; }
  // Computes their values, num_switches() entries.
  virtual void Switches(const TermPoint<double>& /*at*/,
                        double* /*values*/) const {}
  // Adds the gradient of switch j by the state to `gradient`, num_states
  // entries.
  virtual void AddSwitchGradient(int /*j*/, const TermPoint<double>& /*at*/,
                                 double* /*gradient*/) const {}
  // Keeps AddRate and Linearize with this working memory on a branch of each
  // switch, num_switches() entries that must outlive the calls. nullptr: the
  // branches at the point.
  virtual void SetBranches(const char* /*branches*/,
                           TermLinearization* /*kept*/) const {}
};

// Base of terms that a plain struct describes.
template <typename Description>
class TermOf : public Term {
 public:
  explicit TermOf(Description description)
      : description_(std::move(description)) {}

  const Description& description() const { return description_; }

 protected:
  Description description_;
};

// Range of the descriptions of all terms of one kind. It has the reading
// interface of a vector.
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

// Returns the tangent column of each parameter within its term, or -1 for a
// fixed parameter. One entry per parameter. Tied parameters have columns within
// their term: StructuralDynamics adds them to those of their sources.
std::vector<int> TangentColumns(const ParameterBlock& block);
// Returns the number of tangent columns within the term.
int NumFree(const ParameterBlock& block);

}  // namespace pinode

#endif  // PINODE_DYNAMICS_TERM_H_
