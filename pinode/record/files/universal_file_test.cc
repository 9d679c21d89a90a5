#include "pinode/record/files/universal_file.h"

#include <cmath>
#include <complex>
#include <string>
#include <utility>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/file.h"
#include "tests/support/temporary_folder_testing.h"
#include "tests/support/universal_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

// A function of numbers that need all their digits, at node 3.
UniversalFunction Function(int number, bool even) {
  UniversalFunction f;
  f.texts[0] = "deck";
  f.number = number;
  f.response_node = 3;
  f.response_direction = number == 0 ? 2 : -3;
  f.ordinate_axis = {12, {1, 0, 0}, "Acceleration", "m/s^2"};
  f.abscissa_axis = {17, {0, 0, 0}, "Time", "s"};
  f.values.resize(7);
  for (int i = 0; i < 7; ++i) f.values[i] = std::sin(i + number) / 3.0;
  if (even) {
    f.abscissa_step = 1.0 / 120.0;
  } else {
    f.abscissa = Vector::LinSpaced(7, 0.1, 0.7);
  }
  return f;
}

UniversalFile Example() {
  UniversalFile file;
  file.nodes = {{3, {0.5, -1.25, 1.0 / 3.0}, 0, 0},
                {12, {1.0, 2.0, 3.0}, 1, 7, 11},
                {13, {0.1, 0.2, 0.3}, 7, 7, 0, true}};
  UniversalSystem system;
  system.name = "tower";
  system.origin << 0.1, 1e7 / 3.0, -2.0;
  system.axes << 0.6, 0.8, 0.0, -0.8, 0.6, 0.0, 0.0, 0.0, 1.0;
  system.axes.row(0) *= std::sqrt(0.36 + 0.64);
  file.systems[7] = system;
  file.lines = {{"outline", {3, 12, 0, 12, 3, 12, 3, 12, 3}}, {"", {12, 3}}};
  for (int k = 0; k < 2; ++k) file.functions.push_back(Function(k, true));
  UniversalShape shape;
  shape.mode = 2;
  shape.frequency = 3.5;
  shape.viscous_damping = 0.01;
  shape.nodes = {3, 12};
  shape.values = Eigen::MatrixXcd::Constant(2, 3, 0.25);
  shape.values(1, 2) = -1.5;
  file.shapes.push_back(shape);
  return file;
}

TEST(UniversalFileTest, WhatIsWrittenIsReadBack) {
  const UniversalFile file = Example();
  const std::string bytes = FormatUniversalFile(file);
  UniversalFile read;
  std::string error;
  ASSERT_TRUE(ParseUniversalFile(bytes, "x.uff", &read, &error)) << error;
  EXPECT_THAT(read.set_types, ElementsAre(2420, 2411, 15, 82, 82, 58, 58, 55));
  ExpectEqualFiles(read, file, {}, {});
  // Writing again gives the same bytes.
  EXPECT_EQ(FormatUniversalFile(read), bytes);
}

// All eight kinds, binary and as text.
TEST(UniversalFileTest, FunctionsOfAllKinds) {
  for (int kind = 0; kind < 8; ++kind) {
    UniversalFile file;
    UniversalFunction f = Function(1, kind % 2 == 0);
    f.is_complex = kind / 2 % 2 == 1;
    f.is_double = kind < 4;
    f.function_type = 4;
    f.texts = {"", "b", "", "d", "e"};
    f.version = 2;
    f.load_case = 3;
    f.response_name = "wing";
    f.reference_name = "hammer";
    f.reference_node = 12;
    f.reference_direction = -6;
    f.z = 0.1;
    f.denominator_axis = {13, {0, 1, 0}, "Force", "N"};
    f.z_axis = {19, {0, 0, 0}, "Speed", "rpm"};
    if (f.is_complex) f.values *= std::complex<double>(0.6, -0.8);
    if (!f.is_double) {
      f.values = f.values.cast<std::complex<float>>()
                     .eval()
                     .cast<std::complex<double>>();
      f.abscissa = f.abscissa.cast<float>().eval().cast<double>();
    }
    file.functions = {f};
    for (const UniversalEncoding encoding :
         {UniversalEncoding::kBinary, UniversalEncoding::kText}) {
      SCOPED_TRACE(kind);
      UniversalFile read;
      std::string error;
      ASSERT_TRUE(ParseUniversalFile(FormatUniversalFile(file, encoding),
                                     "x.uff", &read, &error))
          << error;
      ASSERT_THAT(read.functions, SizeIs(1));
      if (encoding == UniversalEncoding::kBinary) {
        EXPECT_EQ(read.functions[0].is_double, f.is_double);
        ExpectEqualFiles(read, file, {}, {});
        continue;
      }
      // Abscissae have 13 columns.
      ASSERT_EQ(read.functions[0].abscissa.size(), f.abscissa.size());
      if (f.abscissa.size() > 0) {
        EXPECT_LT((read.functions[0].abscissa - f.abscissa).norm(), 1e-9);
      }
      read.functions[0].abscissa = f.abscissa;
      ExpectEqualFiles(read, file, {0.0, 1e-13}, {});
    }
  }
}

