#include "pinode/study/explanations/ungrouped_stiffness.h"

#include <algorithm>

namespace pinode {
namespace {

// True if a constant group is `stiffness` times a number.
bool IsGroup(const StructuralDynamics& dynamics, const Matrix& stiffness) {
  const std::vector<GroupTerm>& groups = dynamics.groups();
  return std::any_of(groups.begin(), groups.end(), [&](const GroupTerm& term) {
    if (term.group.target != MatrixGroup::Target::kStiffness ||
        term.follows != GroupTerm::Follows::kNothing) {
      return false;
    }
    const Matrix& matrix = term.group.matrix;
    const double product = matrix.cwiseProduct(stiffness).sum();
    return product >= (1.0 - 1e-9) * matrix.norm() * stiffness.norm();
  });
}

// All stiffness that is in no free group; empty if there is none.
std::vector<UngroupedStiffness> Rest(const StructuralDynamics& dynamics) {
  Matrix rest = dynamics.model().stiffness;
  bool any = false;
  for (const GroupTerm& term : dynamics.groups()) {
    if (term.group.target != MatrixGroup::Target::kStiffness ||
        !term.alpha.free)
      continue;
    rest -= term.present * term.group.matrix;
    any = true;
  }
  const double size = dynamics.model().stiffness.norm();
  // The sum of the groups may differ from the whole by the digits of files.
  constexpr double kDigits = 1e-4;
  if (!any || !(rest.norm() > kDigits * size)) return {};
  return {{"rest", rest, "the stiffness of all that is in no free group"}};
}

}  // namespace

std::vector<Spring> SpringsOf(const StructuralModel& model) {
  const Matrix& k = model.stiffness;
  const int size = model.num_dofs();
  std::vector<Spring> springs;
  if (size > kMostPlaces) return springs;
  constexpr double kRounding = 1e-9;
  const double largest = k.cwiseAbs().maxCoeff();
  for (int i = 0; i < size; ++i) {
    for (int j = 0; j < i; ++j) {
      if (k(i, j) > kRounding * largest) return springs;
    }
    if (k.row(i).sum() < -kRounding * largest) return springs;
  }
  for (int to = 0; to < size; ++to) {
    for (int from = Feature::kGround; from < to; ++from) {
      const double stiffness =
          from == Feature::kGround ? k.row(to).sum() : -k(to, from);
      if (stiffness > 1e-6 * largest) springs.push_back({from, to, stiffness});
    }
  }
  return springs;
}

std::string PlaceName(const StructuralModel& model, int dof) {
  return dof == Feature::kGround ? "ground"
                                 : model.dof_names[static_cast<size_t>(dof)];
}

std::vector<UngroupedStiffness> FindUngroupedStiffness(
    const StructuralDynamics& dynamics, const StructuralModel& corrected) {
  const std::vector<Spring> springs = SpringsOf(corrected);
  if (springs.empty()) return Rest(dynamics);
  std::vector<UngroupedStiffness> parts;
  for (const Spring& spring : springs) {
    const Matrix matrix =
        spring.stiffness *
        SpringMatrix(corrected.num_dofs(), spring.from, spring.to);
    if (IsGroup(dynamics, matrix)) continue;
    const std::string start = PlaceName(corrected, spring.from);
    const std::string end = PlaceName(corrected, spring.to);
    parts.push_back({start + "-" + end, matrix,
                     "the stiffness between " + start + " and " + end});
  }
  return parts;
}

}  // namespace pinode
