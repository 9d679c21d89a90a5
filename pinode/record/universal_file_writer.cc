// Universal files written: text.

#include <array>
#include <cstdio>
#include <string>
#include <utility>

#include "pinode/record/universal_file.h"

namespace pinode {
namespace {

std::string Line(const char* format, double value) {
  char text[40];
  std::snprintf(text, sizeof(text), format, value);
  return text;
}

std::string Integer(int value, int width) {
  char text[24];
  std::snprintf(text, sizeof(text), "%*d", width, value);
  return text;
}

std::string Padded(const std::string& text, size_t width) {
  std::string result = text.substr(0, width);
  result.resize(width, ' ');
  return result;
}

template <typename Array>
std::string TextLines(const Array& texts) {
  std::string lines;
  for (const std::string& text : texts) {
    lines += (text.empty() ? "NONE" : text.substr(0, 80)) + "\n";
  }
  return lines;
}

// Numbers, `per_line` of them.
class NumberLines {
 public:
  NumberLines(const char* format, int per_line)
      : format_(format), per_line_(per_line) {}
  void Add(double value) {
    text_ += Line(format_, value);
    if (++count_ % per_line_ == 0) text_ += "\n";
  }
  std::string Take() {
    if (count_ % per_line_ != 0) text_ += "\n";
    return std::move(text_);
  }

 private:
  const char* format_;
  const int per_line_;
  int count_ = 0;
  std::string text_;
};

std::string FunctionText(const UniversalFunction& f) {
  const bool even = f.abscissa_step > 0.0;
  const int type = f.is_complex ? (f.is_double ? 6 : 5) : (f.is_double ? 4 : 2);
  std::string text = TextLines(f.texts);
  text += Integer(f.function_type, 5) + Integer(0, 10) + Integer(0, 5) +
          Integer(0, 10) + " " + Padded("NONE", 10) +
          Integer(f.response_node, 10) + Integer(f.response_direction, 4) +
          " " + Padded("NONE", 10) + Integer(f.reference_node, 10) +
          Integer(f.reference_direction, 4) + "\n";
  text += Integer(type, 10) + Integer(static_cast<int>(f.size()), 10) +
          Integer(even ? 1 : 0, 10) + Line("%13.5e", f.abscissa_start) +
          Line("%13.5e", f.abscissa_step) + Line("%13.5e", 0.0) + "\n";
  const auto axis = [](int specific, const std::string& label,
                       const std::string& unit) {
    return Integer(specific, 10) + "    0    0    0 " +
           Padded(label.empty() ? "NONE" : label, 20) + " " +
           Padded(unit.empty() ? "NONE" : unit, 20) + "\n";
  };
  text +=
      axis(f.function_type == 1 ? 17 : 18, f.abscissa_label, f.abscissa_unit) +
      axis(f.ordinate_type, f.ordinate_label, f.ordinate_unit) +
      axis(0, "", "") + axis(0, "", "");
  NumberLines numbers(f.is_double ? "%20.12e" : "%13.5e",
                      f.is_double ? (even ? 4 : 2) : 6);
  for (Eigen::Index i = 0; i < f.size(); ++i) {
    if (!even) numbers.Add(f.abscissa[i]);
    numbers.Add(f.values[i].real());
    if (f.is_complex) numbers.Add(f.values[i].imag());
  }
  return text + numbers.Take();
}

std::string ShapeText(const UniversalShape& shape) {
  const bool complex_mode =
      shape.analysis_type == 3 || shape.analysis_type == 7;
  std::string text = TextLines(shape.texts);
  text += Integer(1, 10) + Integer(shape.analysis_type, 10) +
          Integer(shape.values_per_node > 3 ? 3 : 2, 10) + Integer(8, 10) +
          Integer(shape.is_complex ? 5 : 2, 10) +
          Integer(shape.values_per_node, 10) + "\n";
  text += Integer(2, 10) + Integer(complex_mode ? 6 : 4, 10) +
          Integer(shape.load_case, 10) + Integer(shape.mode, 10) + "\n";
  NumberLines head("%13.5e", 6);
  if (complex_mode) {
    for (const double value : {shape.eigenvalue.real(), shape.eigenvalue.imag(),
                               0.0, 0.0, 0.0, 0.0}) {
      head.Add(value);
    }
  } else {
    for (const double value :
         {shape.frequency, shape.modal_mass, shape.viscous_damping,
          shape.hysteretic_damping}) {
      head.Add(value);
    }
  }
  text += head.Take();
  for (size_t n = 0; n < shape.nodes.size(); ++n) {
    text += Integer(shape.nodes[n], 10) + "\n";
    NumberLines numbers("%13.5e", 6);
    const Eigen::Index row = static_cast<Eigen::Index>(n);
    for (Eigen::Index k = 0; k < shape.values.cols(); ++k) {
      numbers.Add(shape.values(row, k).real());
      if (shape.is_complex) numbers.Add(shape.values(row, k).imag());
    }
    text += numbers.Take();
  }
  return text;
}

std::string Set(int type, const std::string& body) {
  return "    -1\n" + Integer(type, 6) + "\n" + body + "    -1\n";
}

}  // namespace

std::string FormatUniversalFile(const UniversalFile& file) {
  std::string text;
  if (!file.nodes.empty()) {
    std::string body;
    for (const UniversalNode& node : file.nodes) {
      body += Integer(node.label, 10) + Integer(0, 10) + Integer(0, 10) +
              Integer(0, 10);
      for (const double value : node.position) body += Line("%13.5e", value);
      body += "\n";
    }
    text += Set(15, body);
  }
  int number = 0;
  for (const UniversalLine& line : file.lines) {
    std::string body =
        Integer(++number, 10) +
        Integer(static_cast<int>(line.nodes.size()), 10) + Integer(0, 10) +
        "\n" + (line.name.empty() ? "NONE" : line.name.substr(0, 80)) + "\n";
    for (size_t i = 0; i < line.nodes.size(); ++i) {
      body += Integer(line.nodes[i], 10);
      if (i % 8 == 7 || i + 1 == line.nodes.size()) body += "\n";
    }
    text += Set(82, body);
  }
  for (const UniversalFunction& f : file.functions) {
    text += Set(58, FunctionText(f));
  }
  for (const UniversalShape& shape : file.shapes) {
    text += Set(55, ShapeText(shape));
  }
  return text;
}

}  // namespace pinode
