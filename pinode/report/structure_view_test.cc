#include "pinode/report/structure_view.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/constants.h"
#include "pinode/report/structure_drawing.h"
#include "pinode/report/three_packed.h"
#include "tests/support/report_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// Two cubes on each other and a bar, with a group each.
StructurePicture TwoCubes() {
  StructurePicture picture;
  StructureGeometry& geometry = picture.geometry;
  geometry.positions.resize(12, 3);
  for (int i = 0; i < 12; ++i) {
    const int corner = i % 4;
    geometry.node_names.push_back(std::to_string(i + 1));
    geometry.positions.row(i) << (corner == 1 || corner == 2 ? 1.0 : 0.0),
        (corner >= 2 ? 1.0 : 0.0), i / 4;
  }
  geometry.elements = {{ElementShape::kHexahedron, {0, 1, 2, 3, 4, 5, 6, 7}},
                       {ElementShape::kHexahedron, {4, 5, 6, 7, 8, 9, 10, 11}},
                       {ElementShape::kLine, {0, 10}}};
  picture.since_baseline = true;
  picture.threshold = 0.05;
  for (int g = 0; g < 3; ++g) {
    StructurePicture::Group group;
    group.name = "k<" + std::to_string(g + 1) + ">";
    group.elements = {g};
    group.change = group.lower95 = group.upper95 = kNaN;
    group.probability = kNaN;
    picture.groups.push_back(group);
  }
  picture.groups[1].change = -0.1;
  picture.groups[1].lower95 = -0.12;
  picture.groups[1].upper95 = -0.08;
  picture.groups[1].probability = 0.98;
  picture.groups[1].changed = true;
  picture.sensors.push_back({"a</script>1", 8, Eigen::Vector3d::UnitX()});
  StructurePicture::Mode mode;
  mode.frequency_hz = 2.5;
  mode.shape = Matrix::Zero(12, 3);
  mode.shape.bottomRows(4).col(0).setOnes();
  picture.modes.push_back(mode);
  return picture;
}

int Occurrences(const std::string& part, const std::string& text) {
  int count = 0;
  for (size_t at = text.find(part); at != std::string::npos;
       at = text.find(part, at + part.size())) {
    ++count;
  }
  return count;
}

TEST(StructureViewTest, ChangesInWords) {
  const StructurePicture picture = TwoCubes();
  EXPECT_EQ(ChangeText(picture, picture.groups[1]),
            "k<2>: -10.0 % (95 %: -12.0 % to -8.0 %), probability of a loss "
            "beyond 5 %: 0.98");
  EXPECT_EQ(ChangeText(picture, picture.groups[0]), "k<1>: not examined");
}

TEST(StructureViewTest, StillPicture) {
  const std::string svg = StructureSvg(TwoCubes());
  EXPECT_EQ(testing::FindHtmlFault(svg), "");
  // Five of ten outside faces point towards the reader; a bar has two strokes,
  // an arrow has one with its head.
  EXPECT_EQ(Occurrences("<path", svg), 5 + 2 + 2);
  // A sensor, and what changed.
  EXPECT_EQ(Occurrences("<text", svg), 2);
  EXPECT_THAT(svg, HasSubstr(">k&lt;2&gt; -10.0 %<"));
  EXPECT_THAT(svg, HasSubstr("a&lt;/script&gt;1"));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
}

// Sensors along three axes of one node have three names beside each other.
TEST(StructureViewTest, NamesDoNotLieOverEachOther) {
  StructurePicture picture = TwoCubes();
  picture.sensors.clear();
  for (int i = 0; i < 6; ++i) {
    picture.sensors.push_back({"channel", 8, Eigen::Vector3d::UnitX()});
  }
  const std::string svg = StructureSvg(picture);
  EXPECT_EQ(testing::FindHtmlFault(svg), "");
  std::vector<double> lines;
  for (size_t at = svg.find("<text x="); at != std::string::npos;
       at = svg.find("<text x=", at + 1)) {
    const size_t y = svg.find(" y=\"", at) + 4;
    lines.push_back(std::stod(svg.substr(y)));
  }
  ASSERT_EQ(lines.size(), 7u);
  std::sort(lines.begin(), lines.end() - 1);
  for (size_t i = 1; i < 6; ++i) EXPECT_GE(lines[i] - lines[i - 1], 13.0);
}

