#include <cmath>
#include <string>
#include <vector>

#include "pinode/base/strings.h"
#include "pinode/study/picture/structure_picture.h"

namespace pinode {
namespace {

// Cell types of VTK, in the order of ElementShape.
constexpr int kVtkTypes[] = {1, 3, 5, 9, 10, 14, 13, 12};

class VtuText {
 public:
  void Open(const std::string& tag) { text_ += "<" + tag + ">\n"; }
  void Close(const std::string& tag) { text_ += "</" + tag + ">\n"; }

  // Adds an array of `values` with `components` each.
  template <typename Values>
  void Array(const std::string& type, const std::string& name, int components,
             const Values& values) {
    text_ += "<DataArray type=\"" + type + "\" Name=\"" + name +
             "\" NumberOfComponents=\"" + std::to_string(components) +
             "\" format=\"ascii\">\n";
    int column = 0;
    for (const auto value : values) {
      text_ += FormatNumber(static_cast<double>(value), 9);
      text_ += ++column % 12 == 0 ? '\n' : ' ';
    }
    text_ += "\n</DataArray>\n";
  }

  void Add(const std::string& text) { text_ += text; }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

std::vector<double> RowByRow(const Matrix& matrix) {
  std::vector<double> values;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index k = 0; k < matrix.cols(); ++k) {
      values.push_back(matrix(i, k));
    }
  }
  return values;
}

void AddCells(const StructureGeometry& geometry, VtuText* text) {
  std::vector<int> connectivity, offsets, types;
  for (const StructureGeometry::Element& element : geometry.elements) {
    std::vector<int> nodes = element.nodes;
    // VTK orders the triangle below a wedge in the opposite sense.
    if (element.shape == ElementShape::kWedge) {
      nodes = {nodes[0], nodes[2], nodes[1], nodes[3], nodes[5], nodes[4]};
    }
    connectivity.insert(connectivity.end(), nodes.begin(), nodes.end());
    offsets.push_back(static_cast<int>(connectivity.size()));
    types.push_back(kVtkTypes[static_cast<size_t>(element.shape)]);
  }
  text->Open("Cells");
  text->Array("Int32", "connectivity", 1, connectivity);
  text->Array("Int32", "offsets", 1, offsets);
  text->Array("UInt8", "types", 1, types);
  text->Close("Cells");
}

// Adds the changes of one group whose elements are shared: those may show
// another group's change.
void AddHiddenChanges(const StructurePicture& picture,
                      const std::vector<int>& shown, VtuText* text) {
  for (size_t g = 0; g < picture.groups.size(); ++g) {
    const StructurePicture::Group& own = picture.groups[g];
    std::vector<double> change(shown.size(), 0.0);
    bool is_hidden = false;
    for (const int element : own.elements) {
      const auto e = static_cast<size_t>(element);
      if (shown[e] != static_cast<int>(g)) is_hidden = true;
      change[e] = own.change;
    }
    if (is_hidden && std::isfinite(own.change)) {
      text->Array("Float64", "change_" + std::to_string(g), 1, change);
    }
  }
}

void AddCellData(const StructurePicture& picture, VtuText* text) {
  const std::vector<int> group = ShownGroups(picture);
  const size_t count = group.size();
  // Readers of ASCII files do not accept "nan": unknown values are zero, and
  // marked by `known`.
  std::vector<int> changed(count, 0), known(count, 0);
  std::vector<double> change(count, 0.0), probability(count, 0.0);
  for (size_t e = 0; e < count; ++e) {
    if (group[e] < 0) continue;
    const StructurePicture::Group& own =
        picture.groups[static_cast<size_t>(group[e])];
    known[e] = std::isfinite(own.change) ? 1 : 0;
    change[e] = known[e] == 1 ? own.change : 0.0;
    probability[e] = std::isfinite(own.probability) ? own.probability : 0.0;
    changed[e] = own.changed ? 1 : 0;
  }
  text->Open("CellData Scalars=\"change\"");
  text->Array("Int32", "group", 1, group);
  text->Array("Float64", "change", 1, change);
  text->Array("Float64", "probability", 1, probability);
  text->Array("Int32", "changed", 1, changed);
  text->Array("Int32", "known", 1, known);
  AddHiddenChanges(picture, group, text);
  text->Close("CellData");
}

}  // namespace

std::string FormatVtu(const StructurePicture& picture) {
  const StructureGeometry& geometry = picture.geometry;
  VtuText text;
  text.Add("<?xml version=\"1.0\"?>\n<!-- groups:");
  for (size_t g = 0; g < picture.groups.size(); ++g) {
    std::string name = picture.groups[g].name;
    // XML comments must not contain "--"; the second pass is for "---".
    for (int i = 0; i < 2; ++i) ReplaceAll("--", "- -", &name);
    text.Add(" " + std::to_string(g) + " " + name);
  }
  text.Add(
      " -->\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" "
      "byte_order=\"LittleEndian\">\n");
  text.Open("UnstructuredGrid");
  text.Open("Piece NumberOfPoints=\"" + std::to_string(geometry.num_nodes()) +
            "\" NumberOfCells=\"" + std::to_string(geometry.elements.size()) +
            "\"");
  text.Open("Points");
  text.Array("Float64", "Points", 3, RowByRow(geometry.positions));
  text.Close("Points");
  AddCells(geometry, &text);
  AddCellData(picture, &text);
  text.Open("PointData");
  for (size_t m = 0; m < picture.modes.size(); ++m) {
    text.Array("Float64", "mode_" + std::to_string(m + 1), 3,
               RowByRow(picture.modes[m].shape));
  }
  text.Close("PointData");
  text.Close("Piece");
  text.Close("UnstructuredGrid");
  text.Close("VTKFile");
  return text.text();
}

}  // namespace pinode
