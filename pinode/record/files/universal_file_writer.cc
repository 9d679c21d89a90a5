// Writes universal files.

#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/strings.h"
#include "pinode/record/files/universal_file.h"
#include "pinode/record/files/universal_sets.h"

namespace pinode {
namespace {

constexpr size_t kSingle = 13, kDouble = 20, kPosition = 25;  // columns

std::string Integer(int value, int width) {
  char text[24];
  std::snprintf(text, sizeof(text), "%*d", width, value);
  return text;
}

// Returns a text of one line, "NONE" if it is empty.
std::string Cut(const std::string& text, size_t width) {
  std::string result = text.empty() ? "NONE" : text.substr(0, width);
  for (char& letter : result) {
    if (letter == '\n' || letter == '\r') letter = ' ';
  }
  return result;
}

std::string Padded(const std::string& text, size_t width) {
  std::string result = Cut(text, width);
  result.resize(width, ' ');
  return result;
}

std::string TextLines(const std::array<std::string, 5>& texts) {
  std::string lines;
  for (const std::string& text : texts) lines += Cut(text, 80) + "\n";
  return lines;
}

std::string Set(const std::string& header, const std::string& body) {
  return "    -1\n" + header + "\n" + body + "    -1\n";
}

std::string Set(int type, const std::string& body) {
  return Set(Integer(type, 6), body);
}

// Writes numbers, `per_line` on each line.
class NumberLines {
 public:
  explicit NumberLines(int per_line) : per_line_(per_line) {}
  void Add(double value, size_t width) {
    text_ += UniversalNumber(value, width);
    if (++count_ % per_line_ == 0) text_ += "\n";
  }
  std::string Take() {
    if (count_ % per_line_ != 0) text_ += "\n";
    return std::move(text_);
  }

 private:
  const int per_line_;
  int count_ = 0;
  std::string text_;
};

template <typename Range>
std::string Numbers(const Range& values, int per_line, size_t width) {
  NumberLines lines(per_line);
  for (const double value : values) lines.Add(value, width);
  return lines.Take();
}

bool IsSingle(double value) {
  return std::isnan(value) ||
         static_cast<double>(static_cast<float>(value)) == value;
}

bool FitsSingleColumns(double value) {
  double read = 0.0;
  return std::isnan(value) ||
         (ParseDouble(UniversalNumber(value, kSingle), &read) && read == value);
}

// Writes a function.
class FunctionWriter {
 public:
  FunctionWriter(const UniversalFunction& f, bool binary)
      : f_(f), binary_(binary), even_(f.is_even()) {
    abscissa_single_ = even_ || All(f.abscissa);
    double_ = f.is_double || !abscissa_single_ || !All(f.values.real()) ||
              (f.is_complex && !All(f.values.imag()));
  }

  std::string Text() const {
    const std::string header = Header();
    if (!binary_) return Set(58, header + TextValues());
    const std::string bytes = BinaryValues();
    char line[100];
    // 1: the least significant byte first, 2: IEEE; 11 lines before the bytes.
    std::snprintf(line, sizeof(line), "%6db%6d%6d%12d%12zu%6d%6d%12d%12d", 58,
                  1, 2, 11, bytes.size(), 0, 0, 0, 0);
    return Set(std::string(line), header + bytes);
  }

 private:
  // Returns true if single precision represents all values exactly.
  template <typename Values>
  bool All(const Values& values) const {
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      if (!(binary_ ? IsSingle(values[i]) : FitsSingleColumns(values[i]))) {
        return false;
      }
    }
    return true;
  }

  static std::string Axis(const UniversalAxis& axis) {
    return Integer(axis.type, 10) + Integer(axis.exponents[0], 5) +
           Integer(axis.exponents[1], 5) + Integer(axis.exponents[2], 5) + " " +
           Padded(axis.label, 20) + " " + Padded(axis.unit, 20) + "\n";
  }

  std::array<std::string, 5> Texts() const {
    std::array<std::string, 5> texts = f_.texts;
    if (!even_) return texts;
    const std::string note =
        UniversalAbscissaNote(f_.abscissa_start, f_.abscissa_step);
    for (size_t i = texts.size(); !note.empty() && i-- > 1;) {
      if (!texts[i].empty()) continue;
      texts[i] = note;
      break;
    }
    return texts;
  }

  std::string Header() const {
    const int type = f_.is_complex ? (double_ ? 6 : 5) : (double_ ? 4 : 2);
    return TextLines(Texts()) + Integer(f_.function_type, 5) +
           Integer(f_.number, 10) + Integer(f_.version, 5) +
           Integer(f_.load_case, 10) + " " + Padded(f_.response_name, 10) +
           Integer(f_.response_node, 10) + Integer(f_.response_direction, 4) +
           " " + Padded(f_.reference_name, 10) +
           Integer(f_.reference_node, 10) + Integer(f_.reference_direction, 4) +
           "\n" + Integer(type, 10) + Integer(static_cast<int>(f_.size()), 10) +
           Integer(even_ ? 1 : 0, 10) +
           UniversalNumber(even_ ? f_.abscissa_start : 0.0, kSingle) +
           UniversalNumber(even_ ? f_.abscissa_step : 0.0, kSingle) +
           UniversalNumber(f_.z, kSingle) + "\n" + Axis(f_.abscissa_axis) +
           Axis(f_.ordinate_axis) + Axis(f_.denominator_axis) + Axis(f_.z_axis);
  }

