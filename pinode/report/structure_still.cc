#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "pinode/base/strings.h"
#include "pinode/report/page_data.h"
#include "pinode/report/structure_drawing.h"

namespace pinode {
namespace {

constexpr double kLetter = 8.5;  // no letter of the names is wider on average
constexpr double kAscent = 12.0, kDescent = 3.0;

// Axes of the still picture, the same view without perspective.
struct Axes {
  Eigen::Vector3d across, upwards, towards;
};

Axes AxesOf(const StructureDrawing& drawing) {
  const Eigen::Vector3d& up = drawing.up;
  const Eigen::Vector3d right(up[2], up[0], up[1]);
  const Eigen::Vector3d front = up.cross(right);
  Axes axes;
  axes.towards = std::cos(drawing.tilt) * (std::cos(drawing.turn) * right +
                                           std::sin(drawing.turn) * front) +
                 std::sin(drawing.tilt) * up;
  axes.across = up.cross(axes.towards).normalized();
  axes.upwards = axes.towards.cross(axes.across);
  return axes;
}

std::string Shaded(const std::string& color, double light) {
  int red = 0, green = 0, blue = 0;
  if (std::sscanf(color.c_str(), "#%02x%02x%02x", &red, &green, &blue) != 3) {
    return color;
  }
  char text[16];
  const auto dim = [light](int value) {
    return std::clamp(static_cast<int>(std::lround(light * value)), 0, 255);
  };
  std::snprintf(text, sizeof(text), "#%02x%02x%02x", dim(red), dim(green),
                dim(blue));
  return text;
}

class SvgMaker {
 public:
  SvgMaker(const StructurePicture& picture, const StructureDrawing& drawing)
      : picture_(picture), drawing_(drawing), axes_(AxesOf(drawing)) {
    flat_.resize(drawing.positions.rows(), 3);
    for (Eigen::Index i = 0; i < flat_.rows(); ++i) {
      const Eigen::Vector3d at = drawing.positions.row(i).transpose();
      flat_.row(i) << axes_.across.dot(at), -axes_.upwards.dot(at),
          axes_.towards.dot(at);
    }
  }

  std::string Make() {
    const double margin = 0.14;
    Eigen::RowVector3d low = Eigen::RowVector3d::Zero();
    Eigen::RowVector3d high = Eigen::RowVector3d::Zero();
    if (flat_.rows() > 0) {
      low = flat_.colwise().minCoeff();
      high = flat_.colwise().maxCoeff();
    }
    const double width = high[0] - low[0] + 2.0 * margin;
    const double height = high[1] - low[1] + 2.0 * margin;
    const double scale = std::min(720.0 / width, 560.0 / height);
    origin_ = Eigen::RowVector2d(margin - low[0], margin - low[1]);
    scale_ = scale;
    AddBodies();
    for (const int node : drawing_.dots) {
      const Eigen::RowVector2d at =
          scale_ * (flat_.row(node).head(2) + origin_);
      char dot[96];
      std::snprintf(dot, sizeof(dot),
                    "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3\" "
                    "fill=\"#4b5560\"/>\n",
                    at[0], at[1]);
      text_ += dot;
    }
    AddArrows(picture_.sensors, kSensorColor, 0.07);
    AddArrows(picture_.forces, kForceColor, 0.1);
    AddArrows(picture_.unknown_forces, kUnknownForceColor, 0.12);
    AddMarks();
    // Names may extend beyond the drawing.
    const double left = std::min(0.0, low_text_);
    const double right = std::max(scale * width, high_text_);
    const double top = std::min(0.0, top_text_);
    const double bottom = std::max(scale * height, bottom_text_);
    char head[256];
    std::snprintf(
        head, sizeof(head),
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"%.0f %.0f "
        "%.0f %.0f\" width=\"%.0f\" height=\"%.0f\" role=\"img\" "
        "font-family=\"sans-serif\" stroke-linejoin=\"round\">"
        "<title>The structure</title>\n",
        left, top, right - left, bottom - top, right - left, bottom - top);
    return head + text_ + "</svg>";
  }

