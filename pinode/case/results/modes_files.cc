#include "pinode/case/results/modes_files.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/file.h"
#include "pinode/base/strings.h"
#include "pinode/case/text/csv_file.h"
#include "pinode/modal/stabilisation.h"
#include "pinode/record/files/universal_file.h"

namespace pinode {
namespace {

using Json = nlohmann::ordered_json;

// Returns the measured entries of a shape.
std::vector<Eigen::Index> Measured(const IdentifiedMode& mode) {
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < mode.shape.size(); ++i) {
    if (std::isfinite(mode.shape[i].real())) rows.push_back(i);
  }
  return rows;
}

struct RealShape {
  std::vector<Eigen::Index> rows;  // of the mode's shape
  Vector values;                   // largest entry 1
  Matrix covariance;
  Vector with_frequency;  // covariance of the frequency and each entry
};

// Rotates the shape by the angle that leaves the least in the imaginary parts,
// scales it, and takes its real part.
RealShape MakeReal(const IdentifiedMode& mode) {
  RealShape real;
  real.rows = Measured(mode);
  const Eigen::Index count = static_cast<Eigen::Index>(real.rows.size());
  const std::complex<double> turn = TurnToReal(mode.shape);
  Vector parts(count);
  // d Re(turn phi) = Re(turn) d Re(phi) - Im(turn) d Im(phi).
  const Eigen::Index places = mode.shape.size();
  Matrix slopes = Matrix::Zero(count, mode.covariance.cols());
  Matrix covariance = mode.covariance;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index row = real.rows[static_cast<size_t>(i)];
    parts[i] = (turn * mode.shape[row]).real();
    slopes(i, 2 + row) = turn.real();
    slopes(i, 2 + places + row) = -turn.imag();
  }
  // Places that were not measured take no part.
  covariance =
      covariance.unaryExpr([](double v) { return std::isfinite(v) ? v : 0.0; });
  Eigen::Index largest = 0;
  parts.cwiseAbs().maxCoeff(&largest);
  const double scale = parts[largest];
  real.values = parts / scale;
  real.covariance = slopes * covariance * slopes.transpose() / (scale * scale);
  real.with_frequency = slopes * covariance.col(0) / scale;
  const double share = std::min(
      1.0, static_cast<double>(count + 1) /
               (static_cast<double>(count + 1) + mode.degrees_of_freedom));
  const Vector variances = real.covariance.diagonal();
  real.covariance *= 1.0 - share;
  real.with_frequency *= 1.0 - share;
  // The largest entry of the mode is 1 by definition and has no variance.
  const double floor = 1e-6 * std::max(variances.maxCoeff(), 1e-12);
  real.covariance.diagonal() = variances.cwiseMax(floor);
  return real;
}

// Returns a name as a TOML key.
std::string Quoted(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) {
    if (c == '"' || c == '\\') text += '\\';
    text += c;
  }
  return text + "\"";
}

Json NumberOrNull(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json ShapeAsJson(const std::vector<std::string>& places,
                 const IdentifiedMode& mode) {
  Json shape = Json::array();
  for (const Eigen::Index row : Measured(mode)) {
    shape.push_back({{"place", places[static_cast<size_t>(row)]},
                     {"real", mode.shape[row].real()},
                     {"imaginary", mode.shape[row].imag()},
                     {"sigma_real", mode.shape_sigma_real[row]},
                     {"sigma_imaginary", mode.shape_sigma_imaginary[row]}});
  }
  return shape;
}

bool WriteModesCsv(const ModesResult& result, const std::string& path,
                   std::string* error) {
  const std::vector<MergedMode>& modes = result.merged.modes;
  const Eigen::Index count = static_cast<Eigen::Index>(modes.size());
  std::vector<CsvColumn> columns;
  const auto add = [&](const std::string& name,
                       const std::function<double(const MergedMode&)>& value) {
    Vector values(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      values[i] = value(modes[static_cast<size_t>(i)]);
    }
    columns.emplace_back(name, values);
  };
  columns.emplace_back(
      "mode", Vector::LinSpaced(count, 1.0, static_cast<double>(count)));
  add("frequency_hz", [](const MergedMode& m) { return m.mode.frequency_hz; });
  add("frequency_sigma",
      [](const MergedMode& m) { return m.mode.frequency_sigma; });
  add("damping_ratio",
      [](const MergedMode& m) { return m.mode.damping_ratio; });
  add("damping_sigma",
      [](const MergedMode& m) { return m.mode.damping_sigma; });
  for (size_t p = 0; p < result.merged.places.size(); ++p) {
    const Eigen::Index row = static_cast<Eigen::Index>(p);
    const std::string& place = result.merged.places[p];
    add(place + "_real",
        [row](const MergedMode& m) { return m.mode.shape[row].real(); });
    add(place + "_imaginary",
        [row](const MergedMode& m) { return m.mode.shape[row].imag(); });
  }
  return WriteCsv(path, columns, error);
}

}  // namespace