TEST(StructureViewTest, SectionHoldsAllThatItNeeds) {
  const std::string html = StructureSection(TwoCubes());
  // Names end no script.
  EXPECT_EQ(Occurrences("</script>", html), 3);
  EXPECT_THAT(html, HasSubstr("a<\\/script>1"));
  EXPECT_THAT(html, HasSubstr("mode 1, 2.5"));
  EXPECT_THAT(html, HasSubstr("beyond 5 %: 0.98"));
  EXPECT_THAT(html, HasSubstr(ThreePacked()));
  // The name space of the still picture.
  EXPECT_EQ(Occurrences("http", html), 1);
  EXPECT_THAT(html, Not(HasSubstr("src=")));
  // 20 triangles outside, of three nodes each.
  const size_t at = html.find("\"triangles\":[");
  ASSERT_NE(at, std::string::npos);
  const std::string list = html.substr(at, html.find(']', at) - at);
  EXPECT_EQ(Occurrences(",", list), 59);
}

// A force that nobody measured has a colour of its own, still and moving.
TEST(StructureViewTest, UnmeasuredForcesAreArrows) {
  StructurePicture picture = TwoCubes();
  const std::string before = StructureSvg(picture);
  EXPECT_THAT(before, Not(HasSubstr(kUnknownForceColor)));
  EXPECT_THAT(StructureSection(picture), HasSubstr("\"unknown_forces\":[]"));
  picture.unknown_forces.push_back(
      {"gust", 9, Eigen::Vector3d(-1.0, 0.0, 0.0)});
  const std::string svg = StructureSvg(picture);
  EXPECT_EQ(testing::FindHtmlFault(svg), "");
  // An arrow with its head.
  EXPECT_EQ(Occurrences("<path", svg), Occurrences("<path", before) + 2);
  EXPECT_THAT(svg, HasSubstr(std::string("stroke=\"") + kUnknownForceColor));
  EXPECT_THAT(svg, HasSubstr(">gust<"));
  EXPECT_THAT(StructureSection(picture),
              HasSubstr("\"unknown_forces\":[{\"direction\":[-1.0,0.0,0.0],"
                        "\"name\":\"gust\",\"node\":9}]"));
}

// Elements without length, or points, show their loss as well.
TEST(StructureViewTest, ElementsWithoutLengthAreMarkers) {
  StructurePicture picture = TwoCubes();
  const std::string before = StructureSvg(picture);
  EXPECT_THAT(before, Not(HasSubstr("marker")));
  picture.modes.clear();
  picture.geometry.positions.conservativeResize(13, 3);
  picture.geometry.positions.row(12) = picture.geometry.positions.row(10);
  picture.geometry.node_names.push_back("13");
  picture.geometry.elements.push_back({ElementShape::kLine, {10, 12}});
  picture.geometry.elements.push_back({ElementShape::kPoint, {3}});
  picture.geometry.elements.push_back({ElementShape::kPoint, {4}});
  picture.groups[2].elements = {2, 3, 4};  // not the last
  const StructureDrawing drawing = DrawStructure(picture);
  EXPECT_EQ(drawing.lines.size(), 1u);
  ASSERT_EQ(drawing.markers.size(), 2u);
  EXPECT_EQ(drawing.markers[0].group, 3);
  EXPECT_EQ(drawing.nodes[static_cast<size_t>(drawing.markers[0].nodes[0])], 3);
  EXPECT_EQ(drawing.nodes[static_cast<size_t>(drawing.markers[1].nodes[0])],
            10);
  const std::string svg = StructureSvg(picture);
  EXPECT_EQ(testing::FindHtmlFault(svg), "");
  EXPECT_EQ(Occurrences("class=\"marker\"", svg), 2);
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(StructureSection(picture),
              HasSubstr("\"marker_groups\":[3,3],\"markers\":["));
}

// Nodes alone are dots.
TEST(StructureViewTest, NodesWithoutLines) {
  StructurePicture picture = TwoCubes();
  picture.geometry.elements.clear();
  picture.groups.clear();
  const std::string svg = StructureSvg(picture);
  EXPECT_EQ(Occurrences("<circle", svg), 12);
  EXPECT_EQ(Occurrences("<text", svg), 1);
}

// A picture of too much is still.
TEST(StructureViewTest, LargeStructuresStayStill) {
  StructurePicture picture = TwoCubes();
  for (int i = 0; i < 21000; ++i) {
    picture.geometry.elements.push_back({ElementShape::kLine, {0, 10}});
  }
  const std::string html = StructureSection(picture);
  EXPECT_THAT(html, Not(HasSubstr("<script")));
  EXPECT_THAT(html, HasSubstr("still picture only"));
  EXPECT_THAT(html, HasSubstr("<svg"));
  for (int i = 0; i < 10000; ++i) {
    picture.geometry.elements.push_back({ElementShape::kLine, {0, 10}});
  }
  const std::string none = StructureSection(picture);
  EXPECT_THAT(none, Not(HasSubstr("<svg")));
  EXPECT_THAT(none, HasSubstr("structure.vtu"));
}

}  // namespace
}  // namespace pinode
