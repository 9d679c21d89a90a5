#include "pinode/study/picture/structure_picture.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/strings.h"
#include "pinode/damage/change.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/structure/model/modal_analysis.h"
#include "pinode/study/damage/damage_analysis.h"
#include "pinode/study/picture/dof_places.h"
#include "pinode/study/reduction/finite_element_result.h"

namespace pinode {
namespace {

// Share of a mode below which it does not move the picture.
constexpr double kSmallestPart = 1e-6;

class PictureMaker {
 public:
  PictureMaker(const PlacedGeometry& placed,
               const IdentificationProblem& problem,
               const ReducedStructure* structure, StructurePicture* picture)
      : placed_(placed),
        problem_(problem),
        structure_(structure),
        places_(placed),
        picture_(picture) {
    picture_->geometry = placed.geometry;
    picture_->notes = placed.geometry.notes;
  }

  void AddGroups(const FitSummary* summary, const DamageResult* damage) {
    picture_->since_baseline = damage != nullptr;
    if (damage != nullptr) picture_->threshold = damage->options.threshold;
    std::vector<std::string> without;
    for (const GroupTerm& term : problem_.dynamics->groups()) {
      if (term.group.target == MatrixGroup::Target::kDamping ||
          term.follows != GroupTerm::Follows::kNothing) {
        continue;
      }
      StructurePicture::Group group;
      group.name = term.group.name;
      group.is_mass = term.group.target == MatrixGroup::Target::kMass;
      group.elements = ElementsOf(term.group.name);
      if (group.elements.empty()) {
        without.push_back(group.name);
        continue;
      }
      group.change = group.lower95 = group.upper95 = kNaN;
      group.probability = kNaN;
      if (damage != nullptr) {
        SetSinceBaseline(*damage, &group);
      } else if (summary != nullptr) {
        SetAgainstModel(*summary, term, &group);
      }
      picture_->groups.push_back(std::move(group));
    }
    if (!without.empty()) {
      picture_->notes.push_back("No elements are known of " +
                                Join(without, ", ") + ".");
    }
  }

  void AddArrows() {
    for (const IdentificationRecord& record : problem_.records) {
      for (const MeasuredChannel& channel : record.channels) {
        AddArrows(channel.observation.name, channel.observation.weights,
                  &picture_->sensors);
      }
    }
    for (const AmbientRecord& record : problem_.ambient) {
      for (const Observation& channel : record.channels) {
        AddArrows(channel.name, channel.weights, &picture_->sensors);
      }
    }
    const int num_dofs = problem_.dynamics->num_dofs();
    for (const InputSpec& input : problem_.dynamics->inputs()) {
      if (input.kind != InputSpec::Kind::kForce) continue;
      AddArrows(input.name, Vector::Unit(num_dofs, input.index),
                &picture_->forces);
    }
    for (const UnknownForceTerm& force : problem_.dynamics->unknown_forces()) {
      AddArrows(force.name, force.outputs, &picture_->unknown_forces);
    }
    if (!unplaced_.empty()) {
      picture_->notes.push_back("No place is known of " +
                                Join(unplaced_, ", ") + ".");
    }
  }

  void AddModes(const IdentifiedModel* model, int num_modes) {
    StructuralDynamics dynamics = *problem_.dynamics;
    if (model != nullptr) {
      dynamics.SetParameters(model->parameters.head(dynamics.num_parameters()));
    }
    std::vector<std::string> names = dynamics.model().dof_names;
    Vector frequency;
    Matrix shapes;
    std::string error;
    if (structure_ != nullptr) {
      WholeModes modes;
      if (!ModesOfWhole(*structure_, dynamics, &modes, &error)) return;
      names = structure_->exported.dof_names;
      frequency = modes.frequency_hz;
      shapes = modes.shapes;
    } else {
      const StructuralModel held = dynamics.HeldModel(dynamics.Parameters());
      UndampedModes modes;
      if (held.num_dofs() == 0 ||
          !ComputeUndampedModes(held.mass, held.stiffness, &modes, &error)) {
        return;
      }
      names = held.dof_names;
      frequency = modes.eigenvalues.array().sqrt() / kTwoPi;
      shapes = modes.shapes;
    }
    const double to_hz = problem_.description.HzPerModelFrequency();
    for (Eigen::Index m = 0;
         m < frequency.size() &&
         static_cast<int>(picture_->modes.size()) < num_modes;
         ++m) {
      StructurePicture::Mode mode;
      mode.frequency_hz = to_hz * frequency[m];
      if (!std::isfinite(mode.frequency_hz)) continue;
      mode.shape = AtNodes(names, shapes.col(m));
      const double largest = mode.shape.cwiseAbs().maxCoeff();
      if (!(largest > kSmallestPart * shapes.col(m).cwiseAbs().maxCoeff())) {
        continue;
      }
      mode.shape /= largest;
      picture_->modes.push_back(std::move(mode));
    }
  }

