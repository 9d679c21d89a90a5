#include "pinode/structure/decks/deck_elements.h"

#include <string_view>

namespace pinode {
namespace {

// Corners come first, except in lines of three nodes.
constexpr DeckElementType kDeckElementTypes[] = {
    {"C3D4", ElementShape::kTetrahedron, 4, DeckElementKind::kOther},
    {"C3D10", ElementShape::kTetrahedron, 10, DeckElementKind::kOther},
    {"C3D5", ElementShape::kPyramid, 5, DeckElementKind::kOther},
    {"C3D6", ElementShape::kWedge, 6, DeckElementKind::kOther},
    {"C3D15", ElementShape::kWedge, 15, DeckElementKind::kOther},
    {"C3D8", ElementShape::kHexahedron, 8, DeckElementKind::kOther},
    {"C3D20", ElementShape::kHexahedron, 20, DeckElementKind::kOther},
    {"C3D27", ElementShape::kHexahedron, 27, DeckElementKind::kOther},
    {"SC6", ElementShape::kWedge, 6, DeckElementKind::kOther},
    {"SC8", ElementShape::kHexahedron, 8, DeckElementKind::kOther},
    {"S3", ElementShape::kTriangle, 3, DeckElementKind::kOther},
    {"S6", ElementShape::kTriangle, 6, DeckElementKind::kOther},
    {"STRI3", ElementShape::kTriangle, 3, DeckElementKind::kOther},
    {"STRI65", ElementShape::kTriangle, 6, DeckElementKind::kOther},
    {"M3D3", ElementShape::kTriangle, 3, DeckElementKind::kOther},
    {"M3D6", ElementShape::kTriangle, 6, DeckElementKind::kOther},
    {"CPS3", ElementShape::kTriangle, 3, DeckElementKind::kOther},
    {"CPS6", ElementShape::kTriangle, 6, DeckElementKind::kOther},
    {"CPE3", ElementShape::kTriangle, 3, DeckElementKind::kOther},
    {"CPE6", ElementShape::kTriangle, 6, DeckElementKind::kOther},
    {"S4", ElementShape::kQuadrilateral, 4, DeckElementKind::kOther},
    {"S8", ElementShape::kQuadrilateral, 8, DeckElementKind::kOther},
    {"S9", ElementShape::kQuadrilateral, 9, DeckElementKind::kOther},
    {"M3D4", ElementShape::kQuadrilateral, 4, DeckElementKind::kOther},
    {"M3D8", ElementShape::kQuadrilateral, 8, DeckElementKind::kOther},
    {"CPS4", ElementShape::kQuadrilateral, 4, DeckElementKind::kOther},
    {"CPS8", ElementShape::kQuadrilateral, 8, DeckElementKind::kOther},
    {"CPE4", ElementShape::kQuadrilateral, 4, DeckElementKind::kOther},
    {"CPE8", ElementShape::kQuadrilateral, 8, DeckElementKind::kOther},
    {"B21", ElementShape::kLine, 2, DeckElementKind::kOther},
    {"B22", ElementShape::kLine, 3, DeckElementKind::kOther},
    {"B23", ElementShape::kLine, 2, DeckElementKind::kOther},
    {"B31", ElementShape::kLine, 2, DeckElementKind::kOther},
    {"B32", ElementShape::kLine, 3, DeckElementKind::kOther},
    {"B33", ElementShape::kLine, 2, DeckElementKind::kOther},
    {"PIPE31", ElementShape::kLine, 2, DeckElementKind::kOther},
    {"PIPE32", ElementShape::kLine, 3, DeckElementKind::kOther},
    {"T2D2", ElementShape::kLine, 2, DeckElementKind::kOther},
    {"T2D3", ElementShape::kLine, 3, DeckElementKind::kOther},
    {"T3D2", ElementShape::kLine, 2, DeckElementKind::kOther},
    {"T3D3", ElementShape::kLine, 3, DeckElementKind::kOther},
    {"SPRINGA", ElementShape::kLine, 2, DeckElementKind::kSpringOfItsLength},
    {"SPRING2", ElementShape::kLine, 2, DeckElementKind::kSpringOfDirections},
    {"DASHPOTA", ElementShape::kLine, 2, DeckElementKind::kDashpot},
    {"DASHPOT2", ElementShape::kLine, 2, DeckElementKind::kDashpot},
    {"GAPUNI", ElementShape::kLine, 2, DeckElementKind::kGap},
    {"CONN3D2", ElementShape::kLine, 2, DeckElementKind::kOther},
    {"MASS", ElementShape::kPoint, 1, DeckElementKind::kMass},
    {"ROTARYI", ElementShape::kPoint, 1, DeckElementKind::kMass},
    {"SPRING1", ElementShape::kPoint, 1, DeckElementKind::kSpringOfDirections},
    {"DASHPOT1", ElementShape::kPoint, 1, DeckElementKind::kDashpot},
};

}  // namespace

bool DeckElementType::HasStiffness() const {
  return kind != DeckElementKind::kMass && kind != DeckElementKind::kDashpot;
}

bool DeckElementType::HasMass() const {
  return kind == DeckElementKind::kOther || kind == DeckElementKind::kMass;
}

const DeckElementType* FindDeckElementType(const std::string& name) {
  const DeckElementType* best = nullptr;
  for (const DeckElementType& type : kDeckElementTypes) {
    const std::string_view known(type.name);
    if (name.compare(0, known.size(), known) != 0) continue;
    const bool digit = name.size() > known.size() &&
                       name[known.size()] >= '0' && name[known.size()] <= '9';
    if (digit) continue;
    if (best == nullptr || known.size() > std::string_view(best->name).size()) {
      best = &type;
    }
  }
  return best;
}

}  // namespace pinode
