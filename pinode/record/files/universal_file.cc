#include "pinode/record/files/universal_file.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <set>
#include <string_view>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/base/strings.h"
#include "pinode/record/files/loggers/logged_file.h"

namespace pinode {
namespace {

constexpr const char* kDirections[] = {"x", "y", "z", "rx", "ry", "rz"};

std::string ColumnName(const UniversalFunction& f, size_t number,
                       std::set<std::string>* used) {
  const int direction = std::abs(f.response_direction);
  std::string name;
  if (f.response_node != 0 && direction >= 1 && direction <= 6) {
    name = UniversalPlace(f.response_node, f.response_direction);
  } else {
    name = f.texts[0].empty() ? "set" + std::to_string(number) : f.texts[0];
  }
  if (!used->insert(name).second) {
    name += " " + std::to_string(number);
    used->insert(name);
  }
  return name;
}

bool HaveSameAbscissae(const UniversalFunction& a, const UniversalFunction& b) {
  if (a.size() != b.size() || a.is_even() != b.is_even()) return false;
  return a.is_even() ? a.abscissa_step == b.abscissa_step &&
                           a.abscissa_start == b.abscissa_start
                     : a.abscissa == b.abscissa;
}

// Computes the axes of a cylindrical system at a place: outwards, around and
// along its axis.
bool CylindricalAxes(const UniversalSystem& system,
                     const Eigen::Vector3d& position, Eigen::Matrix3d* axes) {
  const Eigen::Vector3d local = system.axes * (position - system.origin);
  const double radius = local.head<2>().norm();
  if (!(radius > 1e-9 * local.norm())) return false;
  const double cosine = local[0] / radius;
  const double sine = local[1] / radius;
  Eigen::Matrix3d turn;
  turn << cosine, sine, 0.0, -sine, cosine, 0.0, 0.0, 0.0, 1.0;
  *axes = turn * system.axes;
  return true;
}

// Reads histories of several rates or start times as channels of a logger's
// file, whose rules apply.
bool ReadOnOneClock(const std::string& path,
                    const std::vector<const UniversalFunction*>& histories,
                    const std::vector<std::string>& names,
                    const std::vector<std::string>& columns, Table* table,
                    std::string* error) {
  LoggedFile file;
  file.format = "universal file";
  for (size_t i = 0; i < histories.size(); ++i) {
    const UniversalFunction& f = *histories[i];
    if (!f.is_even() || !(f.abscissa_step > 0.0)) continue;
    LoggerChannel channel;
    channel.name = channel.short_name = names[i + 1];
    channel.step = f.abscissa_step;
    channel.start = f.abscissa_start;
    channel.size = f.size();
    channel.values = f.values.real();
    file.channels.push_back(std::move(channel));
  }
  return MakeLoggerTable(file, path, columns, table, error);
}

}  // namespace

bool UniversalFile::IsGlobal(int system) const {
  const auto place = systems.find(system);
  if (place == systems.end()) return system == 0 || system == 1;
  return place->second.is_known && place->second.type == 0 &&
         place->second.axes.isIdentity(1e-6) &&
         place->second.origin.isZero(1e-6);
}

bool UniversalFile::PositionOf(const UniversalNode& node,
                               Eigen::Vector3d* position) const {
  const Eigen::Vector3d given(node.position[0], node.position[1],
                              node.position[2]);
  if (!node.position_is_local || IsGlobal(node.system)) {
    *position = given;
    return true;
  }
  const auto place = systems.find(node.system);
  if (place == systems.end() || !place->second.is_known ||
      place->second.type != 0) {
    return false;
  }
  *position = place->second.axes.transpose() * given + place->second.origin;
  return true;
}

bool UniversalFile::AxesAt(const UniversalNode& node,
                           Eigen::Matrix3d* axes) const {
  if (IsGlobal(node.displacement_system)) {
    axes->setIdentity();
    return true;
  }
  const auto place = systems.find(node.displacement_system);
  if (place == systems.end() || !place->second.is_known) return false;
  const UniversalSystem& system = place->second;
  Eigen::Vector3d position;
  if (system.type == 0) {
    *axes = system.axes;
    return true;
  }
  return system.type == 1 && PositionOf(node, &position) &&
         CylindricalAxes(system, position, axes);
}

std::string UniversalPlace(int node, int direction) {
  // Direction 0 is a scalar. Files with others than the six of the format
  // exist.
  const auto size = static_cast<size_t>(std::abs(direction));
  if (size == 0) return std::to_string(node);
  if (size > std::size(kDirections)) {
    return std::to_string(node) + ":" + std::to_string(direction);
  }
  return std::to_string(node) + ":" + (direction < 0 ? "-" : "") +
         kDirections[std::abs(direction) - 1];
}

bool ParseUniversalPlace(const std::string& place, int* node, int* direction) {
  const size_t colon = place.find(':');
  int label = 0;
  if (colon == std::string::npos ||
      !ParseInt(std::string_view(place).substr(0, colon), &label) ||
      label <= 0) {
    return false;
  }
  for (const int number : {1, 2, 3, 4, 5, 6, -1, -2, -3, -4, -5, -6}) {
    if (UniversalPlace(label, number) == place) {
      *node = label;
      *direction = number;
      return true;
    }
  }
  return false;
}

bool IsUniversalFile(const std::string& path) {
  std::string extension =
      std::filesystem::path(WithoutGz(path)).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension == ".uff" || extension == ".unv";
}

bool ReadUniversalTable(const std::string& path,
                        const std::vector<std::string>& wanted, Table* table,
                        std::string* error) {
  UniversalFile file;
  if (!ReadUniversalFile(path, &file, error)) return false;
  std::vector<std::string> names = {"t"};
  std::set<std::string> used = {"t"};
  std::vector<const UniversalFunction*> histories;
  for (size_t i = 0; i < file.functions.size(); ++i) {
    const UniversalFunction& f = file.functions[i];
    if (f.function_type > 1 || f.is_complex) continue;
    names.push_back(ColumnName(f, i + 1, &used));
    histories.push_back(&f);
  }
  if (histories.empty()) {
    *error = path + ": has no time history (data set 58 of function type 1)";
    return false;
  }
  const std::vector<std::string>& columns = wanted.empty() ? names : wanted;
  const UniversalFunction* first = nullptr;
  bool has_several_clocks = false;
  Table result;
  result.path = path;
  for (const std::string& name : columns) {
    if (std::find(result.columns.begin(), result.columns.end(), name) !=
        result.columns.end()) {
      continue;
    }
    const auto place = std::find(names.begin(), names.end(), name);
    if (place == names.end()) {
      *error = path + ": no time history is called '" + name + "'" +
               NameHint(name, names);
      return false;
    }
    result.columns.push_back(name);
    if (place == names.begin()) continue;
    const UniversalFunction* f =
        histories[static_cast<size_t>(place - names.begin()) - 1];
    if (first == nullptr) first = f;
    if (HaveSameAbscissae(*f, *first)) continue;
    if (f->is_even() && first->is_even() && f->abscissa_step > 0.0 &&
        first->abscissa_step > 0.0) {
      has_several_clocks = true;
    } else {
      *error = path + ": '" + name +
               "' has other times than the histories before it; use records of "
               "one rate, or one file each";
      return false;
    }
  }
  if (has_several_clocks) {
    return ReadOnOneClock(path, histories, names, columns, table, error);
  }
  if (first == nullptr) first = histories[0];
  result.values.resize(first->size(),
                       static_cast<Eigen::Index>(result.columns.size()));
  for (size_t c = 0; c < result.columns.size(); ++c) {
    const Eigen::Index column = static_cast<Eigen::Index>(c);
    const auto place = std::find(names.begin(), names.end(), result.columns[c]);
    if (place == names.begin()) {
      for (Eigen::Index i = 0; i < first->size(); ++i) {
        result.values(i, column) =
            first->is_even() ? first->abscissa_start +
                                   static_cast<double>(i) * first->abscissa_step
                             : first->abscissa[i];
      }
    } else {
      result.values.col(column) =
          histories[static_cast<size_t>(place - names.begin()) - 1]
              ->values.real();
    }
  }
  result.line_numbers.resize(static_cast<size_t>(first->size()));
  for (size_t i = 0; i < result.line_numbers.size(); ++i) {
    result.line_numbers[i] = static_cast<int64_t>(i) + 1;
  }
  *table = std::move(result);
  return true;
}

}  // namespace pinode
