#include "pinode/report/structure_view.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "pinode/base/strings.h"
#include "pinode/report/number_text.h"
#include "pinode/report/page_data.h"
#include "pinode/report/structure_drawing.h"
#include "pinode/report/three_packed.h"

namespace pinode {
namespace {

#include "pinode/report/structure_script.inc"

using Json = nlohmann::json;

// Largest numbers of triangles, so that a page opens at once and can be sent by
// mail.
constexpr size_t kMostTriangles = 25000;
constexpr size_t kMostStillTriangles = 60000;
constexpr Eigen::Index kMostModeNumbers = 90000;
constexpr double kBar = 0.006;  // half width of lines, of the size
constexpr double kAway = 1.95;  // of the camera

// Returns rounded entries to keep the page short; `scale` is a power of ten.
std::vector<double> RoundedRows(const Matrix& matrix, double scale) {
  std::vector<double> values;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index k = 0; k < matrix.cols(); ++k) {
      values.push_back(std::round(scale * matrix(i, k)) / scale + 0.0);
    }
  }
  return values;
}

Json ArrowsAsJson(const std::vector<StructurePicture::Arrow>& arrows,
                  const StructureDrawing& drawing) {
  Json list = Json::array();
  for (const StructurePicture::Arrow& arrow : arrows) {
    list.push_back(
        {{"name", arrow.name},
         {"node", drawing.place_of[static_cast<size_t>(arrow.node)]},
         {"direction",
          {arrow.direction[0], arrow.direction[1], arrow.direction[2]}}});
  }
  return list;
}

size_t NumModes(const StructurePicture& picture,
                const StructureDrawing& drawing) {
  const Eigen::Index each = std::max<Eigen::Index>(1, drawing.positions.size());
  return std::min(picture.modes.size(),
                  static_cast<size_t>(kMostModeNumbers / each));
}

std::string DataAsJson(const StructurePicture& picture,
                       const StructureDrawing& drawing) {
  Json data;
  data["nodes"] = RoundedRows(drawing.positions, 1e4);
  std::vector<int> triangles, triangle_groups, edges, lines, line_groups;
  std::vector<int> markers, marker_groups;
  for (const StructureDrawing::Face& face : drawing.faces) {
    for (size_t i = 2; i < face.nodes.size(); ++i) {
      triangles.insert(triangles.end(),
                       {face.nodes[0], face.nodes[i - 1], face.nodes[i]});
      triangle_groups.push_back(face.group);
    }
  }
  for (const auto& [a, b] : drawing.edges) edges.insert(edges.end(), {a, b});
  for (const StructureDrawing::Face& line : drawing.lines) {
    lines.insert(lines.end(), line.nodes.begin(), line.nodes.end());
    line_groups.push_back(line.group);
  }
  for (const StructureDrawing::Face& marker : drawing.markers) {
    markers.push_back(marker.nodes[0]);
    marker_groups.push_back(marker.group);
  }
  data["triangles"] = triangles;
  data["triangle_groups"] = triangle_groups;
  data["edges"] = edges;
  data["lines"] = lines;
  data["line_groups"] = line_groups;
  data["markers"] = markers;
  data["marker_groups"] = marker_groups;
  data["dots"] = drawing.dots;
  data["bar"] = kBar;
  data["marker"] = kMarker;
  data["tints"] = {kSensorColor, kForceColor, kUnknownForceColor};
  data["colors"] = drawing.colors;
  data["told"] = drawing.told;
  data["sensors"] = ArrowsAsJson(picture.sensors, drawing);
  data["forces"] = ArrowsAsJson(picture.forces, drawing);
  data["unknown_forces"] = ArrowsAsJson(picture.unknown_forces, drawing);
  data["marks"] = Json::array();
  for (const StructureDrawing::Mark& mark : drawing.marks) {
    data["marks"].push_back(
        {{"text", mark.text}, {"node", mark.node}, {"color", mark.color}});
  }
  data["modes"] = Json::array();
  for (size_t m = 0; m < NumModes(picture, drawing); ++m) {
    Matrix shape(static_cast<Eigen::Index>(drawing.nodes.size()), 3);
    for (Eigen::Index i = 0; i < shape.rows(); ++i) {
      shape.row(i) =
          picture.modes[m].shape.row(drawing.nodes[static_cast<size_t>(i)]);
    }
    data["modes"].push_back({{"shape", RoundedRows(shape, 1e3)}});
  }
  // A page of modes begins with the first mode in motion.
  data["start"] = picture.groups.empty() && !data["modes"].empty() ? 0 : -1;
  data["up"] = {drawing.up[0], drawing.up[1], drawing.up[2]};
  data["turn"] = drawing.turn;
  data["tilt"] = drawing.tilt;
  data["away"] = kAway;
  std::string text = data.dump(-1, ' ', false, Json::error_handler_t::replace);
  // Text in the data must not end the script.
  ReplaceAll("</", "<\\/", &text);
  ReplaceAll("<!--", "<\\u0021--", &text);
  return text;
}