 private:
  std::string Point(Eigen::Index node) const {
    return Point(Eigen::RowVector2d(flat_(node, 0), flat_(node, 1)));
  }
  std::string Point(const Eigen::RowVector2d& at) const {
    const Eigen::RowVector2d place = scale_ * (at + origin_);
    char text[48];
    std::snprintf(text, sizeof(text), "%.1f,%.1f", place[0], place[1]);
    return text;
  }

  double DepthOf(const StructureDrawing::Face& face) const {
    double depth = 0.0;
    for (const int node : face.nodes) depth += flat_(node, 2);
    return depth / static_cast<double>(face.nodes.size());
  }

  // Adds bodies from far to near.
  void AddBodies() {
    struct Body {
      double depth;
      const StructureDrawing::Face* face;
    };
    std::vector<Body> bodies;
    for (const StructureDrawing::Face& face : drawing_.faces) {
      bodies.push_back({DepthOf(face), &face});
    }
    for (const StructureDrawing::Face& line : drawing_.lines) {
      bodies.push_back({DepthOf(line), &line});
    }
    for (const StructureDrawing::Face& marker : drawing_.markers) {
      bodies.push_back({DepthOf(marker) + kMarker, &marker});
    }
    std::stable_sort(
        bodies.begin(), bodies.end(),
        [](const auto& a, const auto& b) { return a.depth < b.depth; });
    text_ += "<g stroke=\"#4b5560\" stroke-width=\"0.6\">\n";
    for (const Body& body : bodies) {
      if (body.face->nodes.size() == 1) {
        AddMarker(*body.face);
      } else if (body.face->nodes.size() == 2) {
        AddLine(*body.face);
      } else {
        AddFace(*body.face);
      }
    }
    text_ += "</g>\n";
  }

  void AddLine(const StructureDrawing::Face& line) {
    const std::string& color = drawing_.colors[static_cast<size_t>(line.group)];
    for (const bool outline : {true, false}) {
      text_ += "<path d=\"M" + Point(line.nodes[0]) + "L" +
               Point(line.nodes[1]) + "\" stroke=\"" +
               (outline ? "#4b5560" : color) + "\" stroke-width=\"" +
               (outline ? "5" : "3.6") + "\"/>\n";
    }
  }

  void AddMarker(const StructureDrawing::Face& marker) {
    const Eigen::RowVector2d at = flat_.row(marker.nodes[0]).head(2);
    const Eigen::RowVector2d across(kMarker, 0.0), along(0.0, kMarker);
    text_ += "<path class=\"marker\" d=\"M" + Point(at - along) + "L" +
             Point(at + across) + "L" + Point(at + along) + "L" +
             Point(at - across) + "Z\" fill=\"" +
             drawing_.colors[static_cast<size_t>(marker.group)] + "\"/>\n";
  }

  void AddFace(const StructureDrawing::Face& face) {
    const auto at = [&](size_t i) {
      return Eigen::Vector3d(drawing_.positions.row(face.nodes[i]).transpose());
    };
    const Eigen::Vector3d normal =
        (at(1) - at(0)).cross(at(2) - at(0)).normalized();
    // The far side of a solid is invisible.
    if (face.is_outside && normal.dot(axes_.towards) < -1e-9) return;
    const double light = 0.74 + 0.26 * std::abs(normal.dot(axes_.towards));
    text_ += "<path d=\"M" + Point(face.nodes[0]);
    for (size_t i = 1; i < face.nodes.size(); ++i) {
      text_ += "L" + Point(face.nodes[i]);
    }
    text_ += "Z\" fill=\"" +
             Shaded(drawing_.colors[static_cast<size_t>(face.group)], light) +
             "\"/>\n";
  }

  void AddMarks() {
    for (const StructureDrawing::Mark& mark : drawing_.marks) {
      const Eigen::RowVector2d at =
          scale_ * (flat_.row(mark.node).head(2) + origin_);
      AddText(at + Eigen::RowVector2d(8.0, 4.0), "start", mark.color, mark.text,
              "font-weight=\"bold\" ");
    }
  }