// Sixths of seconds have infinitely many digits, and columns do not.
TEST(UniversalFileTest, StepsThatColumnsDoNotHold) {
  for (const double step : {1.0 / 120.0, 1.0 / 65536.0, 0.005, 1e-5 / 7.0}) {
    for (const double start : {0.0, -1.0 / 3.0}) {
      UniversalFile file;
      file.functions = {Function(0, true)};
      file.functions[0].abscissa_step = step;
      file.functions[0].abscissa_start = start;
      const std::string bytes = FormatUniversalFile(file);
      UniversalFile read;
      std::string error;
      ASSERT_TRUE(ParseUniversalFile(bytes, "x.uff", &read, &error)) << error;
      ExpectEqualFiles(read, file, {}, {});
      if (step == 0.005 && start == 0.0) {
        EXPECT_EQ(bytes.find("abscissa from"), std::string::npos);
      }
    }
  }
  // A text that does not agree with the columns is only a text.
  UniversalFile file;
  file.functions = {Function(0, true)};
  std::string bytes = FormatUniversalFile(file);
  const size_t at = bytes.rfind("0.0083333333");
  ASSERT_NE(at, std::string::npos);
  bytes.replace(at, 12, "0.0083333399");
  UniversalFile read;
  std::string error;
  ASSERT_TRUE(ParseUniversalFile(bytes, "x.uff", &read, &error)) << error;
  EXPECT_EQ(read.functions[0].abscissa_step, 0.0083333399);
  EXPECT_THAT(read.functions[0].texts[4], HasSubstr("abscissa from 0 by 0.00"));
  // With all five texts in use, the values of the columns remain.
  file.functions[0].texts = {"a", "b", "c", "d", "e"};
  ASSERT_TRUE(
      ParseUniversalFile(FormatUniversalFile(file), "x.uff", &read, &error));
  EXPECT_NEAR(read.functions[0].abscissa_step, 1.0 / 120.0, 5e-11);
}

// Fields of 13 columns, and no data type of double precision: the expected
// loss.
TEST(UniversalFileTest, ShapesToTheirThirteenColumns) {
  for (const int type : {0, 1, 2, 3, 5, 7}) {
    UniversalFile file;
    UniversalShape shape;
    shape.analysis_type = type;
    shape.is_complex = type % 2 == 1;
    shape.model_type = 0;
    shape.characteristic = 3;
    shape.quantity = 12;
    shape.load_case = 4;
    shape.mode = type < 2 ? 0 : 9;
    shape.values_per_node = 6;
    shape.frequency = 10.0 / 3.0;
    if (type == 2) {
      shape.modal_mass = 1e6 / 7.0;
      shape.viscous_damping = 0.01 / 3.0;
      shape.hysteretic_damping = 1e-3 / 7.0;
    }
    if (type == 3 || type == 7) {
      shape.eigenvalue = {-0.1 / 3.0, 62.0 / 3.0};
      shape.frequency = shape.eigenvalue.imag() / (2.0 * std::acos(-1.0));
      shape.modal_a = {1.0 / 3.0, -1e5 / 7.0};
      shape.modal_b = {0.0, 1.0 / 9.0};
    }
    shape.nodes = {1, 2, 999999};
    shape.values.resize(3, 6);
    for (int i = 0; i < 18; ++i) {
      shape.values(i) = {std::cos(i * i + 0.1),
                         shape.is_complex ? std::sin(1e-3 * i) : 0.0};
    }
    file.shapes = {shape};
    UniversalFile read;
    std::string error;
    ASSERT_TRUE(
        ParseUniversalFile(FormatUniversalFile(file), "x.uff", &read, &error))
        << error;
    SCOPED_TRACE(type);
    ExpectEqualFiles(read, file, {}, {5.001e-10, 5.001e-10});
  }
}

