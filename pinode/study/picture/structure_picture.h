// A structure as it is drawn: where it is, what changed, what moves, where it
// was measured.

#ifndef PINODE_STUDY_PICTURE_STRUCTURE_PICTURE_H_
#define PINODE_STUDY_PICTURE_STRUCTURE_PICTURE_H_

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/structure/model/geometry.h"

namespace pinode {

struct DamageResult;
struct IdentificationProblem;
struct IdentificationSummary;
struct IdentifiedModel;
struct MergedModes;
struct PlaceOfShape;
struct ReducedStructure;

// A geometry beside a model: which of its nodes and elements are the model's
// DOFs and groups.
struct PlacedGeometry {
  StructureGeometry geometry;
  // Nodes and directions of DOFs that are not called "node.direction"; several,
  // as of a floor, move together. Names are those of the geometry.
  struct Place {
    std::string node;
    int direction = 1;  // 1 to 3: along x, y, z
    double sign = 1.0;
  };
  std::map<std::string, std::vector<Place>> dofs;
  // Element sets of groups; a group without an entry has the set of its name.
  std::map<std::string, std::vector<std::string>> groups;
};

struct StructurePicture {
  StructureGeometry geometry;

  // A group with elements to colour.
  struct Group {
    std::string name;
    std::vector<int> elements;
    bool is_mass = false;
    // Fraction of what was there, and its 95 % interval; NaN: not known.
    double change = 0.0;
    double lower95 = 0.0, upper95 = 0.0;
    // P(loss > threshold); NaN where no change was asked for.
    double probability = 0.0;
    bool changed = false;  // found to have
  };
  std::vector<Group> groups;
  // Whether changes are since a baseline; else against the model.
  bool since_baseline = false;
  double threshold = 0.0;  // of the probability

  // At a node, along a unit vector.
  struct Arrow {
    std::string name;
    int node = 0;
    Eigen::Vector3d direction = Eigen::Vector3d::UnitX();
  };
  std::vector<Arrow> sensors;
  std::vector<Arrow> forces;          // measured ones
  std::vector<Arrow> unknown_forces;  // that nobody measured

  struct Mode {
    double frequency_hz = 0.0;
    Matrix shape;  // nodes x 3, the largest entry being one
  };
  std::vector<Mode> modes;

  // What cannot be drawn, one sentence each.
  std::vector<std::string> notes;
};

// `structure`: the finite-element model of which the problem's is a reduction,
// or nullptr; `model`: what was found (nullptr: the problem as it is) with
// `summary` of the fit; `damage`: what changed since a baseline, or nullptr. At
// most `num_modes` modes that move a node.
StructurePicture MakeStructurePicture(
    const PlacedGeometry& placed, const IdentificationProblem& problem,
    const ReducedStructure* structure, const FitSummary* summary,
    const IdentifiedModel* model, const DamageResult* damage, int num_modes);

// Modes that were found from records alone, without groups: `sensors` as they
// were, `places` of the shapes' entries as ResolveDofs leaves both. What the
// places at a node leave open of its motion is drawn as the least that agrees
// with them; nodes without any are at rest. Shapes are turned to be as real as
// they can be.
StructurePicture MakeModesPicture(const PlacedGeometry& placed,
                                  const std::vector<PlaceOfShape>& sensors,
                                  const std::vector<PlaceOfShape>& places,
                                  const MergedModes& merged);

// Shapes at the nodes of a geometry, as MakeModesPicture draws them: of each
// mode nodes x 3, complex, in the scale of its entries. Empty where a place is
// at no node.
std::vector<Eigen::MatrixXcd> MotionsOfNodes(
    const PlacedGeometry& placed, const std::vector<PlaceOfShape>& places,
    const MergedModes& merged);

// Of each element the group that it is shown as, -1 where it is of none: one of
// stiffness over one of mass, but what has changed over what has not.
std::vector<int> ShownGroups(const StructurePicture& picture);

// The picture as an unstructured grid of VTK (.vtu, ASCII XML), which ParaView
// and others read: cells with `group` (an index, -1 for none), `change`,
// `probability`, `changed`, and `known` where there is a change, of the groups
// that are shown (ShownGroups), and `change_<index>` of those that share
// elements with what is shown in their place; points with the mode shapes,
// `mode_1` and so on.
std::string FormatVtu(const StructurePicture& picture);

}  // namespace pinode

#endif  // PINODE_STUDY_PICTURE_STRUCTURE_PICTURE_H_
