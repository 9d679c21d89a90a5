// Compares universal files.

#ifndef TESTS_SUPPORT_UNIVERSAL_TESTING_H_
#define TESTS_SUPPORT_UNIVERSAL_TESTING_H_

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>

#include "gtest/gtest.h"
#include "pinode/record/files/universal_file.h"

namespace pinode {

// Largest accepted difference from the written numbers: `absolute`, or
// `relative` times the number, whichever is larger.
struct UniversalTolerance {
  double absolute = 0.0, relative = 0.0;
  double Of(double value) const {
    return std::max(absolute, relative * std::abs(value));
  }
};

inline void ExpectNear(std::complex<double> read, std::complex<double> written,
                       const UniversalTolerance& tolerance) {
  EXPECT_LE(std::abs(read.real() - written.real()),
            tolerance.Of(written.real()));
  EXPECT_LE(std::abs(read.imag() - written.imag()),
            tolerance.Of(written.imag()));
}

inline void ExpectEqualAxes(const UniversalAxis& read,
                            const UniversalAxis& written) {
  EXPECT_EQ(read.type, written.type);
  EXPECT_EQ(read.exponents, written.exponents);
  EXPECT_EQ(read.label, written.label);
  EXPECT_EQ(read.unit, written.unit);
}

inline void ExpectEqualFunctions(const UniversalFunction& read,
                                 const UniversalFunction& written,
                                 const UniversalTolerance& tolerance) {
  EXPECT_EQ(read.texts, written.texts);
  EXPECT_EQ(read.function_type, written.function_type);
  EXPECT_EQ(read.number, written.number);
  EXPECT_EQ(read.version, written.version);
  EXPECT_EQ(read.load_case, written.load_case);
  EXPECT_EQ(read.response_name, written.response_name);
  EXPECT_EQ(read.reference_name, written.reference_name);
  EXPECT_EQ(read.response_node, written.response_node);
  EXPECT_EQ(read.response_direction, written.response_direction);
  EXPECT_EQ(read.reference_node, written.reference_node);
  EXPECT_EQ(read.reference_direction, written.reference_direction);
  if (written.is_even()) {
    EXPECT_EQ(read.abscissa_start, written.abscissa_start);
  }
  EXPECT_EQ(read.abscissa_step, written.abscissa_step);
  EXPECT_EQ(read.abscissa, written.abscissa);
  EXPECT_EQ(read.is_complex, written.is_complex);
  EXPECT_GE(read.is_double, written.is_double);
  EXPECT_EQ(read.z, written.z);
  ExpectEqualAxes(read.abscissa_axis, written.abscissa_axis);
  ExpectEqualAxes(read.ordinate_axis, written.ordinate_axis);
  ExpectEqualAxes(read.denominator_axis, written.denominator_axis);
  ExpectEqualAxes(read.z_axis, written.z_axis);
  ASSERT_EQ(read.size(), written.size());
  double worst = 0.0;
  for (Eigen::Index i = 0; i < read.size(); ++i) {
    const std::complex<double> a = read.values[i];
    const std::complex<double> b = written.values[i];
    worst =
        std::max({worst, std::abs(a.real() - b.real()) - tolerance.Of(b.real()),
                  std::abs(a.imag() - b.imag()) - tolerance.Of(b.imag())});
  }
  EXPECT_LE(worst, 0.0);
}

inline void ExpectEqualShapes(const UniversalShape& read,
                              const UniversalShape& written,
                              const UniversalTolerance& tolerance) {
  EXPECT_EQ(read.texts, written.texts);
  EXPECT_EQ(read.model_type, written.model_type);
  EXPECT_EQ(read.analysis_type, written.analysis_type);
  EXPECT_EQ(read.characteristic, written.characteristic);
  EXPECT_EQ(read.quantity, written.quantity);
  EXPECT_EQ(read.mode, written.mode);
  EXPECT_EQ(read.load_case, written.load_case);
  ExpectNear(read.frequency, written.frequency, tolerance);
  ExpectNear(read.eigenvalue, written.eigenvalue, tolerance);
  ExpectNear(read.modal_a, written.modal_a, tolerance);
  ExpectNear(read.modal_b, written.modal_b, tolerance);
  ExpectNear(read.modal_mass, written.modal_mass, tolerance);
  ExpectNear(read.viscous_damping, written.viscous_damping, tolerance);
  ExpectNear(read.hysteretic_damping, written.hysteretic_damping, tolerance);
  EXPECT_EQ(read.is_complex, written.is_complex);
  EXPECT_EQ(read.values_per_node, written.values_per_node);
  EXPECT_EQ(read.nodes, written.nodes);
  ASSERT_EQ(read.values.rows(), written.values.rows());
  ASSERT_EQ(read.values.cols(), written.values.cols());
  for (Eigen::Index i = 0; i < read.values.size(); ++i) {
    ExpectNear(read.values(i), written.values(i), tolerance);
  }
}

inline void ExpectEqualGeometries(const UniversalFile& read,
                                  const UniversalFile& written) {
  ASSERT_EQ(read.systems.size(), written.systems.size());
  for (const auto& [number, system] : written.systems) {
    ASSERT_EQ(read.systems.count(number), 1u);
    const UniversalSystem& other = read.systems.at(number);
    EXPECT_EQ(other.type, system.type);
    EXPECT_EQ(other.color, system.color);
    EXPECT_EQ(other.name, system.name);
    EXPECT_EQ(other.axes, system.axes);
    EXPECT_EQ(other.origin, system.origin);
    EXPECT_EQ(other.is_known, system.is_known);
  }
  ASSERT_EQ(read.nodes.size(), written.nodes.size());
  for (size_t i = 0; i < read.nodes.size(); ++i) {
    EXPECT_EQ(read.nodes[i].label, written.nodes[i].label);
    EXPECT_EQ(read.nodes[i].position, written.nodes[i].position);
    EXPECT_EQ(read.nodes[i].system, written.nodes[i].system);
    EXPECT_EQ(read.nodes[i].displacement_system,
              written.nodes[i].displacement_system);
    EXPECT_EQ(read.nodes[i].color, written.nodes[i].color);
    EXPECT_EQ(read.nodes[i].position_is_local,
              written.nodes[i].position_is_local);
  }
  ASSERT_EQ(read.lines.size(), written.lines.size());
  for (size_t i = 0; i < read.lines.size(); ++i) {
    EXPECT_EQ(read.lines[i].name, written.lines[i].name);
    EXPECT_EQ(read.lines[i].nodes, written.lines[i].nodes);
  }
}

inline void ExpectEqualFiles(const UniversalFile& read,
                             const UniversalFile& written,
                             const UniversalTolerance& functions,
                             const UniversalTolerance& shapes) {
  ExpectEqualGeometries(read, written);
  ASSERT_EQ(read.functions.size(), written.functions.size());
  for (size_t i = 0; i < read.functions.size(); ++i) {
    ExpectEqualFunctions(read.functions[i], written.functions[i], functions);
  }
  ASSERT_EQ(read.shapes.size(), written.shapes.size());
  for (size_t i = 0; i < read.shapes.size(); ++i) {
    ExpectEqualShapes(read.shapes[i], written.shapes[i], shapes);
  }
}

}  // namespace pinode

#endif  // TESTS_SUPPORT_UNIVERSAL_TESTING_H_