// Set 58b of two points with uneven abscissae in double precision, built by
// hand. `bytes` are the numbers; the header states `count` of them.
std::string UnevenBinary(int data_type, int byte_order,
                         const std::string& count, const std::string& bytes) {
  return "    -1\n    58b     " + std::to_string(byte_order) +
         "     2          11" + std::string(12 - count.size(), ' ') + count +
         "     0     0           0           0\n"
         "sweep\nNONE\nNONE\nNONE\nNONE\n"
         "    4         0    0         0 NONE               7   1 NONE       "
         "        8  -3\n"
         "         " +
         std::to_string(data_type) +
         "         2         0  0.00000E+00  0.00000E+00  0.00000E+00\n"
         "        18    0    0    0 Frequency            Hz                  \n"
         "        12    0    0    0 Acceleration         m/s^2               \n"
         "        13    0    0    0 Force                N                   \n"
         "         0    0    0    0 NONE                 NONE                "
         "\n" +
         bytes + "    -1\n";
}

// Returns the bytes given by hexadecimal digits.
std::string Bytes(const std::string& digits) {
  std::string bytes;
  for (size_t i = 0; i < digits.size(); i += 2) {
    bytes += static_cast<char>(std::stoi(digits.substr(i, 2), nullptr, 16));
  }
  return bytes;
}

TEST(UniversalFileTest, UnevenAbscissaeInDoublePrecision) {
  // 1.5 and -2 at 0.25 and 1, with abscissae in single precision as the format
  // requires, then in double precision as some programs write them.
  const std::string real = Bytes(
      "0000803e000000000000f83f"
      "0000803f00000000000000c0");
  const std::string wide = Bytes(
      "000000000000d03f000000000000f83f"
      "000000000000f03f00000000000000c0");
  for (const auto& [bytes, count] :
       {std::make_pair(real, "24"), std::make_pair(wide, "32"),
        // Counted without the abscissae, as pyuff does.
        std::make_pair(wide, "16"), std::make_pair(real, "16")}) {
    UniversalFile file;
    std::string error;
    ASSERT_TRUE(ParseUniversalFile(UnevenBinary(4, 1, count, bytes), "x.uff",
                                   &file, &error))
        << error;
    ASSERT_THAT(file.functions, SizeIs(1));
    const UniversalFunction& f = file.functions[0];
    EXPECT_EQ(f.abscissa_step, 0.0);
    EXPECT_EQ(f.abscissa, Vector(Eigen::Vector2d(0.25, 1.0)));
    EXPECT_EQ(f.values, Eigen::VectorXcd(Eigen::Vector2cd(1.5, -2.0)));
    EXPECT_TRUE(f.is_double);
    EXPECT_FALSE(f.is_complex);
    EXPECT_EQ(f.reference_direction, -3);
    EXPECT_EQ(f.denominator_axis.unit, "N");
  }
}

