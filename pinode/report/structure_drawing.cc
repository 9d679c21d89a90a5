#include "pinode/report/structure_drawing.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <utility>

#include "pinode/base/strings.h"
#include "pinode/report/structure_view.h"

namespace pinode {
namespace {

std::string SignedPercent(double fraction) {
  char text[32];
  std::snprintf(text, sizeof(text), "%+.1f %%", 100.0 * fraction);
  return text;
}

std::string ProbabilityText(double probability) {
  if (probability > 0.995) return "over 0.99";
  if (probability < 0.005) return "under 0.01";
  char text[16];
  std::snprintf(text, sizeof(text), "%.2f", probability);
  return text;
}

constexpr char kLossText[] = "#8f2a00";
constexpr char kGainText[] = "#00426f";

// Returns the colour: losses from sand to rust, gains from sky to sea.
std::string ColorOf(const StructurePicture::Group& group) {
  if (!group.changed || !std::isfinite(group.change)) return kUnchangedColor;
  const double share = std::min(1.0, std::abs(group.change) / 0.2);
  const std::array<int, 3> light = group.change < 0.0
                                       ? std::array<int, 3>{242, 172, 128}
                                       : std::array<int, 3>{156, 199, 232};
  const std::array<int, 3> dark = group.change < 0.0
                                      ? std::array<int, 3>{178, 52, 0}
                                      : std::array<int, 3>{0, 82, 140};
  char text[16];
  const auto mix = [&](size_t i) {
    return static_cast<int>(
        std::lround(light[i] + share * (dark[i] - light[i])));
  };
  std::snprintf(text, sizeof(text), "#%02x%02x%02x", mix(0), mix(1), mix(2));
  return text;
}

class DrawingMaker {
 public:
  explicit DrawingMaker(const StructurePicture& picture)
      : picture_(picture), geometry_(picture.geometry) {}

  StructureDrawing Make() {
    NameGroups();
    CollectFaces();
    CollectNodes();
    MarkShortLines();
    CollectEdges();
    CollectMarks();
    return std::move(drawing_);
  }

 private:
  void NameGroups() {
    drawing_.colors.emplace_back(picture_.groups.empty() ? kUnchangedColor
                                                         : kNoGroupColor);
    drawing_.told.emplace_back(picture_.groups.empty() ? ""
                                                       : "Not in any group.");
    group_of_ = ShownGroups(picture_);
    for (int& group : group_of_) ++group;
    for (const StructurePicture::Group& group : picture_.groups) {
      drawing_.colors.push_back(ColorOf(group));
      drawing_.told.push_back(ChangeText(picture_, group));
    }
  }

  // Collects faces; those inside of solids are invisible.
  void CollectFaces() {
    std::map<std::vector<int>, int> count;
    const auto key = [](std::vector<int> nodes) {
      std::sort(nodes.begin(), nodes.end());
      return nodes;
    };
    std::vector<StructureDrawing::Face> all;
    for (size_t e = 0; e < geometry_.elements.size(); ++e) {
      const StructureGeometry::Element& element = geometry_.elements[e];
      for (const std::vector<int>& corners : FacesOf(element.shape)) {
        StructureDrawing::Face face;
        face.group = group_of_[e];
        for (const int corner : corners) {
          face.nodes.push_back(element.nodes[static_cast<size_t>(corner)]);
        }
        if (corners.size() == 2) drawing_.lines.push_back(face);
        if (corners.size() == 1 && face.group > 0) {
          drawing_.markers.push_back(face);
        }
        if (corners.size() < 3) continue;
        if (FacesOf(element.shape).size() > 1) TurnOutside(element, &face);
        ++count[key(face.nodes)];
        all.push_back(std::move(face));
      }
    }
    for (StructureDrawing::Face& face : all) {
      if (count[key(face.nodes)] == 1)
        drawing_.faces.push_back(std::move(face));
    }
  }

  // Turns a face outward, for either orientation of the deck's element.
  void TurnOutside(const StructureGeometry::Element& element,
                   StructureDrawing::Face* face) const {
    const Eigen::Vector3d middle = MiddleOf(element.nodes);
    const auto at = [this, face](size_t i) {
      return Eigen::Vector3d(
          geometry_.positions.row(face->nodes[i]).transpose());
    };
    const Eigen::Vector3d normal = (at(1) - at(0)).cross(at(2) - at(0));
    if (normal.dot(MiddleOf(face->nodes) - middle) < 0.0) {
      std::reverse(face->nodes.begin(), face->nodes.end());
    }
    face->is_outside = true;
  }

  Eigen::Vector3d MiddleOf(const std::vector<int>& nodes) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const int node : nodes) {
      sum += geometry_.positions.row(node).transpose();
    }
    return sum / static_cast<double>(nodes.size());
  }

