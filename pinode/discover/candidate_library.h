// Candidate functions from which discovery selects the terms of an equation.

#ifndef PINODE_DISCOVER_CANDIDATE_LIBRARY_H_
#define PINODE_DISCOVER_CANDIDATE_LIBRARY_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/discover/equation_options.h"
#include "pinode/dynamics/library_function.h"

namespace pinode {

// Ordered set of candidate functions of one feature vector q. They are the
// columns of Theta in y = Theta(q) xi (Brunton, Proctor, Kutz, "Discovering
// governing equations from data by sparse identification of nonlinear dynamical
// systems", PNAS 113 (2016) 3932; Lai et al. (2021), eqs. (7) to (9)). Outputs
// that have libraries of their own have one object each.
class CandidateLibrary {
 public:
  static constexpr int kMaxCandidates = 2000;

  // Creates a library. Returns false, with *library untouched, for an unknown
  // feature, a feature or candidate given twice, an expression that cannot be
  // read (with its column), no candidate at all, or more than kMaxCandidates.
  [[nodiscard]] static bool Create(
      const std::vector<std::string>& feature_names,
      const CandidateLibraryOptions& options, CandidateLibrary* library,
      std::string* error);

  int size() const { return static_cast<int>(functions_.size()); }
  const std::vector<std::string>& feature_names() const {
    return feature_names_;
  }
  // Returns the text of each candidate.
  std::vector<std::string> Names() const;
  const LibraryFunction& function(int candidate) const {
    return functions_[static_cast<size_t>(candidate)];
  }

  // Total degree of a monomial, 0 of the constant, else kNotAMonomial.
  int degree(int candidate) const {
    return degrees_[static_cast<size_t>(candidate)];
  }

  // Computes theta (samples x size()) at `features` (samples x features).
  // Returns false if an entry of theta is not finite; *error names candidate
  // and sample.
  [[nodiscard]] bool Evaluate(const Matrix& features, Matrix* theta,
                              std::string* error) const;

  // Computes values (size()) and jacobian (size() x features) at one sample;
  // sets both to the right size.
  void Linearize(const Vector& features, Vector* values,
                 Matrix* jacobian) const;

 private:
  std::vector<std::string> feature_names_;
  std::vector<LibraryFunction> functions_;
  std::vector<int> degrees_;
};

}  // namespace pinode

#endif  // PINODE_DISCOVER_CANDIDATE_LIBRARY_H_