// Most significant byte first. The numbers' bytes contain line breaks.
TEST(UniversalFileTest, UnevenComplexInDoublePrecision) {
  const std::string values = "400a0a0a0a0a0a0ac000000000000000";  // and -2
  const std::string single = Bytes("3e800000" + values + "3f800000" + values);
  const std::string wide =
      Bytes("3fb999999999999a" + values + "3fd3333333333333" + values);
  for (const bool is_wide : {false, true}) {
    UniversalFile file;
    std::string error;
    ASSERT_TRUE(ParseUniversalFile(
        UnevenBinary(6, 2, is_wide ? "48" : "40", is_wide ? wide : single),
        "x.uff", &file, &error))
        << error;
    const UniversalFunction& f = file.functions.at(0);
    const std::complex<double> value(0x1.a0a0a0a0a0a0ap+1, -2.0);
    EXPECT_EQ(f.values, Eigen::VectorXcd(Eigen::Vector2cd(value, value)));
    EXPECT_EQ(f.abscissa, Vector(is_wide ? Eigen::Vector2d(0.1, 0.3)
                                         : Eigen::Vector2d(0.25, 1.0)));
  }
  // So many bytes do not make two points, neither with four-byte nor with
  // eight-byte abscissae.
  for (const char* count : {"40", "30", "48", "100000"}) {
    UniversalFile file;
    std::string error;
    EXPECT_FALSE(
        ParseUniversalFile(UnevenBinary(6, 2, count, single.substr(0, 30)),
                           "x.uff", &file, &error));
    EXPECT_THAT(error, HasSubstr("data set 1 (type 58): it "));
  }
}

TEST(UniversalFileTest, HistoriesAreATable) {
  const TemporaryFolder folder;
  const std::string path =
      folder.Write("x.UFF", FormatUniversalFile(Example()));
  Table table;
  std::string error;
  ASSERT_TRUE(ReadUniversalTable(path, {"t", "3:-z"}, &table, &error)) << error;
  EXPECT_THAT(table.columns, ElementsAre("t", "3:-z"));
  ASSERT_EQ(table.num_rows(), 7);
  EXPECT_NEAR(table.values(3, 0), 3.0 / 120.0, 1e-12);
  EXPECT_NEAR(table.values(3, 1), std::sin(4.0) / 3.0, 1e-12);
  ASSERT_TRUE(ReadUniversalTable(path, {}, &table, &error)) << error;
  EXPECT_THAT(table.columns, ElementsAre("t", "3:y", "3:-z"));
  EXPECT_FALSE(ReadUniversalTable(path, {"3:x"}, &table, &error));
  EXPECT_THAT(error, HasSubstr("'3:x'"));
}

TEST(UniversalFileTest, HistoriesOfOtherTimesAreNoTable) {
  UniversalFile file;
  file.functions = {Function(0, false), Function(1, false)};
  const TemporaryFolder folder;
  Table table;
  std::string error;
  ASSERT_TRUE(ReadUniversalTable(
      folder.Write("x.uff", FormatUniversalFile(file)), {}, &table, &error))
      << error;
  EXPECT_EQ(table.values.col(0), file.functions[0].abscissa);
  file.functions[1].abscissa[3] += 0.01;
  for (int i = 0; i < 2; ++i) {
    EXPECT_FALSE(ReadUniversalTable(
        folder.Write("x.uff", FormatUniversalFile(file)), {}, &table, &error));
    EXPECT_THAT(error, HasSubstr("'3:-z' has other times"));
    file.functions[1] = Function(1, true);
  }
}

TEST(UniversalFileTest, HistoriesOfSeveralRates) {
  UniversalFile file;
  file.functions = {Function(0, true), Function(1, true)};
  UniversalFunction* fast = &file.functions[0];
  UniversalFunction* slow = &file.functions[1];
  fast->abscissa_step = 0.01;
  fast->values.resize(400);
  for (int i = 0; i < 400; ++i) fast->values[i] = std::sin(0.1 * i);
  slow->abscissa_step = 0.02;
  slow->abscissa_start = fast->abscissa_start + 0.03;
  slow->values = Eigen::VectorXcd::LinSpaced(150, 0.0, 149.0);
  const TemporaryFolder folder;
  Table table;
  std::string error;
  ASSERT_TRUE(ReadUniversalTable(
      folder.Write("x.uff", FormatUniversalFile(file)), {}, &table, &error))
      << error;
  ASSERT_EQ(table.columns[0], "t");
  ASSERT_EQ(table.num_rows(), 150);
  for (int k = 0; k < 150; ++k) {
    EXPECT_NEAR(table.values(k, 0), slow->abscissa_start + 0.02 * k, 1e-12);
    EXPECT_EQ(table.values(k, 2), k);
    if (k < 40 || k > 110) continue;  // the ends are reflected
    EXPECT_NEAR(table.values(k, 1), std::sin(0.1 * (3 + 2 * k)), 1e-4);
  }
  EXPECT_THAT(table.reading, HasSubstr("resampled from 100 to 50 Hz"));
  slow->abscissa_start += 0.004;
  EXPECT_FALSE(ReadUniversalTable(
      folder.Write("x.uff", FormatUniversalFile(file)), {}, &table, &error));
  EXPECT_THAT(error, HasSubstr("lie between those of the others"));
}

