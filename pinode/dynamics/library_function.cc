#include "pinode/dynamics/library_function.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace pinode {
namespace {

double Sign(double x) { return static_cast<double>((x > 0.0) - (x < 0.0)); }

}  // namespace

bool LibraryFunction::DependsOn(int feature) const {
  return std::any_of(operations_.begin(), operations_.end(),
                     [feature](const Operation& operation) {
                       return operation.code == Code::kFeature &&
                              operation.index == feature;
                     });
}

double LibraryFunction::Apply(const Operation& operation,
                              const double* values) {
  const double a = operation.first < 0 ? 0.0 : values[operation.first];
  const double b = operation.second < 0 ? 0.0 : values[operation.second];
  switch (operation.code) {
    case Code::kNumber:
    case Code::kFeature:
      return operation.number;
    case Code::kAdd:
      return a + b;
    case Code::kSubtract:
      return a - b;
    case Code::kMultiply:
      return a * b;
    case Code::kDivide:
      return a / b;
    case Code::kPower:
      return std::pow(a, b);
    case Code::kIntegerPower:
      return IntegerPower(a, operation.index);
    case Code::kNegate:
      return -a;
    case Code::kLess:
      return static_cast<double>(a < b);
    case Code::kLessEqual:
      return static_cast<double>(a <= b);
    case Code::kGreater:
      return static_cast<double>(a > b);
    case Code::kGreaterEqual:
      return static_cast<double>(a >= b);
    case Code::kEqual:
      return static_cast<double>(a == b);
    case Code::kNotEqual:
      return static_cast<double>(a != b);
    case Code::kAnd:
      return static_cast<double>(a != 0.0 && b != 0.0);
    case Code::kOr:
      return static_cast<double>(a != 0.0 || b != 0.0);
    case Code::kSelect:
      return a != 0.0 ? b : values[operation.third];
    case Code::kSin:
      return std::sin(a);
    case Code::kCos:
      return std::cos(a);
    case Code::kTan:
      return std::tan(a);
    case Code::kAsin:
      return std::asin(a);
    case Code::kAcos:
      return std::acos(a);
    case Code::kAtan:
      return std::atan(a);
    case Code::kSinh:
      return std::sinh(a);
    case Code::kCosh:
      return std::cosh(a);
    case Code::kTanh:
      return std::tanh(a);
    case Code::kExp:
      return std::exp(a);
    case Code::kLn:
      return std::log(a);
    case Code::kLog10:
      return std::log10(a);
    case Code::kSqrt:
      return std::sqrt(a);
    case Code::kAbs:
      return std::abs(a);
    case Code::kSign:
      return Sign(a);
    case Code::kMin:
      return b < a ? b : a;
    case Code::kMax:
      return b > a ? b : a;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

double LibraryFunction::Forward(const double* q, const char* branches,
                                double* values) const {
  const size_t count = operations_.size();
  for (size_t i = 0; i < count; ++i) {
    const Operation& operation = operations_[i];
    values[i] = operation.code == Code::kFeature ? q[operation.index]
                                                 : Apply(operation, values);
    if (branches != nullptr && operation.switched >= 0) {
      values[i] = OnBranch(operation, branches[operation.switched] != 0);
    }
  }
  return values[count - 1];
}

double LibraryFunction::Orientation(const Operation& operation) {
  return operation.code == Code::kLess || operation.code == Code::kGreaterEqual
             ? -1.0
             : 1.0;
}

double LibraryFunction::OnBranch(const Operation& operation, bool positive) {
  switch (operation.code) {
    case Code::kLessEqual:
    case Code::kGreaterEqual:
      return positive ? 0.0 : 1.0;
    case Code::kSign:
      return positive ? 1.0 : -1.0;
    default:
      return positive ? 1.0 : 0.0;
  }
}

void LibraryFunction::FindSwitches() {
  switches_.clear();
  for (size_t i = 0; i < operations_.size(); ++i) {
    Operation& operation = operations_[i];
    switch (operation.code) {
      case Code::kLess:
      case Code::kLessEqual:
      case Code::kGreater:
      case Code::kGreaterEqual:
      case Code::kSign:
        operation.switched = num_switches();
        switches_.push_back(static_cast<int>(i));
        break;
      default:
        operation.switched = -1;
    }
  }
}

void LibraryFunction::Switches(const double* q, double* values) const {
  if (switches_.empty()) return;
  std::array<double, kMaxOperations> all;
  // Operations behind the last switch do not matter.
  for (size_t i = 0; i < static_cast<size_t>(switches_.back()); ++i) {
    const Operation& operation = operations_[i];
    all[i] = operation.code == Code::kFeature ? q[operation.index]
                                              : Apply(operation, all.data());
  }
  for (const int i : switches_) {
    const Operation& operation = operations_[static_cast<size_t>(i)];
    const auto at = [&all](int index) {
      return index < 0 ? 0.0 : all[static_cast<size_t>(index)];
    };
    *values++ =
        Orientation(operation) * (at(operation.first) - at(operation.second));
  }
}

void LibraryFunction::SwitchGradient(int j, const double* q,
                                     double* gradient) const {
  std::array<double, kMaxOperations> values;
  std::array<double, kMaxOperations> adjoints;
  std::fill(gradient, gradient + num_features_, 0.0);
  Forward(q, nullptr, values.data());
  std::fill(adjoints.begin(), adjoints.end(), 0.0);
  const Operation& operation =
      operations_[static_cast<size_t>(switches_[static_cast<size_t>(j)])];
  const double orientation = Orientation(operation);
  adjoints[static_cast<size_t>(operation.first)] += orientation;
  if (operation.second >= 0) {
    adjoints[static_cast<size_t>(operation.second)] -= orientation;
  }
  Backward(values.data(), adjoints.data(), gradient);
}

void LibraryFunction::FindMonomial() {
  monomial_.reset();
  std::vector<Monomial> found;
  for (const Operation& operation : operations_) {
    const auto operand = [&](int index) {
      return found[static_cast<size_t>(index)];
    };
    Monomial next = operation.first < 0 ? Monomial::Number(operation.number)
                                        : operand(operation.first);
    switch (operation.code) {
      case Code::kNumber:
        break;
      case Code::kFeature:
        next = Monomial::Feature(operation.index);
        break;
      case Code::kNegate:
        next.Negate();
        break;
      case Code::kAbs:
        next.TakeAbsolute();
        break;
      case Code::kMultiply:
        if (!next.Multiply(operand(operation.second))) return;
        break;
      case Code::kIntegerPower:
        if (!next.Raise(operation.index)) return;
        break;
      default:
        return;
    }
    found.push_back(std::move(next));
  }
  monomial_ = std::move(found.back());
}

double LibraryFunction::Evaluate(const double* q, const char* branches) const {
  if (monomial_.has_value()) return monomial_->Evaluate(q);
  std::array<double, kMaxOperations> values;
  return Forward(q, branches, values.data());
}

bool LibraryFunction::Differentiate(const Operation& operation, double a,
                                    double b, double value, double* by_first,
                                    double* by_second) {
  *by_first = 0.0;
  *by_second = 0.0;
  switch (operation.code) {
    case Code::kAdd:
      *by_first = 1.0;
      *by_second = 1.0;
      break;
    case Code::kSubtract:
      *by_first = 1.0;
      *by_second = -1.0;
      break;
    case Code::kMultiply:
      *by_first = b;
      *by_second = a;
      break;
    case Code::kDivide:
      *by_first = 1.0 / b;
      *by_second = -value / b;
      break;
    case Code::kPower:
      *by_first = b == 0.0 ? 0.0 : b * std::pow(a, b - 1.0);
      // The limit from above: 0^b is 0 for every b > 0.
      *by_second = a == 0.0 && b > 0.0 ? 0.0 : value * std::log(a);
      break;
    case Code::kIntegerPower:
      *by_first = operation.index == 0
                      ? 0.0
                      : operation.index * IntegerPower(a, operation.index - 1);
      break;
    case Code::kNegate:
      *by_first = -1.0;
      break;
    case Code::kSin:
      *by_first = std::cos(a);
      break;
    case Code::kCos:
      *by_first = -std::sin(a);
      break;
    case Code::kTan:
      *by_first = 1.0 + value * value;
      break;
    case Code::kAsin:
      *by_first = 1.0 / std::sqrt(1.0 - a * a);
      break;
    case Code::kAcos:
      *by_first = -1.0 / std::sqrt(1.0 - a * a);
      break;
    case Code::kAtan:
      *by_first = 1.0 / (1.0 + a * a);
      break;
    case Code::kSinh:
      *by_first = std::cosh(a);
      break;
    case Code::kCosh:
      *by_first = std::sinh(a);
      break;
    case Code::kTanh:
      *by_first = 1.0 - value * value;
      break;
    case Code::kExp:
      *by_first = value;
      break;
    case Code::kLn:
      *by_first = 1.0 / a;
      break;
    case Code::kLog10:
      *by_first = 1.0 / (a * std::log(10.0));
      break;
    case Code::kSqrt:
      *by_first = 0.5 / value;
      break;
    case Code::kAbs:
      *by_first = Sign(a);
      break;
    case Code::kMin:
      *(b < a ? by_second : by_first) = 1.0;
      break;
    case Code::kMax:
      *(b > a ? by_second : by_first) = 1.0;
      break;
    // Linearize handles the branch of a selection itself.
    case Code::kFeature:
    case Code::kNumber:
    case Code::kLess:
    case Code::kLessEqual:
    case Code::kGreater:
    case Code::kGreaterEqual:
    case Code::kEqual:
    case Code::kNotEqual:
    case Code::kAnd:
    case Code::kOr:
    case Code::kSign:
    case Code::kSelect:
      return false;
  }
  return true;
}

double LibraryFunction::Linearize(const double* q, double* gradient,
                                  const char* branches) const {
  std::fill(gradient, gradient + num_features_, 0.0);
  if (monomial_.has_value()) return monomial_->Linearize(q, gradient);
  std::array<double, kMaxOperations> values;
  std::array<double, kMaxOperations> adjoints;
  const double result = Forward(q, branches, values.data());
  const size_t count = operations_.size();
  std::fill(adjoints.begin(), adjoints.begin() + static_cast<long>(count), 0.0);
  adjoints[count - 1] = 1.0;
  Backward(values.data(), adjoints.data(), gradient);
  return result;
}

void LibraryFunction::Backward(const double* values, double* adjoints,
                               double* gradient) const {
  for (size_t i = operations_.size(); i-- > 0;) {
    const Operation& operation = operations_[i];
    const double adjoint = adjoints[i];
    // This saves time, and prevents 0 * infinity in the result from the branch
    // that a selection did not take.
    if (adjoint == 0.0) continue;
    const double value = values[i];
    const auto at = [&](int index) { return static_cast<size_t>(index); };
    const double a = operation.first < 0 ? 0.0 : values[at(operation.first)];
    const double b = operation.second < 0 ? 0.0 : values[at(operation.second)];
    if (operation.code == Code::kFeature) {
      gradient[operation.index] += adjoint;
      continue;
    }
    if (operation.code == Code::kSelect) {
      adjoints[at(a != 0.0 ? operation.second : operation.third)] += adjoint;
      continue;
    }
    double by_first = 0.0;
    double by_second = 0.0;
    if (!Differentiate(operation, a, b, value, &by_first, &by_second)) continue;
    if (operation.first >= 0) {
      adjoints[at(operation.first)] += adjoint * by_first;
    }
    if (operation.second >= 0 && by_second != 0.0) {
      adjoints[at(operation.second)] += adjoint * by_second;
    }
  }
}

}  // namespace pinode