  void CollectNodes() {
    drawing_.place_of.assign(static_cast<size_t>(geometry_.num_nodes()), -1);
    const auto use = [this](int* node) {
      int& place = drawing_.place_of[static_cast<size_t>(*node)];
      if (place < 0) {
        place = static_cast<int>(drawing_.nodes.size());
        drawing_.nodes.push_back(*node);
      }
      *node = place;
    };
    for (StructureDrawing::Face& face : drawing_.faces) {
      for (int& node : face.nodes) use(&node);
    }
    for (StructureDrawing::Face& line : drawing_.lines) {
      for (int& node : line.nodes) use(&node);
    }
    for (StructureDrawing::Face& point : drawing_.markers) use(&point.nodes[0]);
    for (const auto* arrows :
         {&picture_.sensors, &picture_.forces, &picture_.unknown_forces}) {
      for (const StructurePicture::Arrow& arrow : *arrows) {
        int node = arrow.node;
        use(&node);
      }
    }
    if (drawing_.faces.empty() && drawing_.lines.empty()) {
      for (int n = 0; n < geometry_.num_nodes(); ++n) {
        int node = n;
        use(&node);
        drawing_.dots.push_back(node);
      }
    }
    const auto count = static_cast<Eigen::Index>(drawing_.nodes.size());
    Matrix& positions = drawing_.positions;
    positions.resize(count, 3);
    for (Eigen::Index i = 0; i < count; ++i) {
      positions.row(i) =
          geometry_.positions.row(drawing_.nodes[static_cast<size_t>(i)]);
    }
    if (count == 0) return;
    const Eigen::RowVector3d low = positions.colwise().minCoeff();
    const Eigen::RowVector3d high = positions.colwise().maxCoeff();
    const double size = (high - low).norm();
    positions.rowwise() -= 0.5 * (low + high);
    if (size > 0.0) positions /= size;
    // A structure in a plane is viewed from the front.
    if (high[2] - low[2] <= 1e-9 * size) {
      drawing_.up = Eigen::Vector3d::UnitY();
      drawing_.turn = 0.0;
      drawing_.tilt = 0.0;
    }
  }

  // Marks springs between nodes at one place, which would be invisible.
  void MarkShortLines() {
    std::vector<StructureDrawing::Face> lines;
    for (StructureDrawing::Face& line : drawing_.lines) {
      const double length = (drawing_.positions.row(line.nodes[0]) -
                             drawing_.positions.row(line.nodes[1]))
                                .norm();
      const bool is_short = length < kMarker;
      if (is_short) line.nodes.resize(1);
      (is_short ? drawing_.markers : lines).push_back(std::move(line));
    }
    drawing_.lines = std::move(lines);
  }

  void CollectEdges() {
    std::set<std::pair<int, int>> edges;
    for (const StructureDrawing::Face& face : drawing_.faces) {
      for (size_t i = 0; i < face.nodes.size(); ++i) {
        const int a = face.nodes[i];
        const int b = face.nodes[(i + 1) % face.nodes.size()];
        edges.emplace(std::min(a, b), std::max(a, b));
      }
    }
    drawing_.edges.assign(edges.begin(), edges.end());
  }

  // Puts the mark at the element nearest to the middle of the group.
  void CollectMarks() {
    for (const StructurePicture::Group& group : picture_.groups) {
      if (!group.changed || group.elements.empty()) continue;
      std::vector<Eigen::Vector3d> middles;
      Eigen::Vector3d middle = Eigen::Vector3d::Zero();
      for (const int e : group.elements) {
        middles.push_back(
            MiddleOf(geometry_.elements[static_cast<size_t>(e)].nodes));
        middle += middles.back() / static_cast<double>(group.elements.size());
      }
      size_t nearest = 0;
      for (size_t i = 1; i < middles.size(); ++i) {
        if ((middles[i] - middle).norm() <
            0.999 * (middles[nearest] - middle).norm()) {
          nearest = i;
        }
      }
      for (const int node :
           geometry_.elements[static_cast<size_t>(group.elements[nearest])]
               .nodes) {
        const int place = drawing_.place_of[static_cast<size_t>(node)];
        if (place < 0) continue;
        drawing_.marks.push_back(
            {group.name + " " + SignedPercent(group.change), place,
             group.change < 0.0 ? kLossText : kGainText});
        break;
      }
    }
  }

  const StructurePicture& picture_;
  const StructureGeometry& geometry_;
  std::vector<int> group_of_;
  StructureDrawing drawing_;
};

}  // namespace

std::string ChangeText(const StructurePicture& picture,
                       const StructurePicture::Group& group) {
  if (!std::isfinite(group.change)) return group.name + ": not examined";
  std::string text = group.name + ": " + SignedPercent(group.change);
  if (!picture.since_baseline) text += " relative to the initial model";
  if (std::isfinite(group.lower95) && std::isfinite(group.upper95)) {
    text += " (95 %: " + SignedPercent(group.lower95) + " to " +
            SignedPercent(group.upper95) + ")";
  }
  if (std::isfinite(group.probability)) {
    text += ", probability of a loss beyond " +
            FormatNumber(100.0 * picture.threshold, 3) +
            " %: " + ProbabilityText(group.probability);
  }
  if (!group.changed) {
    text += picture.since_baseline ? "; no significant change" : "";
  }
  return text;
}

StructureDrawing DrawStructure(const StructurePicture& picture) {
  return DrawingMaker(picture).Make();
}

}  // namespace pinode