// Even abscissae with a step of zero, as in some files, and no names.
TEST(UniversalFileTest, HistoriesWithoutStepAndName) {
  UniversalFile file;
  file.functions = {Function(0, true), Function(1, true)};
  for (UniversalFunction& f : file.functions) {
    f.abscissa_step = 0.0;
    f.abscissa_start = 2.5;
    f.response_node = 0;
    f.texts[0] = "";
  }
  const std::string bytes = FormatUniversalFile(file);
  UniversalFile read;
  Table table;
  std::string error;
  ASSERT_TRUE(ParseUniversalFile(bytes, "x.uff", &read, &error)) << error;
  ExpectEqualFiles(read, file, {}, {});
  const TemporaryFolder folder;
  ASSERT_TRUE(
      ReadUniversalTable(folder.Write("x.uff", bytes), {}, &table, &error))
      << error;
  EXPECT_THAT(table.columns, ElementsAre("t", "set1", "set2"));
  EXPECT_EQ(table.values(6, 0), 2.5);
}

TEST(UniversalFileTest, DamagedFilesAreRefused) {
  const std::string text = FormatUniversalFile(Example());
  UniversalFile file;
  std::string error;
  EXPECT_FALSE(ParseUniversalFile("", "x.uff", &file, &error));
  EXPECT_FALSE(ParseUniversalFile("just a text\n", "x.uff", &file, &error));
  EXPECT_THAT(error, HasSubstr("no data set"));
  // A file cut at any place is read up to the cut, or refused.
  for (size_t size = 0; size < text.size(); size += 7) {
    UniversalFile part;
    if (ParseUniversalFile(text.substr(0, size), "x.uff", &part, &error)) {
      EXPECT_LE(part.functions.size(), 2u);
    } else {
      EXPECT_THAT(error, HasSubstr("x.uff: "));
    }
  }
  EXPECT_FALSE(ParseUniversalFile("    -1\n    58b 1 2 11 4000000 0 0\n" +
                                      std::string(400, '\n') + "    -1\n",
                                  "x.uff", &file, &error));
}

// Headers that end early, and labels that are no integers.
TEST(UniversalFileTest, OddNumbersAreRefused) {
  UniversalFile file;
  std::string error;
  for (const char* header : {"   58b", "   58b   ", "58B"}) {
    EXPECT_FALSE(ParseUniversalFile("    -1\n" + std::string(header) + "\n" +
                                        std::string(5, '\n') + "    1\n" +
                                        "         2         3         1\n" +
                                        std::string(4, '\n') + "    -1\n",
                                    "x.uff", &file, &error));
    EXPECT_THAT(error, HasSubstr("not IEEE numbers")) << header;
  }
  for (const char* label : {"1e300", "nan", "1.5", "-inf", "3e9"}) {
    EXPECT_FALSE(ParseUniversalFile(
        "    -1\n    15\n" + std::string(label) + " 0 0 1 0. 0. 0.\n    -1\n",
        "x.uff", &file, &error));
    EXPECT_THAT(error, HasSubstr("is not a node")) << label;
    EXPECT_FALSE(ParseUniversalFile(
        "    -1\n    15\n1 0 " + std::string(label) + " 1 0. 0. 0.\n    -1\n",
        "x.uff", &file, &error));
  }
}

