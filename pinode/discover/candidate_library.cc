#include "pinode/discover/candidate_library.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Returns "a^2*b" from the features' names and their exponents.
std::string Monomial(const std::vector<std::string>& names,
                     const std::vector<int>& exponents) {
  std::vector<std::string> factors;
  for (size_t i = 0; i < names.size(); ++i) {
    if (exponents[i] == 1) factors.push_back(names[i]);
    if (exponents[i] > 1) {
      factors.push_back(names[i] + "^" + std::to_string(exponents[i]));
    }
  }
  return Join(factors, "*");
}

// Appends the monomials of `degree` in the names from `first` on, the earlier
// names' exponents being given. Returns false if there are more than allowed.
bool AppendMonomials(const std::vector<std::string>& names, bool products,
                     int degree, size_t first, std::vector<int>* exponents,
                     std::vector<std::string>* texts) {
  if (texts->size() > CandidateLibrary::kMaxCandidates) return false;
  if (degree == 0) {
    texts->push_back(Monomial(names, *exponents));
    return true;
  }
  for (size_t i = first; i < names.size(); ++i) {
    for (int exponent = degree; exponent >= (products ? 1 : degree);
         --exponent) {
      (*exponents)[i] = exponent;
      const bool all = AppendMonomials(names, products, degree - exponent,
                                       i + 1, exponents, texts);
      (*exponents)[i] = 0;
      if (!all) return false;
    }
  }
  return true;
}

bool CheckFeatures(const char* what, const std::vector<std::string>& known,
                   const std::vector<std::string>& features,
                   std::string* error) {
  std::set<std::string> seen;
  for (const std::string& feature : features) {
    if (std::find(known.begin(), known.end(), feature) == known.end()) {
      *error = std::string(what) + ": unknown feature '" + feature + "'" +
               NameHint(feature, known);
      return false;
    }
    if (!seen.insert(feature).second) {
      *error = std::string(what) + ": feature '" + feature + "' twice";
      return false;
    }
  }
  return true;
}

}  // namespace

bool CandidateLibrary::Create(const std::vector<std::string>& feature_names,
                              const CandidateLibraryOptions& options,
                              CandidateLibrary* library, std::string* error) {
  CHECK(library != nullptr && error != nullptr);
  if (!CheckFeatures("library", feature_names, feature_names, error)) {
    return false;
  }
  if (options.polynomial_degree < 0) {
    *error = "library: polynomial degree " +
             std::to_string(options.polynomial_degree) + ", expected 0 or more";
    return false;
  }

  std::vector<std::string> texts;
  std::vector<int> degrees;
  if (options.constant) {
    texts.emplace_back("1");
    degrees.push_back(0);
  }

  const std::vector<std::string>& polynomial =
      options.polynomial_features.empty() ? feature_names
                                          : options.polynomial_features;
  if (!CheckFeatures("polynomials", feature_names, polynomial, error)) {
    return false;
  }
  bool few = true;
  std::vector<int> exponents(polynomial.size(), 0);
  for (int degree = 1;
       few && degree <= options.polynomial_degree && !polynomial.empty();
       ++degree) {
    few = AppendMonomials(polynomial, options.products, degree, 0, &exponents,
                          &texts);
    degrees.resize(texts.size(), degree);
  }

  const auto append = [&](const char* what,
                          const std::vector<std::string>& features,
                          const std::string& before, bool squared) {
    if (!CheckFeatures(what, feature_names, features, error)) return false;
    for (const std::string& feature : features) {
      texts.push_back(before + "(" + feature + ")" +
                      (squared ? "*" + feature : ""));
    }
    return true;
  };
  if (!append("sines", options.sine_features, "sin", false) ||
      !append("cosines", options.cosine_features, "cos", false) ||
      !append("absolute values", options.absolute_features, "abs", false) ||
      !append("signs", options.sign_features, "sign", false) ||
      !append("signed squares", options.signed_square_features, "abs", true)) {
    return false;
  }
  texts.insert(texts.end(), options.expressions.begin(),
               options.expressions.end());
  if (texts.empty()) {
    *error = "library: no candidate, expected at least one";
    return false;
  }
  if (!few || texts.size() > kMaxCandidates) {
    *error = "library: more than " + std::to_string(kMaxCandidates) +
             " candidates, expected a lower degree or fewer features";
    return false;
  }

  degrees.resize(texts.size(), kNotAMonomial);

  CandidateLibrary created;
  created.degrees_ = std::move(degrees);
  created.feature_names_ = feature_names;
  std::set<std::string> seen;
  for (const std::string& text : texts) {
    LibraryFunction function;
    std::string reason;
    if (!LibraryFunction::Parse(text, feature_names, &function, &reason)) {
      *error = "library: " + reason;
      return false;
    }
    if (!seen.insert(function.text()).second) {
      *error = "library: candidate '" + function.text() + "' twice";
      return false;
    }
    created.functions_.push_back(std::move(function));
  }
  *library = std::move(created);
  return true;
}

std::vector<std::string> CandidateLibrary::Names() const {
  std::vector<std::string> names;
  for (const LibraryFunction& function : functions_) {
    names.push_back(function.text());
  }
  return names;
}

bool CandidateLibrary::Evaluate(const Matrix& features, Matrix* theta,
                                std::string* error) const {
  CHECK(theta != nullptr && error != nullptr);
  CHECK_EQ(features.cols(), static_cast<Eigen::Index>(feature_names_.size()))
      << "one column a feature";
  Matrix values(features.rows(), size());
  Vector sample(features.cols());
  for (Eigen::Index i = 0; i < features.rows(); ++i) {
    sample = features.row(i).transpose();
    for (int j = 0; j < size(); ++j) {
      values(i, j) = function(j).Evaluate(sample.data());
      if (!std::isfinite(values(i, j))) {
        *error = "candidate '" + function(j).text() + "' is not finite at " +
                 "sample " + std::to_string(i + 1) + ", expected a function " +
                 "that is defined for the whole record";
        return false;
      }
    }
  }
  *theta = std::move(values);
  return true;
}

void CandidateLibrary::Linearize(const Vector& features, Vector* values,
                                 Matrix* jacobian) const {
  CHECK(values != nullptr && jacobian != nullptr);
  CHECK_EQ(features.size(), static_cast<Eigen::Index>(feature_names_.size()))
      << "one entry a feature";
  values->resize(size());
  jacobian->resize(size(), features.size());
  Vector gradient(features.size());
  for (int j = 0; j < size(); ++j) {
    (*values)[j] = function(j).Linearize(features.data(), gradient.data());
    jacobian->row(j) = gradient.transpose();
  }
}

}  // namespace pinode