std::string LegendHtml(const StructurePicture& picture,
                       const StructureDrawing& drawing) {
  std::string html = "<ul class=\"legend\">\n";
  const auto add = [&html](const std::string& color, const std::string& text) {
    html += "<li><span style=\"background:" + color + "\"></span>" +
            EscapeHtml(text) + "</li>\n";
  };
  bool any_unchanged = false;
  for (size_t g = 0; g < picture.groups.size(); ++g) {
    if (picture.groups[g].changed) {
      add(drawing.colors[g + 1], drawing.told[g + 1]);
    } else {
      any_unchanged = true;
    }
  }
  if (any_unchanged) {
    add(kUnchangedColor,
        picture.since_baseline
            ? "groups: no significant change"
            : "groups: as in the initial model, within their intervals");
  }
  const std::vector<int> shown = ShownGroups(picture);
  if (!picture.groups.empty() &&
      std::find(shown.begin(), shown.end(), -1) != shown.end()) {
    add(kNoGroupColor, "not in any group");
  }
  if (!picture.sensors.empty()) add(kSensorColor, "sensors");
  if (!picture.forces.empty()) add(kForceColor, "measured forces");
  if (!picture.unknown_forces.empty()) {
    add(kUnknownForceColor, "unmeasured forces");
  }
  return html + "</ul>\n";
}

std::string ControlsHtml(const StructurePicture& picture,
                         const StructureDrawing& drawing) {
  std::string html =
      "<p class=\"controls\" hidden>"
      "<label>Motion <select class=\"motion\"><option value=\"\">at rest"
      "</option>";
  for (size_t m = 0; m < NumModes(picture, drawing); ++m) {
    html += "<option value=\"" + std::to_string(m) + "\">mode " +
            std::to_string(m + 1) + ", " +
            ReadableNumber(picture.modes[m].frequency_hz) + " Hz</option>";
  }
  return html +
         "</select></label> <label><input type=\"checkbox\" class=\"names\" "
         "checked> names</label> <button type=\"button\" "
         "class=\"whole\">Whole view</button> <small>Drag to "
         "rotate, scroll to zoom (click first). Keys: arrows, + and -. On a "
         "touch screen, one finger rotates sideways, two rotate and "
         "zoom.</small></p>\n";
}

// Licence of the library that is packed into the page.
constexpr char kThreeLicence[] = R"html(<!-- three.js. The MIT License.
Copyright 2010-2017 three.js authors

Permission is hereby granted, free of charge, to any person obtaining a copy of
this software and associated documentation files (the "Software"), to deal in
the Software without restriction, including without limitation the rights to
use, copy, modify, merge, publish, distribute, sublicense, and/or sell copies of
the Software, and to permit persons to whom the Software is furnished to do so,
subject to the following conditions:

The above copyright notice and this permission notice shall be included in all
copies or substantial portions of the Software.

