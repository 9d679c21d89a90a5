// Universal files: what test programs exchange. Functions (data set 58, text
// and binary), geometry (15, 2411, 82, 2412), mode shapes (55), and which
// coordinate systems (18, 2420) are the global one.
//
// The format is that of SDRC's I-DEAS, documented by the University of
// Cincinnati (Universal File Formats for Modal Analysis Testing).

#ifndef PINODE_RECORD_UNIVERSAL_FILE_H_
#define PINODE_RECORD_UNIVERSAL_FILE_H_

#include <Eigen/Core>
#include <array>
#include <complex>
#include <map>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/record/table.h"

namespace pinode {

// Data set 58: one function, of time or frequency.
struct UniversalFunction {
  std::array<std::string, 5> texts;  // lines 1 to 5; the first names it
  int function_type = 1;             // 1: a time history; 4: FRF; 9: PSD; ...
  // Directions: 1, 2, 3 are x, y, z, 4, 5, 6 rotations, with the sign; 0: none.
  int response_node = 0, response_direction = 0;
  int reference_node = 0, reference_direction = 0;
  double abscissa_start = 0.0;
  double abscissa_step = 0.0;  // 0: `abscissa` has each
  Vector abscissa;
  Eigen::VectorXcd values;
  bool is_complex = false;
  bool is_double = true;
  std::string abscissa_label, abscissa_unit;
  std::string ordinate_label, ordinate_unit;
  int ordinate_type = 0;  // 8 displacement, 11 velocity, 12 acceleration, ...

  Eigen::Index size() const { return values.size(); }
};

struct UniversalNode {
  int label = 0;
  std::array<double, 3> position = {0.0, 0.0, 0.0};
  // Coordinate systems of the position and of the directions at the node; 0:
  // the global one.
  int system = 0, displacement_system = 0;
};

// Nodes joined by lines, in their order; 0 lifts the pen.
struct UniversalLine {
  std::string name;
  std::vector<int> nodes;
};

// Data set 55: a shape.
struct UniversalShape {
  std::array<std::string, 5> texts;
  int analysis_type = 2;  // 2 normal mode; 3, 7 complex eigenvalue
  int mode = 0;
  int load_case = 0;
  double frequency = 0.0;           // Hz; of a complex eigenvalue Im / (2 pi)
  std::complex<double> eigenvalue;  // of a complex one, 1 / s
  double modal_mass = 0.0;
  double viscous_damping = 0.0, hysteretic_damping = 0.0;
  bool is_complex = false;
  int values_per_node = 3;
  std::vector<int> nodes;
  Eigen::MatrixXcd values;  // nodes x values_per_node
};

struct UniversalFile {
  std::vector<int> set_types;  // of all data sets, known or not
  std::vector<UniversalFunction> functions;
  std::vector<UniversalNode> nodes;
  std::vector<UniversalLine> lines;
  std::vector<UniversalShape> shapes;
  // Coordinate systems by their numbers: whether each is the global one, with
  // its origin and its axes.
  std::map<int, bool> systems;

  // Of 0, of a system that the file says to be so, and of 1 where it says
  // nothing of it: programs number the global system from 0 or from 1.
  bool IsGlobal(int system) const;
};

// Reads all data sets of a file (.uff, .unv; also gzipped); those of other
// types are listed and passed over. Fails with `path: data set n: what`.
[[nodiscard]] bool ReadUniversalFile(const std::string& path,
                                     UniversalFile* file, std::string* error);
[[nodiscard]] bool ParseUniversalFile(const std::string& bytes,
                                      const std::string& path,
                                      UniversalFile* file, std::string* error);

// The data sets as text, functions with even abscissae as such: 15, 82, 58, 55.
std::string FormatUniversalFile(const UniversalFile& file);

// By its extension, in any case.
bool IsUniversalFile(const std::string& path);

// "<node>:<direction>", directions x, y, z, rx, ry, rz, "-x" and so on: how
// places are called that have both.
std::string UniversalPlace(int node, int direction);
// The other way; false where it is no such name.
[[nodiscard]] bool ParseUniversalPlace(const std::string& place, int* node,
                                       int* direction);

// The time histories of a file as a table: column "t" is the time, the others
// are called by their places where they have one, and else as their first text;
// a name twice gets the number of its data set. They need the same times.
// `wanted` as for ReadCsvTable.
[[nodiscard]] bool ReadUniversalTable(const std::string& path,
                                      const std::vector<std::string>& wanted,
                                      Table* table, std::string* error);

}  // namespace pinode

#endif  // PINODE_RECORD_UNIVERSAL_FILE_H_
