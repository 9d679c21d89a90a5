#include "pinode/estimate/certainty/null_space.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pinode {

std::vector<std::string> DescribeNullSpace(const ParameterLayout& layout,
                                           const Matrix& directions) {
  constexpr double kSmallest = 0.1;
  constexpr size_t kMostParts = 4;
  std::vector<std::string> sentences;
  for (Eigen::Index d = 0; d < directions.cols(); ++d) {
    std::vector<std::pair<double, std::string>> parts;
    for (int j = 0; j < layout.num_free(); ++j) {
      const int index = layout.free()[static_cast<size_t>(j)];
      const double part = directions(j, d);
      if (layout.IsNamed(index) && std::abs(part) > kSmallest) {
        parts.emplace_back(part, layout.parameter(index).name);
      }
    }
    if (parts.empty()) continue;
    std::sort(parts.begin(), parts.end(), [](const auto& a, const auto& b) {
      return std::abs(a.first) > std::abs(b.first);
    });
    std::string sentence;
    const double first = parts[0].first;
    for (size_t i = 0; i < std::min(parts.size(), kMostParts); ++i) {
      const double ratio = parts[i].first / first;
      char number[32];
      std::snprintf(number, sizeof(number), "%.2g ", std::abs(ratio));
      if (i > 0) sentence += ratio < 0.0 ? " - " : " + ";
      if (i > 0 && std::abs(std::abs(ratio) - 1.0) > 0.01) sentence += number;
      sentence += parts[i].second;
    }
    if (parts.size() > kMostParts) sentence += " + ...";
    sentences.push_back(sentence);
  }
  return sentences;
}

Matrix WithUnseenGroups(const IdentificationProblem& problem,
                        const ParameterLayout& layout, const Vector& free,
                        const Matrix& covariance, const Matrix& directions) {
  constexpr double kUnseen = 10.0;
  Matrix result = directions;
  if (result.rows() == 0) result.resize(layout.num_free(), 0);
  for (const GroupTerm& term : problem.dynamics->groups()) {
    if (!term.alpha.free || term.follows != GroupTerm::Follows::kNothing) {
      continue;
    }
    for (int j = 0; j < layout.num_free(); ++j) {
      const int index = layout.free()[static_cast<size_t>(j)];
      if (layout.parameter(index).name != term.group.name ||
          !(covariance(j, j) >
            std::max(kUnseen * kUnseen,
                     free[j] * free[j] / (kUnseen * kUnseen))) ||
          (result.cols() > 0 && result.row(j).cwiseAbs().maxCoeff() > 0.1)) {
        continue;
      }
      result.conservativeResize(Eigen::NoChange, result.cols() + 1);
      result.col(result.cols() - 1) = Vector::Unit(layout.num_free(), j);
    }
  }
  return result;
}

}  // namespace pinode