TEST(UniversalFileTest, CoordinateSystems) {
  const std::string text =
      "    -1\n    18\n"
      "         1         0         0         1         1\nsame\n"
      " 0.0 0.0 0.0 2.0 0.0 0.0\n 0.0 0.0 3.0\n"
      "         2         0         0         1         1\nturned\n"
      " 0.0 0.0 0.0 -1.0 0.0 0.0\n 0.0 0.0 1.0\n"
      "         3         1         0         1         1\nround\n"
      " 0.0 0.0 0.0 1.0 0.0 0.0\n 0.0 0.0 1.0\n"
      "         4         0         2         1         1\nof another\n"
      " 1.0 2.0 3.0 2.0 2.0 3.0\n 1.0 2.0 4.0\n"
      "         9         0         0         1         1\ndegenerate\n"
      " 1.0 2.0 3.0 2.0 2.0 3.0\n 3.0 2.0 3.0\n"
      "    -1\n    -1\n  2420\n         1\npart\n"
      "         7         0         0\nsame\n"
      " 1.0D+0 0.0 0.0\n 0.0 1.0 0.0\n 0.0 0.0 1.0\n 0.0 0.0 0.0\n"
      "         8         0         0\nmoved\n"
      " 1.0 0.0 0.0\n 0.0 1.0 0.0\n 0.0 0.0 1.0\n 0.0 0.0 5.0\n"
      "    -1\n    -1\n    15\n"
      "         9         7         2         1 0.0 1.0 2.0\n    -1\n";
  UniversalFile file;
  std::string error;
  ASSERT_TRUE(ParseUniversalFile(text, "x.uff", &file, &error)) << error;
  for (const int system : {0, 1, 7}) EXPECT_TRUE(file.IsGlobal(system));
  for (const int system : {2, 3, 4, 8, 5}) {
    EXPECT_FALSE(file.IsGlobal(system)) << system;
  }
  ASSERT_THAT(file.nodes, SizeIs(1));
  EXPECT_EQ(file.nodes[0].system, 7);
  EXPECT_FALSE(file.nodes[0].position_is_local);
  EXPECT_EQ(file.nodes[0].displacement_system, 2);
  EXPECT_EQ(file.systems[2].name, "turned");
  // The second system has x and y reversed; the fourth is moved within it.
  Eigen::Matrix3d axes;
  ASSERT_TRUE(file.AxesAt(file.nodes[0], &axes));
  EXPECT_TRUE(axes.isApprox(
      Eigen::Vector3d(-1.0, -1.0, 1.0).asDiagonal().toDenseMatrix()));
  EXPECT_TRUE(file.systems[4].axes.isApprox(axes));
  EXPECT_TRUE(file.systems[4].origin.isApprox(Eigen::Vector3d(-1, -2, 3)));
  EXPECT_FALSE(file.systems[9].is_known);
  UniversalFile again;
  ASSERT_TRUE(
      ParseUniversalFile(FormatUniversalFile(file), "x.uff", &again, &error));
  ExpectEqualFiles(again, file, {}, {});
  EXPECT_TRUE(UniversalFile().IsGlobal(1));
  EXPECT_FALSE(UniversalFile().IsGlobal(2));
}

// At this node the radius is along x, and the angle is along y.
TEST(UniversalFileTest, DirectionsInCylindricalSystems) {
  UniversalFile file;
  UniversalSystem drum;
  drum.type = 1;
  drum.origin << 10.0, 0.0, 0.0;
  drum.axes << 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0;  // along x
  file.systems[2] = drum;
  UniversalNode node;
  node.displacement_system = 2;
  node.position = {4.0, 3.0, 3.0};
  Eigen::Matrix3d axes;
  ASSERT_TRUE(file.AxesAt(node, &axes));
  const double half = std::sqrt(0.5);
  Eigen::Matrix3d expected;
  expected << 0.0, half, half, 0.0, -half, half, 1.0, 0.0, 0.0;
  EXPECT_TRUE(axes.isApprox(expected)) << axes;
  node.position = {4.0, 0.0, 0.0};  // on the axis
  EXPECT_FALSE(file.AxesAt(node, &axes));
  file.systems[2].type = 2;
  node.position = {4.0, 3.0, 3.0};
  EXPECT_FALSE(file.AxesAt(node, &axes));
}

}  // namespace
}  // namespace pinode