THE SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR
IMPLIED, INCLUDING BUT NOT LIMITED TO THE WARRANTIES OF MERCHANTABILITY, FITNESS
FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE AUTHORS OR
COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER LIABILITY, WHETHER
IN AN ACTION OF CONTRACT, TORT OR OTHERWISE, ARISING FROM, OUT OF OR IN
CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN THE SOFTWARE. -->
)html";

constexpr char kStructureStyle[] = R"css(<style>
.structure .scene { border: 1px solid #ddd; touch-action: pan-y; cursor: grab; line-height: 0; }
.structure .scene:focus-visible { outline: 3px solid #0072b2; }
.structure .controls label { margin-right: 1.2em; }
.structure .controls small { color: #666; }
.structure .told { min-height: 1.5em; }
.structure .legend { list-style: none; padding: 0; max-width: none; display: flex; flex-wrap: wrap; gap: 4px 20px; font-size: 0.93em; }
.structure .legend span { display: inline-block; width: 1em; height: 1em; margin-right: 6px; vertical-align: -0.12em;
  border: 1px solid #4b5560; print-color-adjust: exact; -webkit-print-color-adjust: exact; }
.structure .still svg { display: block; max-width: 100%; height: auto; margin: 0 auto; }
@media screen { .structure .still.print-only { display: none; } }
@media print { .structure .scene, .structure .controls, .structure .told, .structure .no-webgl { display: none; } }
</style>
)css";

}  // namespace

std::string StructureSvg(const StructurePicture& picture) {
  return DrawingSvg(picture, DrawStructure(picture));
}

std::string StructureSection(const StructurePicture& picture) {
  const StructureDrawing drawing = DrawStructure(picture);
  size_t triangles = 0;
  for (const StructureDrawing::Face& face : drawing.faces) {
    triangles += face.nodes.size() - 2;
  }
  const size_t size =
      triangles + 2 * (drawing.lines.size() + drawing.markers.size());
  const bool can_turn = *ThreePacked() != '\0';
  const bool turns = can_turn && size <= kMostTriangles;
  const bool still = size <= kMostStillTriangles;
  std::string html = kStructureStyle;
  html +=
      "<section class=\"structure\" id=\"structure\" data-state=\"loading\">\n";
  if (turns) {
    html +=
        "<div class=\"scene\" hidden tabindex=\"0\" role=\"application\" "
        "aria-label=\"The structure: arrow keys turn it, plus and minus "
        "zoom\"></div>\n";
  }
  if (still) {
    html += "<div class=\"still\">" + DrawingSvg(picture, drawing) + "</div>\n";
  }
  if (turns) {
    html +=
        "<noscript><p>Scripts are off in this browser, so this is a still "
        "picture.</p></noscript>\n"
        "<p class=\"no-webgl\" hidden></p>\n";
  } else if (still && !can_turn) {
    html +=
        "<p class=\"no-webgl\">This pinode was built without three.js, "
        "so this is a still picture.</p>\n";
  } else {
    html += "<p class=\"no-webgl\">With " + std::to_string(size) +
            " triangles the structure is " +
            (still ? "drawn as a still picture only. The limit of the rotating "
                     "view is "
                   : "too large to be drawn in this page. The limit is ") +
            std::to_string(still ? kMostTriangles : kMostStillTriangles) +
            ". Open structure.vtu to see all of it.</p>\n";
  }
  if (turns) html += ControlsHtml(picture, drawing);
  html += "<p class=\"told\" aria-live=\"polite\">&nbsp;</p>\n";
  html += LegendHtml(picture, drawing);
  for (const std::string& note : picture.notes) {
    html += "<p><small>" + EscapeHtml(note) + "</small></p>\n";
  }
  if (turns) {
    html += "<script type=\"application/json\" class=\"structure-data\">" +
            DataAsJson(picture, drawing) + "</script>\n";
    html += kThreeLicence;
    html += std::string("<script type=\"text/plain\" class=\"three-packed\">") +
            ThreePacked() + "</script>\n";
    html += std::string("<script>") + kStructureScript + "</script>\n";
  }
  return html + "</section>\n";
}

}  // namespace pinode
