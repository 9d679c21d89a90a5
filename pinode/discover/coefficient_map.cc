#include "pinode/discover/coefficient_map.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

// True if two values for one unknown differ by more than rounding.
bool Differ(double a, double b) {
  return std::abs(a - b) > 1e-12 * std::max(std::abs(a), std::abs(b));
}

}  // namespace

CoefficientConstraint CoefficientConstraint::Given(
    const std::string& coefficient, double value) {
  CoefficientConstraint constraint;
  constraint.kind = Kind::kGiven;
  constraint.coefficients = {coefficient};
  constraint.value = value;
  return constraint;
}

CoefficientConstraint CoefficientConstraint::Positive(
    const std::string& coefficient) {
  CoefficientConstraint constraint;
  constraint.kind = Kind::kSign;
  constraint.coefficients = {coefficient};
  constraint.sign = 1;
  return constraint;
}

CoefficientConstraint CoefficientConstraint::Negative(
    const std::string& coefficient) {
  CoefficientConstraint constraint = Positive(coefficient);
  constraint.sign = -1;
  return constraint;
}

CoefficientConstraint CoefficientConstraint::Equal(
    const std::vector<std::string>& coefficients,
    const std::vector<double>& factors) {
  CoefficientConstraint constraint;
  constraint.kind = Kind::kEqual;
  constraint.coefficients = coefficients;
  constraint.factors = factors;
  return constraint;
}

bool CoefficientMap::Create(
    const std::vector<std::string>& names,
    const std::vector<CoefficientConstraint>& constraints, CoefficientMap* map,
    std::string* error) {
  CHECK(map != nullptr && error != nullptr);
  const size_t count = names.size();
  // Every coefficient belongs to a group; xi_j = factor_j c_group.
  std::vector<int> group(count);
  Vector factors = Vector::Ones(static_cast<Eigen::Index>(count));
  std::vector<bool> equal(count, false);
  struct Unknown {
    bool given = false;
    double value = 0.0;
    int sign = 0;
  };
  std::vector<Unknown> unknowns(count);
  for (size_t j = 0; j < count; ++j) group[j] = static_cast<int>(j);

  const auto find = [&](const std::string& name, int* index) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
      *error = "constraint: unknown coefficient '" + name + "'" +
               NameHint(name, names);
      return false;
    }
    *index = static_cast<int>(found - names.begin());
    return true;
  };

  // Equalities come first: the other conditions then apply to whole groups.
  for (const CoefficientConstraint& constraint : constraints) {
    if (constraint.kind != CoefficientConstraint::Kind::kEqual) continue;
    const size_t members = constraint.coefficients.size();
    if (members < 2) {
      *error = "constraint: an equality of " + std::to_string(members) +
               " coefficients, expected at least two";
      return false;
    }
    if (!constraint.factors.empty() && constraint.factors.size() != members) {
      *error = "constraint: an equality of " + std::to_string(members) +
               " coefficients with " +
               std::to_string(constraint.factors.size()) +
               " factors, expected one each";
      return false;
    }
    int first = -1;
    for (size_t i = 0; i < members; ++i) {
      const std::string& name = constraint.coefficients[i];
      int j;
      if (!find(name, &j)) return false;
      const double factor =
          constraint.factors.empty() ? 1.0 : constraint.factors[i];
      if (!std::isfinite(factor) || factor == 0.0) {
        *error = "constraint: factor " + FormatNumber(factor) + " of '" + name +
                 "', expected a finite number other than 0";
        return false;
      }
      if (equal[static_cast<size_t>(j)]) {
        *error = "constraint: '" + name +
                 "' is in two equalities, or twice in one; expected once";
        return false;
      }
      equal[static_cast<size_t>(j)] = true;
      if (first < 0) first = j;
      group[static_cast<size_t>(j)] = first;
      factors[j] = factor;
    }
  }

  for (const CoefficientConstraint& constraint : constraints) {
    if (constraint.kind != CoefficientConstraint::Kind::kGiven) continue;
    for (const std::string& name : constraint.coefficients) {
      int j;
      if (!find(name, &j)) return false;
      if (!std::isfinite(constraint.value)) {
        *error = "constraint: '" + name + "' given as " +
                 FormatNumber(constraint.value) + ", expected a finite number";
        return false;
      }
      Unknown& unknown =
          unknowns[static_cast<size_t>(group[static_cast<size_t>(j)])];
      const double value = constraint.value / factors[j];
      if (unknown.given && Differ(value, unknown.value)) {
        *error = "constraint: '" + name + "' is given two values";
        return false;
      }
      unknown.given = true;
      unknown.value = value;
    }
  }

  for (const CoefficientConstraint& constraint : constraints) {
    if (constraint.kind != CoefficientConstraint::Kind::kSign) continue;
    CHECK(constraint.sign == 1 || constraint.sign == -1)
        << "sign " << constraint.sign << ", expected 1 or -1";
    for (const std::string& name : constraint.coefficients) {
      int j;
      if (!find(name, &j)) return false;
      Unknown& unknown =
          unknowns[static_cast<size_t>(group[static_cast<size_t>(j)])];
      const int sign = factors[j] > 0.0 ? constraint.sign : -constraint.sign;
      if (unknown.given && unknown.value * sign < 0.0) {
        *error = "constraint: '" + name + "' is given a value of another sign";
        return false;
      }
      if (unknown.sign != 0 && unknown.sign != sign) {
        *error = "constraint: '" + name +
                 "' is to be both not negative and not positive";
        return false;
      }
      unknown.sign = sign;
    }
  }

  CoefficientMap created;
  created.factors_ = factors;
  created.values_ = Vector::Zero(factors.size());
  created.free_.assign(count, -1);
  std::vector<int> index(count, -1);
  for (size_t j = 0; j < count; ++j) {
    const size_t own = static_cast<size_t>(group[j]);
    const Unknown& unknown = unknowns[own];
    if (unknown.given) {
      created.values_[static_cast<Eigen::Index>(j)] =
          factors[static_cast<Eigen::Index>(j)] * unknown.value;
      continue;
    }
    if (index[own] < 0) {
      index[own] = created.num_free();
      created.signs_.push_back(unknown.sign);
    }
    created.free_[j] = index[own];
  }
  *map = std::move(created);
  return true;
}

Vector CoefficientMap::Expand(const Vector& free) const {
  CHECK_EQ(free.size(), num_free());
  Vector coefficients = values_;
  for (int j = 0; j < num_coefficients(); ++j) {
    const int i = free_[static_cast<size_t>(j)];
    if (i >= 0) coefficients[j] = factors_[j] * free[i];
  }
  return coefficients;
}

std::vector<int> CoefficientMap::ExpandSupport(
    const std::vector<int>& free_support) const {
  std::vector<int> support;
  for (int j = 0; j < num_coefficients(); ++j) {
    const int i = free_[static_cast<size_t>(j)];
    if (i >= 0 && std::find(free_support.begin(), free_support.end(), i) !=
                      free_support.end()) {
      support.push_back(j);
    }
  }
  return support;
}

std::vector<int> CoefficientMap::ReduceSupport(
    const std::vector<int>& support) const {
  std::set<int> reduced;
  for (int j : support) {
    CHECK(j >= 0 && j < num_coefficients())
        << "coefficient " << j << " of " << num_coefficients();
    if (free(j) >= 0) reduced.insert(free(j));
  }
  return {reduced.begin(), reduced.end()};
}

}  // namespace pinode