 private:
  std::vector<int> ElementsOf(const std::string& group) const {
    std::vector<std::string> sets = {group};
    const auto named = placed_.groups.find(group);
    if (named != placed_.groups.end()) sets = named->second;
    std::vector<int> elements;
    for (const std::string& set : sets) {
      const int index = placed_.geometry.SetIndex(set);
      if (index < 0) continue;
      const std::vector<int>& own =
          placed_.geometry.sets[static_cast<size_t>(index)].elements;
      elements.insert(elements.end(), own.begin(), own.end());
    }
    std::sort(elements.begin(), elements.end());
    elements.erase(std::unique(elements.begin(), elements.end()),
                   elements.end());
    return elements;
  }

  static void SetSinceBaseline(const DamageResult& damage,
                               StructurePicture::Group* group) {
    for (size_t i = 0; i < damage.subjects.size(); ++i) {
      if (damage.subjects[i].name != group->name) continue;
      const GroupChange& change = damage.estimate.groups[i];
      group->change = change.change;
      group->lower95 = change.lower95;
      group->upper95 = change.upper95;
      group->probability = change.probability;
      group->changed = change.changed;
    }
  }

  static void SetAgainstModel(const FitSummary& summary, const GroupTerm& term,
                              StructurePicture::Group* group) {
    for (const ParameterEstimate& estimate : summary.parameters) {
      if (estimate.name != term.alpha.name) continue;
      group->change = estimate.value / term.present;
      if (!estimate.free) continue;
      group->lower95 = estimate.lower95 / term.present;
      group->upper95 = estimate.upper95 / term.present;
      group->changed = group->lower95 > 0.0 || group->upper95 < 0.0;
    }
  }

  void AddArrows(const std::string& name, const Vector& weights,
                 std::vector<StructurePicture::Arrow>* arrows) {
    const std::vector<std::string>& dofs = problem_.dynamics->model().dof_names;
    std::map<std::string, double> by_name;
    for (Eigen::Index i = 0; i < weights.size(); ++i) {
      if (weights[i] != 0.0) by_name[dofs[static_cast<size_t>(i)]] = weights[i];
    }
    if (by_name.empty() || places_.AddArrows(name, by_name, arrows) ||
        std::find(unplaced_.begin(), unplaced_.end(), name) !=
            unplaced_.end()) {
      return;
    }
    unplaced_.push_back(name);
  }

  Matrix AtNodes(const std::vector<std::string>& dofs,
                 const Vector& shape) const {
    Matrix at_nodes = Matrix::Zero(placed_.geometry.num_nodes(), 3);
    for (size_t i = 0; i < dofs.size(); ++i) {
      for (const DofPlaces::Place& place : places_.Of(dofs[i])) {
        at_nodes.row(place.node) +=
            shape[static_cast<Eigen::Index>(i)] * place.direction.transpose();
      }
    }
    return at_nodes;
  }

  const PlacedGeometry& placed_;
  const IdentificationProblem& problem_;
  const ReducedStructure* structure_;
  const DofPlaces places_;
  StructurePicture* picture_;
  std::vector<std::string> unplaced_;
};

}  // namespace

StructurePicture MakeStructurePicture(
    const PlacedGeometry& placed, const IdentificationProblem& problem,
    const ReducedStructure* structure, const FitSummary* summary,
    const IdentifiedModel* model, const DamageResult* damage, int num_modes) {
  StructurePicture picture;
  PictureMaker maker(placed, problem, structure, &picture);
  maker.AddGroups(summary, damage);
  maker.AddArrows();
  maker.AddModes(model, num_modes);
  return picture;
}

std::vector<int> ShownGroups(const StructurePicture& picture) {
  std::vector<int> shown(picture.geometry.elements.size(), -1);
  for (const auto& [mass, changed] :
       {std::pair(false, true), std::pair(true, true), std::pair(false, false),
        std::pair(true, false)}) {
    for (size_t g = 0; g < picture.groups.size(); ++g) {
      const StructurePicture::Group& group = picture.groups[g];
      if (group.is_mass != mass || group.changed != changed) continue;
      for (const int element : group.elements) {
        int& own = shown[static_cast<size_t>(element)];
        if (own < 0) own = static_cast<int>(g);
      }
    }
  }
  return shown;
}

}  // namespace pinode
