// Picture of a structure: its geometry, changes, modes and sensors.

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
struct FitSummary;
struct IdentificationProblem;
struct IdentifiedModel;
struct MergedModes;
struct PlaceOfShape;
struct ReducedStructure;

// Geometry with the places of the model's DOFs and groups in it.
struct PlacedGeometry {
  StructureGeometry geometry;
  // Place of a DOF: a node of the geometry by its name, a direction, and a
  // sign.
  struct Place {
    std::string node;
    int direction = 1;  // 1 to 3: along x, y, z
    double sign = 1.0;
  };
  // Places of DOFs that are not named "node.direction", by the DOF's name. A
  // DOF with several places, such as a floor, moves them together.
  std::map<std::string, std::vector<Place>> dofs;
  // Names of the element sets of groups, by the group's name. A group without
  // an entry has the set of its own name.
  std::map<std::string, std::vector<std::string>> groups;
};

// Data of a picture. Lengths are those of the geometry.
struct StructurePicture {
  StructureGeometry geometry;

  // Group whose elements are coloured.
  struct Group {
    std::string name;
    std::vector<int> elements;
    bool is_mass = false;
    // Change as a fraction of the previous value, and its 95 % interval. NaN:
    // unknown.
    double change = 0.0;
    double lower95 = 0.0, upper95 = 0.0;
    // Probability that the loss is above the threshold. NaN without a damage
    // analysis.
    double probability = 0.0;
    bool changed = false;  // True: a change was found.
  };
  std::vector<Group> groups;
  // True: changes are relative to baselines. False: relative to the initial
  // model.
  bool since_baseline = false;
  double threshold = 0.0;  // loss, as a fraction

  // Arrow at a node. `node` is an index, `direction` a unit vector.
  struct Arrow {
    std::string name;
    int node = 0;
    Eigen::Vector3d direction = Eigen::Vector3d::UnitX();
  };
  std::vector<Arrow> sensors;
  std::vector<Arrow> forces;          // measured
  std::vector<Arrow> unknown_forces;  // not measured

  // Mode shape to be drawn.
  struct Mode {
    double frequency_hz = 0.0;
    Matrix shape;  // nodes x 3, largest entry 1
  };
  std::vector<Mode> modes;

  // Parts that cannot be drawn, one sentence each.
  std::vector<std::string> notes;
};

// Makes the picture of a fit, with the first `num_modes` modes that move a
// node. The following arguments may be nullptr. `structure` is the
// finite-element model that was reduced. `summary` and `model` are the result
// of the fit; without them the picture shows the initial values. `damage` has
// the changes relative to baselines.
StructurePicture MakeStructurePicture(
    const PlacedGeometry& placed, const IdentificationProblem& problem,
    const ReducedStructure* structure, const FitSummary* summary,
    const IdentifiedModel* model, const DamageResult* damage, int num_modes);

// Makes the picture of modes that were identified from records alone, without
// groups. `sensors` are the places of the sensors. `places` are those of the
// shapes' entries, from ResolveDofs. If the places at a node do not determine
// its motion, the smallest motion that agrees with them is drawn. Nodes without
// places are at rest. The phases of shapes are rotated so that the shapes are
// as real as possible.
StructurePicture MakeModesPicture(const PlacedGeometry& placed,
                                  const std::vector<PlaceOfShape>& sensors,
                                  const std::vector<PlaceOfShape>& places,
                                  const MergedModes& merged);

// Returns the shapes at the nodes as MakeModesPicture draws them: one complex
// matrix per mode, nodes x 3, in the scale of the identified shape. Empty if a
// place is at no node.
std::vector<Eigen::MatrixXcd> MotionsOfNodes(
    const PlacedGeometry& placed, const std::vector<PlaceOfShape>& places,
    const MergedModes& merged);

// Returns for each element the index of the group whose colour it has; -1: it
// is in no group. In elements of several groups, changed groups precede
// unchanged ones, and stiffness groups precede mass groups.
std::vector<int> ShownGroups(const StructurePicture& picture);

// Returns the picture as an unstructured grid of VTK (.vtu, ASCII XML) for
// ParaView and other programs.
//
// - Cells have `group` (an index, -1 for none), `change`, `probability`,
//   `changed`, and `known` if there is a change, of the shown groups
//   (ShownGroups).
// - Cells also have `change_<index>` of groups that share elements with a shown
//   group.
// - Points have the mode shapes, `mode_1` and so on.
std::string FormatVtu(const StructurePicture& picture);

}  // namespace pinode

#endif  // PINODE_STUDY_PICTURE_STRUCTURE_PICTURE_H_
