// Drawing of a structure, for the still picture and the rotatable view.

#ifndef PINODE_REPORT_STRUCTURE_DRAWING_H_
#define PINODE_REPORT_STRUCTURE_DRAWING_H_

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/study/picture/structure_picture.h"

namespace pinode {

constexpr char kNoGroupColor[] = "#e3e7ea";
constexpr char kUnchangedColor[] = "#bcc7d0";
constexpr char kSensorColor[] = "#0b6e4f";
constexpr char kForceColor[] = "#6a4c93";
constexpr char kUnknownForceColor[] = "#c2185b";
// Half size of a marker, relative to the structure's size.
constexpr double kMarker = 0.014;

// Drawing in units of the structure's size around its middle.
struct StructureDrawing {
  struct Face {
    std::vector<int> nodes;
    int group = 0;            // 0: none, else the picture's plus one
    bool is_outside = false;  // of a solid, around it as seen from outside
  };
  Matrix positions;           // nodes that are drawn x 3
  std::vector<int> nodes;     // their places in the geometry
  std::vector<int> place_of;  // index of a geometry's node, -1: not drawn
  std::vector<Face> faces;
  std::vector<Face> lines;
  // Lines shorter than kMarker, by their first nodes, and points in a group.
  std::vector<Face> markers;
  std::vector<int> dots;  // nodes of elements without faces and lines
  std::vector<std::pair<int, int>> edges;
  std::vector<std::string> colors, told;  // without group, then per group
  // Label of a change.
  struct Mark {
    std::string text;
    int node = 0;
    std::string color;
  };
  std::vector<Mark> marks;
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  // View point: angles around `up`, and above the horizontal, in radians.
  double turn = -1.0, tilt = 0.32;
};

StructureDrawing DrawStructure(const StructurePicture& picture);

// Returns the still picture.
std::string DrawingSvg(const StructurePicture& picture,
                       const StructureDrawing& drawing);

}  // namespace pinode

#endif  // PINODE_REPORT_STRUCTURE_DRAWING_H_
