#include "pinode/estimate/null_space.h"

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

}  // namespace pinode
