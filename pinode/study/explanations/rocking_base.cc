#include "pinode/study/explanations/rocking_base.h"

#include <vector>

#include "pinode/dynamics/feature.h"
#include "pinode/study/explanations/ungrouped_stiffness.h"

namespace pinode {
namespace {

// Largest share of a rotation: a base without any spring would fall over.
constexpr double kMostShare = 0.99;
// Beside free stiffness the rotation of one or two storeys fits almost any
// error of the stiffness.
constexpr Eigen::Index kLeastStoreys = 3;

}  // namespace

Vector HeightsOfStoreys(const StructuralModel& model) {
  const int size = model.num_dofs();
  std::vector<std::vector<int>> neighbours(static_cast<size_t>(size));
  std::vector<int> on_ground;
  for (const Spring& spring : SpringsOf(model)) {
    if (spring.from == Feature::kGround) {
      on_ground.push_back(spring.to);
    } else {
      neighbours[static_cast<size_t>(spring.from)].push_back(spring.to);
      neighbours[static_cast<size_t>(spring.to)].push_back(spring.from);
    }
  }
  // A roof that is tied to the ground is not above its base alone.
  if (on_ground.size() != 1) return Vector();
  Vector heights = Vector::Zero(size);
  int at = on_ground.front();
  for (int storey = 1; storey <= size; ++storey) {
    heights[at] = storey;
    std::vector<int> above;
    for (const int next : neighbours[static_cast<size_t>(at)]) {
      if (heights[next] == 0.0) above.push_back(next);
    }
    if (above.size() != (storey < size ? 1u : 0u)) return Vector();
    if (storey < size) at = above.front();
  }
  return heights;
}

Matrix RockingPerShare(const Matrix& stiffness, const Vector& heights) {
  const Vector forces = stiffness * heights;
  return -forces * forces.transpose() / heights.dot(forces);
}

std::optional<Suspect> MakeRockingBase(const StructuralModel& model) {
  const Vector heights = HeightsOfStoreys(model);
  if (heights.size() < kLeastStoreys) return std::nullopt;
  Suspect suspect;
  suspect.kind = Suspect::Kind::kStiffness;
  suspect.place = "base";
  suspect.what =
      "a base that rocks, with storeys of equal height (part of the stiffness "
      "against a tilt that is lost)";
  GroupTerm term;
  term.group.name = SuspectUnknown("stiffness.rocking");
  term.group.target = MatrixGroup::Target::kStiffness;
  term.group.matrix = RockingPerShare(model.stiffness, heights);
  term.alpha.name = term.group.name;
  term.alpha.lower = 0.0;
  term.alpha.upper = kMostShare;
  suspect.groups = {term};
  return suspect;
}

}  // namespace pinode
