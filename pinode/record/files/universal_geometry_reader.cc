// Reads nodes, coordinate systems, lines and elements of universal files.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pinode/base/strings.h"
#include "pinode/record/files/universal_sets.h"

namespace pinode {
namespace {

// Returns the lines of a set. Its separator follows.
std::vector<std::string_view> LinesOfSet(UniversalLines* in) {
  std::vector<std::string_view> lines;
  while (!in->AtEnd()) {
    const std::string_view line = in->Next();
    if (IsUniversalSeparator(line)) break;
    lines.push_back(line);
  }
  return lines;
}

std::string Stripped(std::string_view text) {
  return std::string(StripBlanks(text));
}

Eigen::Vector3d ToPoint(const std::vector<double>& numbers, size_t at) {
  return {numbers[at], numbers[at + 1], numbers[at + 2]};
}

// Set 18 has points with six digits.
bool AreAxes(const Eigen::Matrix3d& axes) {
  return axes.allFinite() &&
         (axes * axes.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-4;
}

void Forget(UniversalSystem* system) {
  system->axes.setZero();
  system->origin.setZero();
  system->is_known = false;
}

// Computes the system from its origin, a point of the x axis and one of the x-z
// plane.
void PlaceByPoints(const std::vector<double>& numbers,
                   UniversalSystem* system) {
  system->origin = ToPoint(numbers, 0);
  const Eigen::Vector3d x = ToPoint(numbers, 3) - system->origin;
  const Eigen::Vector3d in_plane = ToPoint(numbers, 6) - system->origin;
  const Eigen::Vector3d y = in_plane.cross(x);
  system->axes.row(0) = x.normalized();
  system->axes.row(1) = y.normalized();
  system->axes.row(2) = x.normalized().cross(y.normalized());
}

// Transforms from the system `reference`, which comes before it in the file, to
// the global one.
bool TurnToGlobal(int reference, const UniversalFile& file,
                  UniversalSystem* system) {
  if (reference == 0) return true;
  const auto place = file.systems.find(reference);
  if (place == file.systems.end()) return reference == 1;
  const UniversalSystem& other = place->second;
  if (!other.is_known || other.type != 0) return false;
  system->axes = system->axes * other.axes;
  system->origin = other.axes.transpose() * system->origin + other.origin;
  return true;
}

}  // namespace

bool ParseUniversalNodes(int lines, UniversalLines* in, UniversalFile* file,
                         std::string* what) {
  while (!in->AtEndOfSet()) {
    std::vector<double> numbers;
    std::string text;
    for (int i = 0; i < lines; ++i) text += std::string(in->Next()) + " ";
    UniversalNode node;
    if (!UniversalNumbers(text, &numbers) || numbers.size() < 7 ||
        !UniversalInteger(numbers[0], &node.label) ||
        !UniversalInteger(numbers[1], &node.system) ||
        !UniversalInteger(numbers[2], &node.displacement_system)) {
      *what = "'" + Stripped(text) + "' is not a node";
      return false;
    }
    // An invalid color is ignored, because colors are not used.
    if (!UniversalInteger(numbers[3], &node.color)) node.color = 0;
    node.position = {numbers[4], numbers[5], numbers[6]};
    // Local until the global systems are known.
    node.position_is_local = lines == 1;
    file->nodes.push_back(node);
  }
  return EndUniversalSet(in, what);
}

void ParseUniversalSystems(UniversalLines* in, UniversalFile* file) {
  const std::vector<std::string_view> lines = LinesOfSet(in);
  // Each system has number, type, reference, color and method; name; two lines
  // of points.
  for (size_t i = 0; i + 3 < lines.size(); i += 4) {
    std::vector<int> head;
    std::vector<double> points;
    if (!UniversalIntegers(lines[i], &head) || head.size() < 3) return;
    UniversalSystem system;
    system.type = head[1];
    if (head.size() > 3) system.color = head[3];
    system.name = UniversalTextField(lines[i + 1], 0, 80);
    if (UniversalNumbers(lines[i + 2], &points) &&
        UniversalNumbers(lines[i + 3], &points) && points.size() >= 9) {
      PlaceByPoints(points, &system);
    } else {
      Forget(&system);
    }
    if (!AreAxes(system.axes) || !system.origin.allFinite() ||
        !TurnToGlobal(head[2], *file, &system)) {
      Forget(&system);
    }
    file->systems[head[0]] = std::move(system);
  }
}

void ParseUniversalSystemMatrices(UniversalLines* in, UniversalFile* file) {
  const std::vector<std::string_view> lines = LinesOfSet(in);
  // Number and name of a part. Then for each system: number, type and color;
  // name; a matrix of four rows that multiplies a row vector (x, y, z, 1): the
  // axes and the origin.
  for (size_t i = 2; i + 5 < lines.size(); i += 6) {
    std::vector<int> head;
    std::vector<double> rows;
    if (!UniversalIntegers(lines[i], &head) || head.size() < 2) return;
    UniversalSystem system;
    system.type = head[1];
    if (head.size() > 2) system.color = head[2];
    system.name = UniversalTextField(lines[i + 1], 0, 80);
    bool good = true;
    for (size_t k = 2; k < 6; ++k) {
      good = good && UniversalNumbers(lines[i + k], &rows);
    }
    if (good && rows.size() >= 12) {
      for (int k = 0; k < 3; ++k) {
        system.axes.row(k) = ToPoint(rows, 3 * static_cast<size_t>(k));
      }
      system.origin = ToPoint(rows, 9);
    }
    if (!good || rows.size() < 12 || !AreAxes(system.axes) ||
        !system.origin.allFinite()) {
      Forget(&system);
    }
    file->systems[head[0]] = std::move(system);
  }
}

bool ParseUniversalLine(UniversalLines* in, UniversalFile* file,
                        std::string* what) {
  std::vector<int> head;
  UniversalLine line;
  if (!UniversalIntegers(in->Next(), &head) || head.size() < 2) {
    *what = "it does not begin with the number of its nodes";
    return false;
  }
  line.name = UniversalTextField(in->Next(), 0, 80);
  while (!in->AtEndOfSet()) {
    const std::string_view nodes = in->Next();
    if (!UniversalIntegers(nodes, &line.nodes)) {
      *what = "'" + Stripped(nodes) + "' is not a line of nodes";
      return false;
    }
  }
  // Some programs fill the last line with zeros.
  while (static_cast<int>(line.nodes.size()) > std::max(0, head[1]) &&
         line.nodes.back() == 0) {
    line.nodes.pop_back();
  }
  if (static_cast<int>(line.nodes.size()) != head[1]) {
    *what = "it has " + std::to_string(line.nodes.size()) +
            " nodes, its header says " + std::to_string(head[1]);
    return false;
  }
  file->lines.push_back(std::move(line));
  return EndUniversalSet(in, what);
}

bool ParseUniversalElements(UniversalLines* in, UniversalFile* file,
                            std::string* what) {
  while (!in->AtEndOfSet()) {
    std::vector<int> head;
    if (!UniversalIntegers(in->Next(), &head) || head.size() < 6 ||
        head[5] < 1) {
      *what = "an element does not begin with six numbers";
      return false;
    }
    const bool beam = head[1] == 11 || (head[1] >= 21 && head[1] <= 24);
    if (beam) in->Next();
    UniversalLine line;
    line.name = "element " + std::to_string(head[0]);
    while (static_cast<int>(line.nodes.size()) < head[5]) {
      if (in->AtEndOfSet() || !UniversalIntegers(in->Next(), &line.nodes)) {
        *what = line.name + " has too few nodes";
        return false;
      }
    }
    if (!beam && line.nodes.size() > 2) {
      line.nodes.push_back(line.nodes.front());
    }
    file->lines.push_back(std::move(line));
  }
  return EndUniversalSet(in, what);
}

}  // namespace pinode
