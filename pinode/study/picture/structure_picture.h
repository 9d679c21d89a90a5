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

// Geometry of a model, with the nodes and elements of the model's DOFs and
// groups.
struct PlacedGeometry {
  StructureGeometry geometry;
  // Nodes and directions of DOFs that are not called "node.direction". Several
  // nodes, as of a floor, move together. Names are those of the geometry.
  struct Place {
    std::string node;
    int direction = 1;  // 1 to 3: along x, y, z
    double sign = 1.0;
  };
  std::map<std::string, std::vector<Place>> dofs;
  // Element sets of groups. A group without an entry has the set of its name.
  std::map<std::string, std::vector<std::string>> groups;
};

struct StructurePicture {
  StructureGeometry geometry;

  // Group with elements to colour.
  struct Group {
    std::string name;
    std::vector<int> elements;
    bool is_mass = false;
    // Change as a fraction of the previous value, and its 95 % interval; NaN:
    // not known.
    double change = 0.0;
    double lower95 = 0.0, upper95 = 0.0;
    // Probability P(loss > threshold); NaN without a damage analysis.
    double probability = 0.0;
    bool changed = false;  // found to have
  };
  std::vector<Group> groups;
  // True: changes are relative to a baseline; else to the model.
  bool since_baseline = false;
  double threshold = 0.0;  // of the probability

  // Arrow at a node, along a unit vector.
  struct Arrow {
    std::string name;
    int node = 0;
    Eigen::Vector3d direction = Eigen::Vector3d::UnitX();
  };
  std::vector<Arrow> sensors;
  std::vector<Arrow> forces;          // measured ones
  std::vector<Arrow> unknown_forces;  // not measured

  struct Mode {
    double frequency_hz = 0.0;
    Matrix shape;  // nodes x 3, the largest entry is one
  };
  std::vector<Mode> modes;

  // Parts that cannot be drawn, one sentence each.
  std::vector<std::string> notes;
};

// Makes the picture with at most `num_modes` modes that move a node.
// `structure`: the finite-element model of which the problem's is a reduction,
// or nullptr. `model`: the result (nullptr: the problem's initial values) with
// `summary` of the fit. `damage`: changes since a baseline, or nullptr.
StructurePicture MakeStructurePicture(
    const PlacedGeometry& placed, const IdentificationProblem& problem,
    const ReducedStructure* structure, const FitSummary* summary,
    const IdentifiedModel* model, const DamageResult* damage, int num_modes);

// Makes the picture of modes identified from records alone, without groups.
// `sensors` are as they were, `places` of the shapes' entries as returned by
// ResolveDofs. If the places at a node do not determine its motion, the
// smallest motion that agrees with them is drawn; nodes without places are at
// rest. Shapes are rotated to be as real as possible.
StructurePicture MakeModesPicture(const PlacedGeometry& placed,
                                  const std::vector<PlaceOfShape>& sensors,
                                  const std::vector<PlaceOfShape>& places,
                                  const MergedModes& merged);

// Returns shapes at the nodes of a geometry, as MakeModesPicture draws them:
// per mode nodes x 3, complex, in the scale of its entries. Empty if a place is
// at no node.
std::vector<Eigen::MatrixXcd> MotionsOfNodes(
    const PlacedGeometry& placed, const std::vector<PlaceOfShape>& places,
    const MergedModes& merged);

// Returns for each element the group that it is shown as, -1 if it is in no
// group. A group of stiffness precedes one of mass, but a changed one precedes
// an unchanged one.
std::vector<int> ShownGroups(const StructurePicture& picture);

// Returns the picture as an unstructured grid of VTK (.vtu, ASCII XML), which
// ParaView and other programs read.
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