  std::string TextValues() const {
    NumberLines numbers(!double_ ? 6 : even_ ? 4 : f_.is_complex ? 3 : 4);
    const size_t width = double_ ? kDouble : kSingle;
    for (Eigen::Index i = 0; i < f_.size(); ++i) {
      if (!even_) numbers.Add(f_.abscissa[i], kSingle);
      numbers.Add(f_.values[i].real(), width);
      if (f_.is_complex) numbers.Add(f_.values[i].imag(), width);
    }
    return numbers.Take();
  }

  static void AddBytes(double value, bool in_double, std::string* bytes) {
    char raw[8];
    if (in_double) {
      std::memcpy(raw, &value, 8);
    } else {
      const float single = static_cast<float>(value);
      std::memcpy(raw, &single, 4);
    }
    bytes->append(raw, in_double ? 8 : 4);
  }

  // Writes abscissae in single precision, as the format requires, if that loses
  // nothing.
  std::string BinaryValues() const {
    std::string bytes;
    for (Eigen::Index i = 0; i < f_.size(); ++i) {
      if (!even_) AddBytes(f_.abscissa[i], !abscissa_single_, &bytes);
      AddBytes(f_.values[i].real(), double_, &bytes);
      if (f_.is_complex) AddBytes(f_.values[i].imag(), double_, &bytes);
    }
    return bytes;
  }

  const UniversalFunction& f_;
  const bool binary_;
  const bool even_;
  bool abscissa_single_ = true;
  bool double_ = true;
};

std::string ShapeText(const UniversalShape& shape) {
  const int type = shape.analysis_type;
  std::vector<double> reals = {shape.frequency};
  if (type == 2) {
    reals = {shape.frequency, shape.modal_mass, shape.viscous_damping,
             shape.hysteretic_damping};
  } else if (type == 3 || type == 7) {
    reals = {shape.eigenvalue.real(), shape.eigenvalue.imag(),
             shape.modal_a.real(),    shape.modal_a.imag(),
             shape.modal_b.real(),    shape.modal_b.imag()};
  }
  const bool has_number = type != 0 && type != 1 && type != 6;
  std::string text = TextLines(shape.texts);
  text += Integer(shape.model_type, 10) + Integer(type, 10) +
          Integer(shape.characteristic, 10) + Integer(shape.quantity, 10) +
          Integer(shape.is_complex ? 5 : 2, 10) +
          Integer(shape.values_per_node, 10) + "\n";
  text += Integer(has_number ? 2 : 1, 10) +
          Integer(static_cast<int>(reals.size()), 10) +
          Integer(shape.load_case, 10) +
          (has_number ? Integer(shape.mode, 10) : "") + "\n" +
          Numbers(reals, 6, kSingle);
  for (size_t n = 0; n < shape.nodes.size(); ++n) {
    text += Integer(shape.nodes[n], 10) + "\n";
    NumberLines numbers(6);
    const Eigen::Index row = static_cast<Eigen::Index>(n);
    for (Eigen::Index k = 0; k < shape.values.cols(); ++k) {
      numbers.Add(shape.values(row, k).real(), kSingle);
      if (shape.is_complex) numbers.Add(shape.values(row, k).imag(), kSingle);
    }
    text += numbers.Take();
  }
  return text;
}

// Returns one set with part number 1.
std::string SystemsText(const std::map<int, UniversalSystem>& systems) {
  std::string text = Integer(1, 10) + "\nNONE\n";
  for (const auto& [number, system] : systems) {
    text += Integer(number, 10) + Integer(system.type, 10) +
            Integer(system.color, 10) + "\n" + Cut(system.name, 80) + "\n";
    NumberLines rows(3);
    for (int k = 0; k < 9; ++k) rows.Add(system.axes(k / 3, k % 3), kPosition);
    for (int k = 0; k < 3; ++k) rows.Add(system.origin[k], kPosition);
    text += rows.Take();
  }
  return text;
}

// Returns the nodes in their order, with a set for each run of nodes of one
// kind.
std::string NodesText(const std::vector<UniversalNode>& nodes) {
  std::string text;
  for (size_t begin = 0; begin < nodes.size();) {
    const bool local = nodes[begin].position_is_local;
    std::string body;
    for (; begin < nodes.size() && nodes[begin].position_is_local == local;
         ++begin) {
      const UniversalNode& node = nodes[begin];
      body += Integer(node.label, 10) + Integer(node.system, 10) +
              Integer(node.displacement_system, 10) + Integer(node.color, 10) +
              (local ? "" : "\n") +
              Numbers(node.position, 3, local ? kSingle : kPosition);
    }
    text += Set(local ? 15 : 2411, body);
  }
  return text;
}

std::string LineText(int number, const UniversalLine& line) {
  std::string text = Integer(number, 10) +
                     Integer(static_cast<int>(line.nodes.size()), 10) +
                     Integer(0, 10) + "\n" + Cut(line.name, 80) + "\n";
  for (size_t i = 0; i < line.nodes.size(); ++i) {
    text += Integer(line.nodes[i], 10);
    if (i % 8 == 7 || i + 1 == line.nodes.size()) text += "\n";
  }
  return text;
}

}  // namespace

std::string FormatUniversalFile(const UniversalFile& file,
                                UniversalEncoding functions) {
  std::string text;
  if (!file.systems.empty()) text += Set(2420, SystemsText(file.systems));
  text += NodesText(file.nodes);
  for (size_t i = 0; i < file.lines.size(); ++i) {
    text += Set(82, LineText(static_cast<int>(i) + 1, file.lines[i]));
  }
  for (const UniversalFunction& f : file.functions) {
    text += FunctionWriter(f, functions == UniversalEncoding::kBinary).Text();
  }
  for (const UniversalShape& shape : file.shapes) {
    text += Set(55, ShapeText(shape));
  }
  return text;
}

}  // namespace pinode
