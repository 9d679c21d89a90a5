#include "pinode/app/deck_view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace pinode {
namespace {

using Json = nlohmann::ordered_json;

TEST(DeckView, HasEachEdgeOnceInAUnitBox) {
  StructureGeometry geometry;
  geometry.node_names = {"1", "2", "3", "4", "7"};
  geometry.positions.resize(5, 3);
  geometry.positions << 10, 0, 0, 14, 0, 0, 14, 2, 0, 10, 2, 0, 10, 0, 8;
  // A plate, a column on its corner, and an edge of the plate as a beam.
  geometry.elements = {{ElementShape::kQuadrilateral, {0, 1, 2, 3}},
                       {ElementShape::kLine, {0, 4}},
                       {ElementShape::kLine, {1, 0}},
                       {ElementShape::kPoint, {4}}};
  const Json json = DeckView(geometry);
  EXPECT_EQ(json["names"], Json({"1", "2", "3", "4", "7"}));
  EXPECT_EQ(json["edges"], Json({0, 1, 0, 3, 0, 4, 1, 2, 2, 3}));
  const auto positions = json["positions"].get<std::vector<double>>();
  ASSERT_EQ(positions.size(), 15u);
  // Half the largest extent, 4, is 1.
  EXPECT_DOUBLE_EQ(positions[0], -0.5);
  EXPECT_DOUBLE_EQ(positions[2], -1.0);
  EXPECT_DOUBLE_EQ(positions[14], 1.0);
}

TEST(DeckView, ReadsTheFrame) {
  const std::string deck =
      std::string(PINODE_SOURCE_DIR) + "/data/frame/frame.inp";
  Json json;
  std::string error;
  ASSERT_TRUE(ReadDeckView(deck, &json, &error)) << error;
  const auto names = json["names"].get<std::vector<std::string>>();
  EXPECT_NE(std::find(names.begin(), names.end(), "1051"), names.end());
  EXPECT_EQ(json["positions"].size(), 3 * names.size());
  EXPECT_GT(json["edges"].size(), names.size());
  EXPECT_FALSE(ReadDeckView(deck + ".none", &json, &error));
  EXPECT_FALSE(error.empty());
}

}  // namespace
}  // namespace pinode