  // Returns a place moved up or down by lines until no name covers another.
  Eigen::RowVector2d FreePlace(const Eigen::RowVector2d& at, bool ends,
                               const std::string& text) {
    constexpr int kMostMoves = 16;
    const double width = kLetter * static_cast<double>(text.size());
    const double left = at[0] - (ends ? width : 0.0);
    const auto box_at = [&](double y) {
      return Eigen::AlignedBox2d(Eigen::Vector2d(left, y - kAscent),
                                 Eigen::Vector2d(left + width, y + kDescent));
    };
    double y = at[1];
    for (int i = 0; i <= kMostMoves; ++i) {
      const int lines = (i + 1) / 2;
      const double moved =
          at[1] + (i % 2 == 0 ? -lines : lines) * (kAscent + kDescent);
      const Eigen::AlignedBox2d box = box_at(moved);
      if (std::none_of(names_.begin(), names_.end(), [&](const auto& name) {
            return name.intersects(box);
          })) {
        y = moved;
        break;
      }
    }
    names_.push_back(box_at(y));
    low_text_ = std::min(low_text_, left);
    high_text_ = std::max(high_text_, left + width);
    top_text_ = std::min(top_text_, y - kAscent);
    bottom_text_ = std::max(bottom_text_, y + kDescent);
    return {at[0], y};
  }

  void AddText(const Eigen::RowVector2d& wanted, const char* anchor,
               const std::string& color, const std::string& text,
               const char* more = "") {
    const Eigen::RowVector2d at =
        FreePlace(wanted, std::string(anchor) == "end", text);
    char place[96];
    std::snprintf(place, sizeof(place),
                  "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\" ", at[0],
                  at[1], anchor);
    text_ += std::string(place) + more + "font-size=\"13\" fill=\"" + color +
             "\" stroke=\"#fff\" stroke-width=\"3\" paint-order=\"stroke\">" +
             EscapeHtml(text) + "</text>\n";
  }

  void AddArrows(const std::vector<StructurePicture::Arrow>& arrows,
                 const std::string& color, double length) {
    for (const StructurePicture::Arrow& arrow : arrows) {
      const int node = drawing_.place_of[static_cast<size_t>(arrow.node)];
      const Eigen::RowVector2d tip(flat_(node, 0), flat_(node, 1));
      const Eigen::RowVector2d along(axes_.across.dot(arrow.direction),
                                     -axes_.upwards.dot(arrow.direction));
      const Eigen::RowVector2d tail = tip - length * along;
      const double size = along.norm();
      text_ += "<path d=\"M" + Point(tail) + "L" + Point(tip) + "\" stroke=\"" +
               color + "\" stroke-width=\"2.4\"/>\n";
      if (size > 1e-6) {
        const Eigen::RowVector2d unit = along / size;
        const Eigen::RowVector2d side(-unit[1], unit[0]);
        const Eigen::RowVector2d back = tip - 0.028 * unit;
        text_ += "<path d=\"M" + Point(tip) + "L" +
                 Point(Eigen::RowVector2d(back + 0.011 * side)) + "L" +
                 Point(Eigen::RowVector2d(back - 0.011 * side)) +
                 "Z\" fill=\"" + color + "\"/>\n";
      }
      const Eigen::RowVector2d at =
          scale_ * (tail - 0.012 * along.normalized() + origin_);
      AddText(at + Eigen::RowVector2d(0.0, 4.0),
              along[0] > 0.0 ? "end" : "start", color, arrow.name);
    }
  }

  const StructurePicture& picture_;
  const StructureDrawing& drawing_;
  const Axes axes_;
  Matrix flat_;
  Eigen::RowVector2d origin_ = Eigen::RowVector2d::Zero();
  double scale_ = 1.0;
  std::vector<Eigen::AlignedBox2d> names_;  // that are there
  double low_text_ = 0.0, high_text_ = 0.0, top_text_ = 0.0, bottom_text_ = 0.0;
  std::string text_;
};

}  // namespace

std::string DrawingSvg(const StructurePicture& picture,
                       const StructureDrawing& drawing) {
  return SvgMaker(picture, drawing).Make();
}

}  // namespace pinode
