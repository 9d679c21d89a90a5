// The interface between the terms of the equation of motion and the
// integrators.

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

// Position of a term in the state h = [x; v; z].
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

// The sums to which a term adds its part.
template <typename T>
struct TermRate {
  T* acceleration = nullptr;  // dv/dt, num_dofs
  // dv/dt without the terms that act as an acceleration, num_dofs. Add the
  // effect of each force here too, because corrections of the mass refer to it.
  T* force_acceleration = nullptr;
  T* internal = nullptr;  // dz/dt of the term's states; set it
};

// Data that a term computes once for each theta from its parameters and the
// mass.
struct TermPrepared {
  virtual ~TermPrepared() = default;
  // Derivative of dv/dt with respect to the term's results, num_dofs x results,
  // if it has any; see AccelerationMap.
  Matrix output_map;
};

// Data of a linearisation that a term keeps for its parameter tangents, and its
// scratch memory.
struct TermLinearization {
  virtual ~TermLinearization() = default;
};

// Working memory of a term's parameter tangents.
struct TermTangentScratch {
  virtual ~TermTangentScratch() = default;
};

// Data over which StructuralDynamics::Averaged takes its means.
struct Conditions {
  Matrix inputs;               // inputs x samples
  std::optional<double> time;  // mean time; none: no average over time
};

// One term of the equation of motion. StructuralDynamics combines the terms: it
// assigns their places and passes each its own part of state and parameters.
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
// Without step 2, pass it to StructuralDynamics::AddTerm as kOther, from any
// file. A force that is a formula of its features needs no new term: it is a
// Law.
//
// All const functions are safe to call from several threads, each with its own
// linearisations and scratch memory. Rate, Linearize and AddParameterTangents
// run inside the integrator and allocate no memory, except on Jets.
class Term {
 public:
  // Number of stages of a Runge-Kutta step.
  static constexpr int kMostStages = 4;

  virtual ~Term() = default;
  virtual TermKind kind() const = 0;
  virtual std::unique_ptr<Term> Clone() const = 0;

  // Checks sizes, features and parameters against the model and the number of
  // inputs. On failure *error names the term and the mismatch. No other
  // function except parameters() may be called before.
  [[nodiscard]] virtual bool IsValid(const StructuralModel& model,
                                     int num_inputs,
                                     std::string* error) const = 0;

  // Unknowns of the term, one block. The free ones have tangent columns.
  virtual const ParameterBlock& parameters() const = 0;
  virtual void SetParameters(const Vector& values) = 0;
  // Returns the names of the internal states z, "z[...]".
  virtual std::vector<std::string> InternalNames() const { return {}; }

  // Returns the term's changes of the constant matrices. The linear part
  // handles them, including their tangents. The functions below leave them out.
  virtual std::vector<MatrixChange> MatrixChanges() const { return {}; }
  // Returns true if the term has no other effect.
  virtual bool IsConstant() const { return false; }
  // Returns a copy in which matrices that follow something have their constant
  // mean value.
  virtual std::unique_ptr<Term> Averaged(const Conditions& /*over*/) const {
    return Clone();
  }

  // Computes the data for values of its parameters. `linear` includes the
  // changes of all terms.
  virtual std::unique_ptr<TermPrepared> Prepare(
      const LinearSystem& linear, const double* parameters) const = 0;

  virtual std::unique_ptr<TermLinearization> MakeLinearization(
      const TermPlace& place) const = 0;

  // Adds the term's rate. The parameters are those of `prepared`; on Jets they
  // have derivatives.
  virtual void AddRate(const TermPrepared& prepared,
                       const TermPoint<double>& at, TermRate<double>* rate,
                       TermLinearization* scratch) const = 0;
  virtual void AddRate(const TermPrepared& prepared,
                       const TermPoint<WideJet>& at,
                       TermRate<WideJet>* rate) const = 0;

  // Does what AddRate does, and adds d rate / d h to *jacobian, num_states x
  // num_states.
  virtual void Linearize(const TermPrepared& prepared,
                         const TermPoint<double>& at, TermRate<double>* rate,
                         Matrix* jacobian, TermLinearization* kept) const = 0;

  // Returns working memory for products with `rows` rows.
  virtual std::unique_ptr<TermTangentScratch> MakeTangentScratch(
      const TermPlace& place, int rows) const = 0;

  // Computes result (rows x free parameters) += sum_s left_s (d rate / d p)_s
  // over up to kMostStages stages, with left_s of rows x num_states.
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

// The terms of one kind, as a range of their descriptions. It has the reading
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

// Returns the tangent column of each parameter within its term, -1 for a fixed
// parameter, and the number of columns.
std::vector<int> TangentColumns(const ParameterBlock& block);
int NumFree(const ParameterBlock& block);

}  // namespace pinode

#endif  // PINODE_DYNAMICS_TERM_H_