std::string ModesAsJson(const ModesResult& result) {
  Json json;
  json["schema"] = "pinode-modes-1";
  json["records"] = result.setups;
  json["places"] = result.merged.places;
  json["modes"] = Json::array();
  for (const MergedMode& merged : result.merged.modes) {
    const IdentifiedMode& mode = merged.mode;
    Json entry = {{"frequency_hz", mode.frequency_hz},
                  {"frequency_sigma", mode.frequency_sigma},
                  {"frequency_lower95", mode.frequency_lower95},
                  {"frequency_upper95", mode.frequency_upper95},
                  {"damping_ratio", mode.damping_ratio},
                  {"damping_sigma", mode.damping_sigma},
                  {"damping_lower95", mode.damping_lower95},
                  {"damping_upper95", mode.damping_upper95},
                  {"phase_collinearity", mode.phase_collinearity},
                  {"orders_seen", mode.orders_seen},
                  {"orders_possible", mode.orders_possible},
                  {"frequency_spread", mode.frequency_spread},
                  {"damping_spread", mode.damping_spread}};
    if (mode.is_harmonic) entry["harmonic"] = true;
    Json seen = Json::array();
    for (size_t s = 0; s < merged.in_setups.size(); ++s) {
      if (merged.in_setups[s] >= 0) seen.push_back(result.setups[s]);
    }
    entry["records"] = seen;
    if (seen.size() > 1) {
      entry["frequency_between"] = NumberOrNull(merged.frequency_between);
      entry["damping_between"] = NumberOrNull(merged.damping_between);
    }
    if (std::isfinite(mode.check_frequency_hz)) {
      entry["data_driven"] = {{"frequency_hz", mode.check_frequency_hz},
                              {"damping_ratio", mode.check_damping_ratio}};
    }
    entry["shape"] = ShapeAsJson(result.merged.places, mode);
    json["modes"].push_back(std::move(entry));
  }
  json["remarks"] = result.remarks;
  return json.dump(2) + "\n";
}

std::string ModesAsToml(const ModesResult& result) {
  std::string text =
      "# Modes for a case: [[mode]] of pinode_update. Shapes are "
      "displacements, "
      "turned to be real.\n";
  const auto number = [](double value) { return FormatNumber(value, 9); };
  for (size_t m = 0; m < result.merged.modes.size(); ++m) {
    const IdentifiedMode& mode = result.merged.modes[m].mode;
    if (mode.is_harmonic && !result.keep_harmonics) continue;
    const RealShape shape = MakeReal(mode);
    text += "\n[[mode]]\nname = \"mode" + std::to_string(m + 1) + "\"\n";
    text += "frequency = " + number(mode.frequency_hz) + "\n";
    text += "frequency_sigma = " + number(mode.frequency_sigma) + "\n";
    text += "# damping ratio " + number(mode.damping_ratio) + ", sigma " +
            number(mode.damping_sigma) + "\n";
    if (shape.rows.size() < 2) continue;
    std::vector<std::string> entries;
    for (size_t i = 0; i < shape.rows.size(); ++i) {
      entries.push_back(
          Quoted(result.merged.places[static_cast<size_t>(shape.rows[i])]) +
          " = " + number(shape.values[static_cast<Eigen::Index>(i)]));
    }
    text += "shape = {" + Join(entries, ", ") + "}\n";
    std::vector<std::string> rows;
    for (Eigen::Index i = 0; i < shape.values.size(); ++i) {
      std::vector<std::string> row;
      for (Eigen::Index j = 0; j < shape.values.size(); ++j) {
        row.push_back(number(shape.covariance(i, j)));
      }
      rows.push_back("  [" + Join(row, ", ") + "]");
    }
    text += "shape_covariance = [\n" + Join(rows, ",\n") + "]\n";
    std::vector<std::string> shared;
    for (const double value : shape.with_frequency) {
      shared.push_back(number(value));
    }
    text += "frequency_shape_covariance = [" + Join(shared, ", ") + "]\n";
  }
  return text;
}

