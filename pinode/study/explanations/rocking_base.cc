#include "pinode/study/explanations/rocking_base.h"

#include <vector>

#include "pinode/dynamics/feature.h"
#include "pinode/study/explanations/ungrouped_stiffness.h"

namespace pinode {
namespace {

// Largest share of a rotation: a base without any spring would fall over.
constexpr double kMostShare = 0.99;

}  // namespace

Vector HeightsOfStoreys(const StructuralModel& model) {
  const int size = model.num_dofs();
  std::vector<bool> has_storey(static_cast<size_t>(size), false);
  for (const Spring& spring : SpringsOf(model)) {
    const int below = spring.to == 0 ? Feature::kGround : spring.to - 1;
    if (spring.from == below) has_storey[static_cast<size_t>(spring.to)] = true;
  }
  for (const bool has : has_storey) {
    if (!has) return Vector();
  }
  return Vector::LinSpaced(size, 1.0, size);
}

Matrix RockingPerShare(const Matrix& stiffness, const Vector& heights) {
  const Vector forces = stiffness * heights;
  return -forces * forces.transpose() / heights.dot(forces);
}

std::optional<Suspect> MakeRockingBase(const StructuralModel& model) {
  const Vector heights = HeightsOfStoreys(model);
  // The rotation of a single storey is its own flexibility.
  if (heights.size() < 2) return std::nullopt;
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
