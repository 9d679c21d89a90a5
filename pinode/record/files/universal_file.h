// Universal files, the exchange format of test programs. Supported are
// functions (data set 58, text and binary), geometry (15, 2411, 82, 2412), mode
// shapes (55), and coordinate systems (18, 2420).
//
// The format is that of SDRC's I-DEAS, documented by the University of
// Cincinnati (Universal File Formats for Modal Analysis Testing).
//
// Written data are read back equal to the last bit, with these exceptions of
// the format:
//
// - Shapes (set 55) have no data type of double precision and fields of 13
//   columns. So have their frequency or eigenvalue, modal mass and damping.
//   Numbers up to 10 are off by 5e-10 at most, up to 1e9 by 5e-10 of
//   themselves, others by up to 5e-5 of themselves (1e-100; see
//   UniversalNumber).
// - Functions written as text (kText): 20 columns a value, off by 5e-12 of
//   themselves at most, most of them exact; uneven abscissae 13 columns.
// - Positions in a local system (UniversalNode::position_is_local): 13 columns.
// - Texts are cut after 80, labels and units after 20, names of responses after
//   10 characters; "NONE" is read as an empty text.
// The start and the step of even abscissae have 13 columns too. If these are
// not enough, a free line of text of the function gives the exact values
// ("abscissa from 0 by 0.0083333333333333332"). Other programs skip it.

#ifndef PINODE_RECORD_FILES_UNIVERSAL_FILE_H_
#define PINODE_RECORD_FILES_UNIVERSAL_FILE_H_

#include <Eigen/Core>
#include <array>
#include <complex>
#include <map>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/record/table.h"

namespace pinode {

// An axis of a function.
struct UniversalAxis {
  int type = 0;  // 8 displacement, 11 velocity, 12 acceleration, 17 time, ...
  std::array<int, 3> exponents = {0, 0, 0};  // of length, force, temperature
  std::string label, unit;
};

// Data set 58: one function of time or frequency.
struct UniversalFunction {
  std::array<std::string, 5> texts;  // lines 1 to 5; the first names it
  int function_type = 1;             // 1: a time history; 4: FRF; 9: PSD; ...
  int number = 0, version = 0, load_case = 0;
  // Names of the response and the reference, and their directions: 1, 2, 3 are
  // x, y, z of the node's displacement system (see UniversalFile::AxesAt), 4,
  // 5, 6 are rotations, with the sign; 0: none.
  std::string response_name, reference_name;
  int response_node = 0, response_direction = 0;
  int reference_node = 0, reference_direction = 0;
  double abscissa_start = 0.0;
  double abscissa_step = 0.0;
  Vector abscissa;  // empty if even: see abscissa_start and _step
  Eigen::VectorXcd values;
  bool is_complex = false;
  // True if the function is stored in double precision. It is always written so
  // if single precision would lose digits.
  bool is_double = true;
  double z = 0.0;
  UniversalAxis abscissa_axis, ordinate_axis, denominator_axis, z_axis;

  Eigen::Index size() const { return values.size(); }
  bool is_even() const { return abscissa.size() == 0; }
};

struct UniversalNode {
  int label = 0;
  std::array<double, 3> position = {0.0, 0.0, 0.0};
  // Coordinate systems of the position and of the directions at the node. 0:
  // the global system.
  int system = 0, displacement_system = 0;
  int color = 0;
  // True for set 15 with another than the global system: `position` is in that
  // system. Set 2411 has positions in the global system, and `system` is the
  // one to export to.
  bool position_is_local = false;
};

// A coordinate system, expressed in the global one.
struct UniversalSystem {
  int type = 0;  // 0 Cartesian, 1 cylindrical, 2 spherical
  int color = 0;
  std::string name;
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  // x, y, z are its rows
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  // False if the file is ambiguous about its axes or its origin. These are then
  // zero.
  bool is_known = true;
};

// Nodes joined by lines, in their order. 0 starts a new line.
struct UniversalLine {
  std::string name;
  std::vector<int> nodes;
};

// Data set 55: a shape. Vectors (characteristic 2 and 3) are along the global
// axes by definition of the format, whatever the displacement systems of the
// nodes.
struct UniversalShape {
  std::array<std::string, 5> texts;
  int model_type = 1;      // structural
  int analysis_type = 2;   // 2 normal mode; 3, 7 complex eigenvalue
  int characteristic = 2;  // 1 scalar, 2 translations, 3 with rotations, ...
  int quantity = 8;        // 8 displacement, 11 velocity, 12 acceleration, ...
  int mode = 0;
  int load_case = 0;
  double frequency = 0.0;           // Hz; of a complex eigenvalue Im / (2 pi)
  std::complex<double> eigenvalue;  // of a complex one, 1 / s
  std::complex<double> modal_a, modal_b;  // of a complex one
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
  std::map<int, UniversalSystem> systems;  // by their numbers

  // Returns true for system 0, for a system that the file declares global, and
  // for 1 if the file does not define it. Programs number the global system
  // from 0 or from 1.
  bool IsGlobal(int system) const;

  // Computes the node's position in the global system. Returns false if the
  // file does not define its system, or if that is not Cartesian: programs
  // disagree about angles.
  [[nodiscard]] bool PositionOf(const UniversalNode& node,
                                Eigen::Vector3d* position) const;
  // Computes directions 1, 2 and 3 at the node, in rows, as vectors of the
  // global system. Returns false if the file does not define its displacement
  // system, if this is spherical, and on the axis of a cylindrical one.
  [[nodiscard]] bool AxesAt(const UniversalNode& node,
                            Eigen::Matrix3d* axes) const;
};

// Reads all data sets of a file (.uff, .unv; also gzipped). Sets of other types
// are listed and skipped. Fails with `path: data set n: what`.
[[nodiscard]] bool ReadUniversalFile(const std::string& path,
                                     UniversalFile* file, std::string* error);
[[nodiscard]] bool ParseUniversalFile(const std::string& bytes,
                                      const std::string& path,
                                      UniversalFile* file, std::string* error);

// Encoding of functions: 58b, which is exact, or text.
enum class UniversalEncoding { kBinary, kText };

// Returns the file with the data sets 2420, 2411 (15 for local positions), 82,
// 58, 55.
std::string FormatUniversalFile(
    const UniversalFile& file,
    UniversalEncoding functions = UniversalEncoding::kBinary);

// Returns true if the extension is that of a universal file, in any case.
bool IsUniversalFile(const std::string& path);

// Returns "<node>:<direction>", with directions x, y, z, rx, ry, rz, "-x" and
// so on: the name of a place that has both.
std::string UniversalPlace(int node, int direction);
// Parses such a name. Returns false for any other text.
[[nodiscard]] bool ParseUniversalPlace(const std::string& place, int* node,
                                       int* direction);

// Reads the time histories of a file as a table. Column "t" is the time. Other
// columns are called by their places if they have one, else by their first
// text. A repeated name gets the number of its data set appended. Even
// histories of several rates or start times are brought to one clock
// (MakeLoggerTable); uneven ones need the same times. `wanted` as for
// ReadCsvTable.
[[nodiscard]] bool ReadUniversalTable(const std::string& path,
                                      const std::vector<std::string>& wanted,
                                      Table* table, std::string* error);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_UNIVERSAL_FILE_H_