namespace {

// Rows of shapes: their places and values.
struct ShapesToWrite {
  std::vector<int> nodes;
  std::vector<Eigen::MatrixXcd> values;  // of each mode, nodes x 3 or 6
};

ShapesToWrite AtPlaces(const MergedModes& merged) {
  std::vector<std::pair<int, int>> at;  // node, direction
  for (const std::string& place : merged.places) {
    int node = 0;
    int direction = 0;
    if (!ParseUniversalPlace(place, &node, &direction)) break;
    at.emplace_back(node, direction);
  }
  if (at.size() < merged.places.size()) {
    at.clear();
    for (size_t i = 0; i < merged.places.size(); ++i) {
      at.emplace_back(static_cast<int>(i) + 1, 1);
    }
  }
  std::map<int, Eigen::Index> rows;
  int widest = 3;
  for (const auto& [node, direction] : at) {
    rows.emplace(node, 0);
    if (std::abs(direction) > 3) widest = 6;
  }
  ShapesToWrite shapes;
  for (auto& [node, row] : rows) {
    row = static_cast<Eigen::Index>(shapes.nodes.size());
    shapes.nodes.push_back(node);
  }
  for (const MergedMode& found : merged.modes) {
    Eigen::MatrixXcd values = Eigen::MatrixXcd::Zero(
        static_cast<Eigen::Index>(shapes.nodes.size()), widest);
    for (const Eigen::Index i : Measured(found.mode)) {
      const auto [node, direction] = at[static_cast<size_t>(i)];
      values(rows.at(node), std::abs(direction) - 1) =
          direction < 0 ? -found.mode.shape[i] : found.mode.shape[i];
    }
    shapes.values.push_back(std::move(values));
  }
  return shapes;
}

// Returns labels of a geometry's nodes: their names if these are distinct
// positive numbers.
std::vector<int> LabelsOf(const StructureGeometry& geometry) {
  std::vector<int> labels;
  std::set<int> once;
  for (const std::string& name : geometry.node_names) {
    int label = 0;
    if (!ParseInt(name, &label) || label < 1 || !once.insert(label).second) {
      labels.resize(geometry.node_names.size());
      std::iota(labels.begin(), labels.end(), 1);
      return labels;
    }
    labels.push_back(label);
  }
  return labels;
}

// Adds the nodes, and one line along the edges of all elements.
void AddGeometry(const StructureGeometry& geometry,
                 const std::vector<int>& labels, UniversalFile* file) {
  for (size_t i = 0; i < labels.size(); ++i) {
    UniversalNode node;
    node.label = labels[i];
    for (size_t k = 0; k < 3; ++k) {
      node.position[k] = geometry.positions(static_cast<Eigen::Index>(i),
                                            static_cast<Eigen::Index>(k));
    }
    file->nodes.push_back(node);
  }
  UniversalLine line;
  line.name = "structure";
  for (const StructureGeometry::Element& element : geometry.elements) {
    for (const std::vector<int>& face : FacesOf(element.shape)) {
      if (face.size() < 2) continue;
      for (const int corner : face) {
        line.nodes.push_back(labels[static_cast<size_t>(
            element.nodes[static_cast<size_t>(corner)])]);
      }
      if (face.size() > 2) {
        line.nodes.push_back(labels[static_cast<size_t>(
            element.nodes[static_cast<size_t>(face.front())])]);
      }
      line.nodes.push_back(0);
    }
  }
  if (!line.nodes.empty()) file->lines.push_back(std::move(line));
}

}  // namespace

std::string ModesAsUniversalFile(const ModesResult& result) {
  UniversalFile file;
  ShapesToWrite shapes;
  if (result.motions.empty()) {
    shapes = AtPlaces(result.merged);
  } else {
    shapes = {LabelsOf(result.geometry), result.motions};
    AddGeometry(result.geometry, shapes.nodes, &file);
  }
  UniversalShape shape;
  shape.nodes = shapes.nodes;
  shape.analysis_type = 3;
  shape.is_complex = true;
  for (const MergedMode& merged : result.merged.modes) {
    const IdentifiedMode& mode = merged.mode;
    const double speed = kTwoPi * mode.frequency_hz;
    const double ratio = mode.damping_ratio;
    shape.mode = static_cast<int>(file.shapes.size()) + 1;
    shape.texts[0] = "mode" + std::to_string(shape.mode);
    shape.eigenvalue = {-ratio * speed, speed * std::sqrt(1.0 - ratio * ratio)};
    shape.frequency = shape.eigenvalue.imag() / kTwoPi;
    shape.values = shapes.values[file.shapes.size()];
    shape.values_per_node = static_cast<int>(shape.values.cols());
    shape.characteristic = shape.values_per_node > 3 ? 3 : 2;
    file.shapes.push_back(shape);
  }
  return FormatUniversalFile(file);
}

bool WriteModesFiles(const ModesResult& result, const std::string& folder,
                     std::string* error) {
  return WriteFileAtomically(folder + "/modes.json", ModesAsJson(result),
                             error) &&
         WriteFileAtomically(folder + "/modes.toml", ModesAsToml(result),
                             error) &&
         WriteFileAtomically(folder + "/modes.uff",
                             ModesAsUniversalFile(result), error) &&
         WriteModesCsv(result, folder + "/modes.csv", error);
}

}  // namespace pinode
